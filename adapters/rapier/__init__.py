"""The adapter of Rapier, a physics engine in Rust, by its Python bindings `rapier3d`, which compute in single precision.

Rapier integrates rigid bodies by one scheme, `symplectic-euler`, of first order. In each step it first corrects the angular
velocity by an explicit Euler step of the angular momentum in the body frame, scaled to the momentum's former length. It then
adds the acceleration of forces, and then advances the pose with the new velocities. The attitude q becomes (1 + h w / 2) q,
normalised, for the angular velocity w: a rotation by 2 atan(h |w| / 2) instead of h |w|.

The first method in tables is `settings=engine`, with Rapier's own settings: its contacts and joints are made for four substeps
in each step. In the method without options, which shows the scheme by itself, Rapier's four substeps in each step, its limits
of pi/4 of rotation in a step and of 400 m/s, sleeping, and continuous collision detection are switched off. The step itself
makes the iterations of the contact solver that Rapier distributes over its substeps. Rapier sets no damping. Drag is a force
that is computed at the start of a step and held through it, so that the order against drag is that of the adapter.

Frames, as found by experiment: Rapier returns the position and the velocity of the centre of mass and the angular velocity in
the world frame. `Rotation3` is built from w, x, y, z, but its attribute `quaternion` is x, y, z, w. The adapter makes the
principal axes the frame of the body. Rapier normalises quaternions in single precision, and the adapter in double precision.

In single precision, errors grow again below time steps of some milliseconds, the more the shorter the step.

A body on a plane lies on a half-space, and Rapier has two models of its friction. The default solves for one friction force of
all contacts of a face and one torque against the spin of the face, each with its own bound, so that translation and spin are
braked independently of each other; a pure spin stops as with four corners. The option `friction=coulomb` selects a friction
cone for each corner: the impulse that would stop the corner is cut to the cone, and is not parallel to the velocity. A brick
that slides straight then ends 4 to 25 % too far, depending on its proportions and its direction, even with many iterations and
short time steps. Bodies that roll, bounce, rest or tip are in the module `touching`.

Links are read from a URDF file, whose tensors Rapier diagonalises in single precision. They are joined by fixed joints between
bodies in maximal coordinates, because Rapier takes no initial velocity of bodies in reduced coordinates.

Mechanisms are bodies that Rapier's revolute, prismatic, spherical and fixed impulse joints hold together (module `mechanisms`).
Rapier's joints of bodies in reduced coordinates are not used, because these bodies take no initial velocities. The order is
one. Joints and loops of bodies of similar size come apart by some hundredths of a millimetre with steps of 1 ms, but the joints
of a fast top on light rings, as in the case `lagrange-top-hinges`, come apart by metres. Damping and springs are motors, which
act at the end of a step. Rapier has no armature, no constant force and no dry friction in a joint.

The module `sensing` reads what Rapier reports for sensors.

Rapier quarantines a body whose state is no longer finite, which the adapter reports as a reset. Rapier's bodies in reduced
coordinates need a joint between two bodies, which a free body does not have.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine. One thread is enough for one body, and Rapier would start one for each core.
INSTALLATION = Installation("rapier3d", variables={"RAYON_NUM_THREADS": "1"})
