"""Mechanisms whose chains are closed: points of bodies that stay on points of others.

- `ways`: open this first. `way` gives the motion and `witness` the same motion by other equations.
- `joint_space`: the mass matrix of the tree in joint coordinates, and the rows of the loops.
- `body_space`, `body_equations`: the bodies and the links between them, and Newton's and Euler's equations.
- `minimum_norm`: accelerations and multipliers of minimum norm in the wide type.
- `vectors`: vectors and rotation matrices at several instants at once.
"""
