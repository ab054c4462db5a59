"""The mechanics of rigid bodies that roll, bounce, rest and tip on a plane and on each other, under Coulomb's laws.

- `problem`: the bodies of a scene along the axes of its plane, in one form for one body and for several.
- `motion`: what every way makes: states with bounds, and events.
- `ways`: which way has the motion of which scene, one module a way; and the friction that engines get where nothing slips.
- `truth`: the truth of a scene from its way.
- `round`, `flat`, `leaning`, `piles`, `coin`, `dropped`: the ways. What follows the first touch of a body that is dropped on an
  edge or a corner is judged by inequalities.
- `touching`, `observables`, `impacts`: what is measured on the samples of a run.

A body that lies flat on a level plane, slides and spins is in `bodycheck.reference.sliding`.
"""
