"""The adapter of DART (`dartpy`), a C++ engine of articulated rigid bodies that computes in double precision.

The module `engine` is the adapter, `contact` builds the plane, the shape of the body and the solver of the contacts.

DART has one time integrator, which its class `World` steps: semi-implicit Euler. The body is on a `FreeJoint`, whose six
velocities were found by experiment to be the angular and then the linear velocity, both along the axes of the world. A step
adds h times their accelerations, and then turns the body by h times its new angular velocity. Its states agree, but for
rounding, with those of semi-implicit Euler on the angular velocity of the body frame, because a turn about the angular velocity
leaves its components as they are. The attitude is kept as a rotation vector, so that no quaternion has to be normalised. Drag
is an external force that is computed at the start of each step.

On a plane DART detects collisions, and solves one problem for the impulses of all contacts. The option `solver` selects how:

- Dantzig's algorithm, DART's default, and projected Gauss-Seidel (`solver=pgs`) have a box for the friction of a contact: each
  of two components, along x and y of the world, is at most the coefficient times the normal force. Friction that is oblique to
  these axes is up to 1.41 times too large.
- `solver=nsgs` and `solver=fbf` have Coulomb's cone (nonsmooth Gauss-Seidel, and forward-backward-forward splitting).

All have DART's own tolerances and limits of iterations. The plane is the upper face of a large box, because most detectors
find one contact between a plane and a box, and four between two boxes. The option `detector` selects DART's own detector, or
FCL, Bullet or ODE as DART includes them. The methods without it have the one that puts contacts at the corners of a brick when
it only touches, Bullet's, and for a cylinder ODE's, which puts eight on its rim. DART's own and FCL's find one contact under a
cylinder, which tips over it; FCL's and ODE's find none in the first step, before there is a penetration. DART's own puts some
contacts inside the face, and the results with it and an iterative solver differ from one run to the next in one process.

Switched off is DART's sleeping, which stops bodies that have been slow for half a second. `settings=engine` has DART's own
defaults: sleeping, and the detector FCL. In flight no default differs. What cannot be switched off from Python is the softness
of contacts (constraint force mixing 1e-5, error reduction 0.01 of a penetration in a step, at most 1 mm/s), and that DART
removes lateral and tilting velocities below 0.2 mm/s and 0.5 mrad/s that a contact caused.

Links are bodies on weld joints. The velocity of the free joint is that of the origin of the first link's frame, so that a step
of a centre of mass that is elsewhere has an error of first order, even without forces.

Mechanisms have DART's own joint for each type; the module `mechanisms` says with what. The observed order is one on all of
them. DART takes damping and springs at the end of a step, as v' = v / (1 + h d) for one unit of inertia. Dry friction is a
constraint of the velocity, which stops a joint within a step and holds it exactly. DART has no armature. It keeps a loop closed
in its velocities, and takes away a hundredth of its gap in each step: the gap is some 1 mm after half a second of a linkage of
1 m with steps of 1 ms. Sleeping is switched off.

Where accelerations overflow, DART sets them to zero and goes on. The adapter signals this as a divergence.
"""

from bodycheck.adapters.installation import Installation

#: What the engine is installed from.
INSTALLATION = Installation("dartpy")
