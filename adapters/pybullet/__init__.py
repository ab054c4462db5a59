"""The adapter of PyBullet, the Python interface of the Bullet physics engine, in its build in double precision.

Bullet has two kinds of bodies, each with its own solver; they are the integrators of this adapter:

- `maximal`: a rigid body in maximal coordinates (`useMaximalCoordinates`, `btRigidBody`). The angular velocity is advanced by
  one Newton step of an implicit equation with the gyroscopic torque in the body frame, which is a linearly implicit Euler step.
- `multibody`: the base of a tree in reduced coordinates (`btMultiBody`), which is PyBullet's default. The angular velocity in
  the world frame is advanced by an explicit Euler step with the articulated-body algorithm.

Both then advance the pose with the new velocities, and both are of first order. Bullet's Runge-Kutta integration of trees
cannot be switched on from Python. `maximal` reproduces Bullet's row of OSRF's box benchmark of 2015.

For `multibody`, two settings are switched off: the damping, which is the deceleration 0.04 (1 + |u|) u for u the velocity and
for u the angular velocity (SI units), and the limits of 100 m/s and 100 rad/s on their components. With `settings=engine` both
are as PyBullet sets them. For `maximal` PyBullet sets neither damping nor such limits, and for both kinds of bodies it sets no
sleeping, no substeps and no continuous collision detection; so `maximal` has no second method.

Frames, as found by experiment: PyBullet returns the position of the centre of mass, the attitude of the principal axes as
x, y, z, w, and both velocities in the world frame. A body in maximal coordinates takes the moments of inertia from
`changeDynamics` only together with its mass, and uses them only after its pose has been set again. Bullet normalises its
quaternions.

A body on a plane lies on a box, as on the ground of PyBullet's own `plane.urdf`: a box on a box has four contacts at once, but
a box on PyBullet's `GEOM_PLANE` gets them one by one, which throws it about at the start. The contact has the parameters that
PyBullet sets: 50 iterations, an error reduction of 0.08, and an implicit friction cone. In the limit of small time steps, a
spin about the vertical stops as the friction of four corners demands for `maximal`, but 5 % later for `multibody`. A cylinder
gets its contacts one by one: at time steps of 2 ms or more a disk that slides is tilted, and rises by some millimetres.
Bodies that roll, bounce, rest or tip are in the module `touching`.

Links are read from a URDF file, because no other function of PyBullet takes an inertia tensor.

- PyBullet uses the inertia of the file only with the flag `URDF_USE_INERTIA_FROM_FILE`. `settings=engine` does not set this
  flag: PyBullet then computes the inertia from the shapes, and gives links without shapes the inertia of a cube of 2 mm.
- Bullet diagonalises a tensor by successive rotations. It makes the last rotation when less than a millionth of the trace is
  off the diagonal, so that some 1e-10 of the trace may remain there.
- The links of `multibody` are one body with fixed joints. The links of `maximal` are separate bodies in fixed constraints.
  PyBullet ignores the attitudes of the two frames of such a constraint: links whose principal axes are not parallel are turned
  until they are parallel.

Mechanisms are trees in reduced coordinates, so that only `multibody` has them; the module `mechanisms` describes how they are
built. Revolute, prismatic, spherical and fixed joints are of first order. Bullet evaluates damping at the start of a step,
v' = (1 - h d) v for one unit of inertia, so that it is not stable if h d is above 2. Dry friction stops a joint within a step
and holds it. The coordinates of a spherical joint are along the principal axes of its child. There is neither armature nor a
universal joint; a planar joint ignores where the child's centre of mass is, and a floating joint becomes a fixed joint, so that
planar and floating joints are not offered. PyBullet's motors, which brake every joint by default, are switched off with
`settings=engine` too.

A body that should rotate by more than pi/4 in a step rotates by another angle, because Bullet then limits the angle in the sine
of the rotation, but not in the vector that is divided by it: x rad become 2 atan(tan(pi/8) x / (pi/4)), such as 2.53 rad for 6
rad (source: `btTransformUtil::integrateTransform`).

The module `engine` is the adapter.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("pybullet")
