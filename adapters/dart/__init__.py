"""The adapter of DART (`dartpy`), a C++ engine of articulated rigid bodies that computes in double precision.

The module `engine` is the adapter, `contact` builds the plane, the shape of the body and the solver of the contacts.

DART has one time integrator, which its class `World` steps: semi-implicit Euler. The body is on a `FreeJoint`. Experiments show
that its six velocities are the angular and then the linear velocity, both along the axes of the world. A step adds h times
their accelerations, and then turns the body by h times its new angular velocity. Its states agree, except for rounding, with
semi-implicit Euler on the angular velocity in the body frame, because a rotation about the angular velocity does not change the
components of this vector. The attitude is kept as a rotation vector, so that no quaternion has to be normalised. Drag is an
external force that is computed at the start of each step.

On a plane DART detects collisions, and solves one problem for the impulses of all contacts. The option `solver` selects how:

- Dantzig's algorithm, DART's default, and projected Gauss-Seidel (`solver=pgs`) limit the friction of a contact by a box: each
  of two components, along x and y of the world, is at most the coefficient times the normal force. Friction that is oblique to
  these axes is up to 1.41 times too large.
- `solver=nsgs` and `solver=fbf` have Coulomb's cone (nonsmooth Gauss-Seidel, and forward-backward-forward splitting).

All solvers have DART's own tolerances and limits of iterations. The plane is the upper face of a large box, because most
detectors find one contact between a plane and a box, but four contacts between two boxes. The option `detector` selects DART's
own detector, or the detectors FCL, Bullet and ODE that DART includes. Without this option, a brick has Bullet's detector, which
puts contacts at the corners of a brick that only touches, and a cylinder has ODE's, which puts eight contacts on the rim.
DART's own detector and FCL find one contact under a cylinder, which then tips over; FCL and ODE find no contact in the first
step, before there is a penetration. DART's own detector puts some contacts inside the face, and with an iterative solver its
results differ between runs in one process.

DART's sleeping, which stops bodies that have been slow for half a second, is switched off. `settings=engine` has DART's own
defaults: sleeping, and the detector FCL. In flight these defaults make no difference. Two properties cannot be switched off
from Python: the softness of contacts (constraint force mixing 1e-5, error reduction 0.01 of a penetration in a step, at most
1 mm/s), and DART's removal of lateral and tilting velocities below 0.2 mm/s and 0.5 mrad/s that a contact caused.

Bodies that touch a plane and each other in any other way are in the module `touching`, with the same detectors and solvers.
Bricks lie on the large box, and round bodies alone on DART's plane. DART takes the smaller coefficient of friction of two
bodies, and the product of their coefficients of restitution; the bodies have coefficients that give each pair its own. DART
returns a part of the velocity that the bodies would have at the end of the step, so that an impact with a coefficient of 1 adds
g h to the speed. Rebounds slower than 0.1 m/s are left out.

Links are bodies on weld joints. The velocity of the free joint is the velocity of the origin of the first link's frame. If the
centre of mass is elsewhere, a step therefore has an error of first order, even without forces.

Mechanisms have DART's own joint for each type; the module `mechanisms` describes their properties. The observed order is one on
joints of all types. DART evaluates damping and springs at the end of a step, as v' = v / (1 + h d) for one unit of inertia. Dry
friction is a constraint of the velocity, which stops a joint within a step and holds it exactly. DART has no armature. It keeps
the velocities of a loop closed, and removes a hundredth of the loop's gap in each step: the gap of a linkage of 1 m is some 1
mm after half a second with steps of 1 ms. Sleeping is switched off, and `settings=engine` keeps it.

If accelerations overflow, DART sets them to zero and continues. The adapter reports this as a divergence.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("dartpy")
