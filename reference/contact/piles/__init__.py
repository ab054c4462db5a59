"""Bodies on each other: stacks and piles at rest, and a box that is pushed under spheres.

- `rest`, `pushed`: the two ways.
- `upright`: bodies whose faces are parallel to the plane, and what two of them have in common.
- `bearing`: the forces that hold them.
"""
