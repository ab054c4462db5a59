"""The adapter of MuJoCo.

The module `engine` is the adapter. `models` builds and compiles the models of a scene, `contact` writes contacts into the XML,
and `stepping` advances a compiled model. `worlds` advances several scenes, whose models `bodies` makes. `mechanism_xml` writes
bodies on joints, and `mechanisms` steps them. `robots` reads robot models: `robot_joints` converts their states, `robot_terms`
computes their terms, and `robot_model` converts a compiled model to a robot model.

A body of links is a free joint with the first link, and the other links are bodies without a joint in it. MuJoCo rotates every
tensor to its principal axes when it compiles the model. The velocity of the free joint is the velocity of the origin of the
first link's frame. If the centre of mass is elsewhere, steps have an error of the integrator's order, even without forces.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("mujoco")
