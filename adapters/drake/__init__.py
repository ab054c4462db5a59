"""The adapter of Drake, the C++ toolbox of the Toyota Research Institute, by its Python package `drake`.

A body is the only body of a `MultibodyPlant`, at the origin of its frame, on the quaternion joint that Drake gives to free
bodies. The plant is stepped in two ways.

- Drake's integrators step the continuous plant. The methods have Drake's names: explicit_euler,
  semi_explicit_euler, runge_kutta2, runge_kutta3, bogacki_shampine3, runge_kutta5, implicit_euler, velocity_implicit_euler,
  radau1, radau3, and cenic in releases that have it. The two implicit Euler integrators take two half steps in each step and
  keep their result. If Newton's method does not converge, Drake divides a step. Without the option `accuracy`, steps have a
  fixed size. With it, all integrators that estimate the error of a step choose their steps as Drake's simulator does by
  default: the accuracy is the target accuracy, and the time step the largest step, which is 0.1 s by default as in Drake.
  Samples end no step: the state at a sample is computed in another copy of the plant, from the end of the last step before it.
  explicit_euler, semi_explicit_euler and runge_kutta2 estimate no error. cenic does not count its
  evaluations. The explicit integrators are offered in flight
  only: with Drake's default stiffness of contact, they need steps well below 0.5 ms.
- The discrete plant steps itself, by one step in each of its updates. Its methods are named after its approximations of
  contact: lagged (Drake's default), similar, sap and tamsi (deprecated). Without contact all four are the same scheme,
  semi-implicit Euler, and agree to rounding, so that in flight only lagged is offered.

Nothing has to be switched off in flight: Drake has no damping and no limits of its own there, and the methods are the same with
its defaults. On a plane, all methods use Drake's defaults of stiffness, dissipation, relaxation time and stiction speed.

- A brick or a cylinder touches the plane by hydroelastic contact if no option is given: the body is compliant with Drake's
  default modulus (1e7 Pa), and the plane rigid. The pressure acts at the centroids of the few polygons of a coarse mesh, so
  that the friction is neither the friction of an area nor the friction of corners.
- `contact=points` replaces the shape of a brick by points at its four lower corners.
- sap and similar are convex: where a contact slides they throw the body up, as MuJoCo's contact does. lagged and tamsi do not.
- `settings=engine` is Drake's default for the shape: a single point contact between shape and plane, which jumps from corner
  to corner.

Bodies that touch a plane and each other in any other way are in the module `touching`: bricks and cylinders by hydroelastic
contact, round bodies by point contact, since a hydroelastic ball rolls too slowly: its dissipation brakes it. Drake has no
coefficient of restitution; the dissipation of Hunt and Crossley is chosen such that the first impact returns its part. An
impact lasts 4 ms with Drake's default stiffness and a body of 1 kg: at steps of 1 ms the implicit steps dissipate more than
half of the velocity.

Drag is a system in Python that Drake evaluates wherever it evaluates forces, so that every integrator keeps its order.

Frames, found by experiment: positions are the quaternion w x y z, then the position of the body's origin; velocities are the
angular velocity, then the velocity of the origin, both in the world frame. The arithmetic is in double precision.

Links are bodies of the plant that are welded to the first link. The quaternion joint moves the frame of the first link. If the
centre of mass is not its origin, an integrator's error has the order of the integrator.

Mechanisms have Drake's own joint for each type, in both plants; the module `mechanisms` describes the joints and their
elements. With all integrators the observed order on joints of every type is the claimed order, also with damping, armature,
springs and efforts. The discrete plant evaluates damping at the end of a step, and springs and efforts at its beginning. A
spherical joint has roll, pitch and yaw as coordinates: it fails at a pitch of a right angle, and near this pitch its errors are
a hundred times the errors of quaternions.
Drake has no dry friction of joints, and loops only in the discrete plant with the solver SAP. Two faults of 1.51 are avoided: a
ball constraint on the body of the world itself ends the process, and `cenic` in the mode of fixed steps, but not with error
control, leaves the poses before its last step in the cache of the context, so that states are read from a separate context.

Drake's integrators treat a quaternion as four numbers and never normalise it, except cenic, which does so in every step. Drake
divides by the norm where it uses a quaternion, and the velocities do not depend on it. The adapter hands over unit quaternions,
and the largest deviation of the norm as `quaternion_norm_error`.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("drake", modules=("pydrake",))
