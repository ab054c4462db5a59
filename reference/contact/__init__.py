"""The mechanics of rigid bodies that roll, bounce, rest and tip on a plane and on each other, under Coulomb's laws.

- `problem`: the bodies of a scene along the axes of its plane, in one form for one body and for several.
- `motion`: the result of every way: states with bounds, and events.
- `ways`: chooses the way for a scene, and the friction that engines receive instead of an infinite coefficient.
- `truth`: the truth of a scene from its way.
- `witness`: the second way, which starts from the scene and shares no code with the first.
- `round`, `flat`, `leaning`, `piles`, `coin`, `dropped`: the ways. After the first touch of a body that is dropped on an edge
  or a corner, only inequalities are known.
- `gripping`: a body between two fingers, which are on joints.
- `touching`, `observables`, `impacts`: the observables that are measured on the samples of a run.

A body that lies flat on a level plane, slides and spins is in `bodycheck.reference.sliding`.
"""
