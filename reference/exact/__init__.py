"""Exact consequences of the numbers of a file or a scene, computed with a hundred digits.

- `numbers`: the arithmetic, and rounding to the types that NumPy has.
- `rotations`: products of quaternions, rotated vectors, quaternions and body rates of Euler angles.
- `inertia`: mass, centre of mass and inertia tensor of solids, particles and bodies of parts.
- `axes`: principal moments and principal axes of a tensor.
- `touching`: the position of a body that touches a plane.
- `pairs`: arithmetic of some 120 bits for many numbers at once, for ensembles.
- `start`: the principal moments, attitude and angular velocity of a scene at t = 0. Open this first.

A motion can amplify a rounding error of its initial state a million times and more, so that nothing is rounded before the
constants of the motion are known.
"""
