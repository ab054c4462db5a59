"""A block that lies flat on a level or inclined plane: it rests, slides, stops and tips.

- `block`: open this first. It says whether a scene is one, and gives its motion and bounds.
- `face`: the face on which it lies, exactly.
- `legs`: the motion between the instants at which pushes begin and end.
- `oblique`: one that slides across the force that drives it.
"""
