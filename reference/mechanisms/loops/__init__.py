"""Mechanisms with closed chains, in which points of bodies coincide with points of other bodies.

- `ways`: open this first. `way` computes the motion, and `witness` the same motion by other equations.
- `joint_space`: the mass matrix of the tree in joint coordinates, and the rows of the loops.
- `body_space`, `body_equations`: the bodies and the constraints between them, and Newton's and Euler's equations.
- `minimum_norm`: accelerations and multipliers of minimum norm in the wide type.
- `vectors`: vectors and rotation matrices at several instants at once.
"""
