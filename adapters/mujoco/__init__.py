"""The adapter of MuJoCo.

The module `engine` is the adapter. `models` builds the models of a scene, `contact` writes contacts into the XML, and
`stepping` advances a compiled model.
"""

from bodycheck.adapters.installation import Installation

#: What the engine is installed from.
INSTALLATION = Installation("mujoco")
