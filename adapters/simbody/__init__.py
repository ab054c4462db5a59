"""The adapter of Simbody, Stanford's C++ engine, by the Python package `opensim` of OpenSim, which is built on it.

A body is on OpenSim's `FreeJoint`, and OpenSim's `Manager` steps it at a fixed size of step, which switches the control of the
error off. The methods are Simbody's integrators with the names that `Manager` gives them: ExplicitEuler, SemiExplicitEuler2
(two half steps in each step), Verlet, RungeKutta2, RungeKutta3, RungeKuttaMerson (order 4), RungeKuttaFeldberg (order 4 as
observed, although Simbody's documentation says fifth), and CPodes. CPodes stays at order 1 where its step cannot change, and
stops with an error where its own test of accuracy fails. It fails in the first steps of a contact, and is offered in flight
only. The accuracy that ends iterations, of Verlet for instance, is Simbody's default. SemiExplicitEuler2 reproduces Simbody's
row of OSRF's box benchmark of 2015.

- A method without options uses Simbody's quaternions, which are Simbody's own default. OpenSim switches them off, and its
  Python package has no function that switches them on again; the adapter calls that of Simbody's library by its C++ name.
- `settings=engine` is what OpenSim makes of it: three angles about the body's x, y and z axes in turn. They meet gimbal lock
  where the second one is a right angle, and lose digits near it.

Nothing else is left to switch off: a free joint has no damping and no limits.

Drag is a force on the joint's coordinates that is computed from the velocity at the start of a step and held through it,
because OpenSim has no force that could compute it and takes none that is written in Python. All integrators have order 1 with
it.

A brick touches the plane by OpenSim's `HuntCrossleyForce` on a small sphere at each of its four lower corners. OpenSim has no
default for the stiffness: the spheres sink in by a hundredth of the body's half-height under its weight, and the damping is
the critical one. Friction is viscous below OpenSim's default transition speed of 0.01 m/s.

Links are bodies that are joined to the first one by weld joints. The coordinates are the position of the first link's origin,
and an integrator's error of a centre of mass that is elsewhere is of its order.

Mechanisms have OpenSim's own joint for each type; the module `mechanisms` says with what forces. All integrators have the
orders that they have in flight, on joints of every type. CPodes stops where its own test of accuracy fails, as with steps of 10
ms of a cart with a pole. OpenSim has no armature, no dry friction, and no damping of a ball joint. The state of a loop is
projected only where its gap is above Simbody's tolerance of constraints, some 0.1 mm of a linkage of 1 m.

Frames, found by experiment: velocities are the angular velocity, then that of the centre of mass, both in the world frame.
Simbody normalises a quaternion only where its norm is off by more than 1e-4; the adapter hands over unit quaternions, and the
deviation as `quaternion_norm_error`. The arithmetic is in double precision.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("opensim")
