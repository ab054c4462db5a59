"""The mechanics of rigid bodies that roll, bounce, rest and tip on a plane and on each other, under Coulomb's laws.

- `problem`: the bodies of a scene along the axes of its plane, in one form for one body and for several.
- `motion`: what every way makes: states with bounds, and events.
- `ways`: which way has the motion of which scene, one module a way.
- `truth`: the truth of a scene from its way.
- `sphere`, `cylinder`: a sphere alone, and a cylinder on its side. `round_motion` makes their motion from the phases of
  `phases`; `ball` has the laws of impact and slip, `hodograph` a slip across an inclined plane, `round_turns` and `turning` the
  attitude, `round_bounds` the bounds.

A body that lies flat on a level plane, slides and spins is in `bodycheck.reference.sliding`.
"""
