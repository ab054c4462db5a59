"""The adapter of PhysX 5 on the CPU, by the Python package SAPIEN, which contains it. PhysX computes in single precision.

The integrators are PhysX's two solvers, `PGS` (projected Gauss-Seidel) and `TGS` (temporal Gauss-Seidel, SAPIEN's default).
On a free body they are the same scheme of first order. A step first advances the angular velocity by an explicit Euler step of
the angular momentum in the body frame, scaled to the momentum's former length. It then adds gravity and forces, and then
advances the pose with the new velocities, the attitude by the exponential map. SAPIEN itself switches PhysX's gyroscopic forces
on.

The angular damping of 0.05 per second, the limit of 100 rad/s, and sleeping are switched off. With `settings=engine` they are
as SAPIEN and PhysX set them, which is the same for both solvers and has neither linear damping nor substeps. All methods keep
SAPIEN's 10 position iterations and one velocity iteration, which matter in contacts only.

Frames, as found by experiment: the pose of an entity is the pose of the body's own frame, the quaternion is w, x, y, z, and
both velocities are in the world frame. The adapter makes the principal axes through the centre of mass the body's own frame.
PhysX normalises quaternions in single precision, and the adapter in double precision. The normal of a plane and the axis of a
cylinder are along x.

In single precision, errors grow again below time steps of a millisecond or so, first with TGS, which scales the angular
velocity by the root of the inertia and back in each step: even a steady spin changes by a fraction of some 5e-7 a step.

A body on a plane has up to four contacts, but PhysX's friction acts at anchors in each patch of contacts and not at the
contacts. In the limit of small time steps a straight slide is right; a pure spin of a brick ends too early with PGS, by some
30 %, and a few percent too late with TGS. PhysX's other models of friction cannot be selected in SAPIEN. A cylinder is a
polyhedron in SAPIEN. Bodies that roll, bounce, rest or tip are in the module `touching`.

Links are read from a URDF file, whose tensors SAPIEN diagonalises. A single link is a rigid body. Several links are an
articulation in PhysX's reduced coordinates, which is another scheme of first order, and for which SAPIEN sets more defaults:
linear damping of 0.05 per second, and limits of 10 m/s and 50 rad/s. All of them are switched off except with
`settings=engine`.

PhysX silently stops a body whose speed it cannot square in single precision.

Mechanisms are articulations of PhysX; the module `mechanisms` describes how they are built. Of the joints in the cases, PhysX's
articulations have revolute, prismatic and fixed joints. The order is one. Damping and springs are PhysX's drives, which PGS
evaluates at the end of a step and TGS at the ends of ten parts of it. PhysX's joint friction is a coefficient of the force in
the joint and not a constant force, so that dry friction is not modelled. Loops are not modelled, and neither are ball joints,
which SAPIEN's articulations do not have.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("sapien")
