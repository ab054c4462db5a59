"""The adapter of MuJoCo.

The module `engine` is the adapter. `models` builds the models of a scene, `contact` writes contacts into the XML, and
`stepping` advances a compiled model.
"""

#: The package that installs the engine.
DISTRIBUTION = "mujoco"
