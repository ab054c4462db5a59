"""The adapter of Pinocchio: `engine` is the adapter, `joints` carry a body, `schemes` step it, `contact` is rigid contact."""

#: The package that installs the engine.
DISTRIBUTION = "pin"
