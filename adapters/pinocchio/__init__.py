"""The adapter of Pinocchio.

The module `engine` is the adapter. `models` lists the models of a scene, `joints` builds the joints of a body, `coordinates`
converts their coordinates to states, `schemes` contains the integration schemes, `flights` steps bodies in flight, and
`contact` steps a body with Pinocchio's rigid contact. `mechanism_model` builds bodies on joints, and `mechanisms` steps them by
the same schemes. `robots` reads robot models: `robot_joints` converts their states.

Links are appended to the last joint, like the bodies of fixed joints in a URDF file, and Pinocchio adds up their inertia.
Schemes on the body twist take the same steps about any origin. `semi-implicit-euler` integrates the velocity of the origin of
the first link's frame. If the centre of mass is elsewhere, its steps have an error of first order, even without forces.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("pin", modules=("pinocchio",))
