"""The second way to motions of bodies that touch, by code that shares nothing with the first.

It starts from the scene and not from `contact.problem`, decides its own phases and events, and imports from the reference only
the description of scenes, the second reading and closed form in `independent`, the integration of equations by collocation, and
the type of its result.

- `ways`: the families, and the witness of a scene.
- `reading`: the bodies of a scene and their plane.
- `balls`: spheres and cylinders on their side. `rolling` has their equations and phases, `series` the power series of a step,
  and `pieces` the states at instants.
- `faces`: the axes and half-lengths of bodies with faces; `standing`: bodies that stand, and what bears them.
- `blocks`, with `slide`: a block that lies flat. `leaning`: a body that leans and falls. `coins`: a coin that rolls.
- `colliding`: two spheres that hit each other.
- `gripped`: a body between two fingers. `clasping` reads them, `forces` has the power series, and `swinging` a body that turns.
- `dropped`: a body that falls on the plane. `resting`: piles. `pushing`: a box that is pushed under spheres.
- `searching`: the end of a motion within a step of an integration.
"""
