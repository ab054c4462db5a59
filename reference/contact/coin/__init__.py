"""A coin that rolls without slip: a cylinder that touches a level plane with a point of its rim.

- `way`: open this first. It combines the two solutions, the bounds of their errors, and the end of the motion.
- `start`: recognises a scene with such a coin, and converts its start to units in which its size is near 1.
- `angles`: Appell's equations in Euler angles, and the forces at the rim.
- `bodily`: Newton's and Euler's equations with a quaternion, which are the witness.
- `ends`: the instant at which the coin slips or touches the plane with more than a point.
- `steady`: steady circles in closed form.
"""
