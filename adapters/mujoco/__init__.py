"""The adapter of MuJoCo: `engine` is the adapter, `models` has its models of a scene, `contact` its contacts and
`stepping` its steps.
"""

#: The package that installs the engine.
DISTRIBUTION = "mujoco"
