"""The adapter of Simbody, Stanford's C++ engine, by the Python package `opensim` of OpenSim, which is built on it.

A body is on OpenSim's `FreeJoint`, and OpenSim's `Manager` takes steps of a fixed size, which switches off the error control,
unless the method has the option `accuracy`. All integrators have it: OpenSim's integrator accuracy, with the time step as the
largest step. Simbody counts steps and evaluations ("realizations"). No step ends at a sample: OpenSim records the ends of the
steps, and the state at a sample is computed by a step of another manager from the last of them. The methods are Simbody's
integrators with the names that `Manager` gives them: ExplicitEuler, SemiExplicitEuler2 (two half steps in each step), Verlet,
RungeKutta2, RungeKutta3, RungeKuttaMerson (order 4), RungeKuttaFeldberg (order 4 as observed, although Simbody's documentation
says fifth), and CPodes. CPodes is made for error control: it stays at order 1 if its step cannot change, and stops with an
error if its own test of accuracy fails. The test fails in the first steps of a contact, so CPodes is not offered on a plane.
The accuracy at which iterations end, for instance in Verlet, is Simbody's default in fixed steps. SemiExplicitEuler2 reproduces
Simbody's row of OSRF's box benchmark of 2015.

- A method without options uses Simbody's quaternions, which are Simbody's own default. OpenSim switches them off, and its
  Python package has no function that switches them on again; the adapter calls the function of Simbody's library by its C++
  name.
- `settings=engine` is OpenSim's default of the coordinates, but not of the step control: three angles about the body's x, y and
  z axes, in this order. They are in gimbal lock if the second angle is a right angle, and lose digits near it.

Nothing else has to be switched off: a free joint has no damping and no limits.

Drag is a force of OpenSim that is evaluated wherever Simbody evaluates forces, so that every integrator keeps its order; see
`models.add_drag`. Releases of OpenSim without expressions of several velocities do not model it.

A brick touches the plane by OpenSim's `HuntCrossleyForce` on a small sphere at each of its four lower corners. OpenSim has no
default for the stiffness: the spheres sink in by a hundredth of the body's half-height under its weight, and the damping is
the critical one. Friction is viscous below OpenSim's default transition speed of 0.01 m/s.

Spheres and bricks that touch in any other way have the same force, one for each pair (module `touching`). CPodes is not offered
for them.

Links are bodies that weld joints connect to the first link. The coordinates are the position of the first link's origin. If the
centre of mass is elsewhere, an integrator's error has the order of the integrator.

Mechanisms have OpenSim's own joint for each type; the module `mechanisms` describes their forces. On joints of every type, all
integrators have the same orders as in flight. CPodes stops if its own test of accuracy fails, as with steps of 10 ms of a cart
with a pole. OpenSim has no armature, no dry friction, and no damping of a ball joint. The state of a loop is projected only if
its gap is above Simbody's tolerance of constraints, some 0.1 mm for a linkage of 1 m.

Frames, found by experiment: velocities are the angular velocity, then the velocity of the centre of mass, both in the world
frame. Simbody normalises a quaternion only if its norm is off by more than 1e-4; the adapter returns unit quaternions, and the
deviation as `quaternion_norm_error`. The arithmetic is in double precision.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("opensim")
