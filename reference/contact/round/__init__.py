"""A sphere alone, or a cylinder on its side, that slips, rolls and bounces on a plane: phases in closed form.

- `sphere`, `cylinder`: open these first. They say whether a scene is one, and give its motion.
- `motion`: the motion from its phases.
- `phases`: flight, impact, slip and roll, one after another until rest.
- `ball`: the laws of impact and slip.
- `hodograph`: a slip across an inclined plane.
- `turns`, `turning`: the attitude.
- `bounds`: the errors of all of it.
"""
