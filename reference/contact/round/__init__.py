"""A sphere alone, or a cylinder on its side, that slips, rolls and bounces on a plane: phases in closed form.

- `alone`: open this first. It recognises such a body, and computes its motion.
- `motion`: the motion from its phases.
- `phases`: flight, impact, slip and roll, one after another until rest.
- `ball`: the laws of impact and slip.
- `hodograph`: a slip across an inclined plane.
- `turns`: the attitude.
- `bounds`: the bounds of the errors of the motion.
"""
