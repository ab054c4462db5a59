"""A second computation of the motion from the scene, by independent code.

It shares no formula with the rest of the reference, so that a mistake there is not repeated here: it imports only the
description of the scene and numerical tools. Its conventions differ on purpose. Attitudes are matrices of direction cosines,
the inertia is a tensor in the frame of the body and not moments along principal axes, and the rates of Euler angles become an
angular velocity by the derivative of the product of three matrices.

- `inertia`: mass and inertia tensor by exact rational arithmetic.
- `border`: the data that a motion starts from, with a hundred digits.
- `closed_form`: the parabola of the centre of mass, and the rotation by elliptic functions and quadrature, which follows any
  motion; open this first. It uses `arithmetic`, `principal_axes`, `jacobi` and `swing`.
- `directions`: quaternions of matrices of direction cosines.
- `integration`: the rotation, by Taylor's method in 80 bits or any number of bits (heyoka).
"""
