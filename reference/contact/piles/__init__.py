"""Bodies on each other: stacks and piles at rest, and a box that is pushed under spheres.

- `rest`, `pushed`: the two ways.
- `upright`: bodies whose faces are parallel to the plane, and the common area of two faces.
- `bearing`: the forces between bodies at rest.
"""
