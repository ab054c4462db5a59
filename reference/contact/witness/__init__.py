"""The second way to motions of bodies that touch, by code that shares nothing with the first.

It starts from the scene and not from `contact.problem`, decides its own phases and events, and imports from the reference only
the description of scenes, the start of a motion in `independent`, and the type of its result.

- `ways`: the families, and the witness of a scene.
- `reading`: the bodies of a scene and their plane.
- `balls`: spheres and cylinders on their side. `rolling` has their equations and phases, `series` the power series of a step,
  and `pieces` the states at instants.
"""
