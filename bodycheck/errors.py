"""The exit codes of commands, and the exception for bad input."""

#: Exit codes of commands. FAILED means that an expectation or a run failed.
OK, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


class BadInput(Exception):
    """Bad input or usage. The text says what was read and what is allowed; the command line exits with code 2."""


class Failed(Exception):
    """What was asked for failed; the text says how, and the command line exits with code 1."""


class BadFolder(BadInput):
    """A folder of results is missing, damaged or holds other files; the text says which."""
