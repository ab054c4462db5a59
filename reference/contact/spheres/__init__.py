"""Two free spheres that hit each other, in space or over a level plane.

- `ball`: the spheres, and their states with a hundred digits.
- `collision`: the impulses between two spheres, and between a sphere and the plane.
- `touch`: the next instant at which the spheres touch.
- `course`: phases of constant acceleration, and the events between them.
- `way`: the motion at given instants, and its bounds.
"""
