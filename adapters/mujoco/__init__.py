"""The adapter of MuJoCo.

The module `engine` is the adapter. `models` builds and compiles the models of a scene, `contact` writes contacts into the XML,
and `stepping` advances a compiled model. `worlds` advances several, whose models `bodies` makes. `mechanism_xml` writes bodies
on joints, and `mechanisms` steps them. `robots` reads robot models: `robot_joints` converts their states, `robot_terms`
computes, and `robot_model` makes a robot model of a compiled one.

A body of links is a free joint with the first link, in which the others are bodies without a joint. MuJoCo turns every
tensor to its principal axes when it compiles the model. The velocity of the free joint is that of the origin of the first
link's frame, so that steps of a centre of mass that is elsewhere have an error of the order of the integrator, even without
forces.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("mujoco")
