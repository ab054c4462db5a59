"""Enclosures of bodies that touch a plane or each other.

- `start`: the bodies of a scene along the axes of its plane.
- `rolling`: a sphere, or a cylinder on its side, that flies, hits the plane, slips and rolls.
- `gripping`: a brick between two fingers, which is held or falls.
- `slipping`: a slip against friction, along a line or across the fall line of an incline.

A distance from the plane, a velocity along the normal and a slip count as zero at t = 0 if they are at most `NONE` of the size
of their terms, because of the decimals of the file.
"""
