"""A coin that rolls without slip: a cylinder that touches a level plane with a point of its rim.

- `way`: open this first. It joins the two solutions, their bounds, and where the motion ends.
- `start`: whether a scene is such a coin, and its start in units in which it is of the size one.
- `angles`: Appell's equations in Euler angles, and the forces at the rim.
- `bodily`: Newton's and Euler's equations with a quaternion, which are the witness.
- `ends`: where the coin slips or meets the plane with more than a point.
- `steady`: steady circles in closed form.
"""
