"""A block that lies flat on a level or inclined plane: it rests, slides, stops and tips.

- `block`: open this first. It recognises such a scene, and computes its motion with bounds of errors.
- `face`: the face on which the block lies, in exact arithmetic.
- `legs`: the motion, in pieces between the instants at which pushes begin and end.
- `oblique`: the slide of a block in a direction other than that of the force that drives it.
"""
