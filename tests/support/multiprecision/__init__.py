"""The free motion of a body in multiprecision arithmetic, from the text of its case file on.

This is what the truth and its bounds are checked against. It shares no code with bodycheck: it reads the file with tomllib,
takes each number as the double nearest to its decimals, and forms everything else with 120 digits. Its ways differ from those
of the truth too: moments come from second moments of the mass, the axes from a symmetric eigenvalue problem, the elliptic
functions from the arithmetic-geometric mean, and the attitude from Carlson's integrals and from the images of two directions,
the angular momentum and one axis of the body.

- `arithmetic`: the numbers, vectors and matrices.
- `attitudes`: rotation matrices, quaternions, and Euler angles z-x-z with their rates.
- `inertia`: mass, centre and inertia tensor of the body in a file.
- `rotation`: the rotation of a body without torque.
- `flight`: the motion of the body in a file, at any instants, and what it conserves.
- `taylor`: the same rotation by integration of Euler's equations, to check the closed form.
"""
