"""The adapter of Pinocchio.

The module `engine` is the adapter. `models` lists the models of a scene, `joints` builds the joints of a body, `schemes`
contains the integration schemes, and `contact` steps a body with Pinocchio's rigid contact.
"""

from bodycheck.adapters.installation import Installation

#: What the engine is installed from.
INSTALLATION = Installation("pin")
