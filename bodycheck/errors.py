"""What a user can get wrong, and what a command ends in."""

#: Exit codes. FAILED: an expectation or a run.
OK, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


class BadInput(Exception):
    """Bad input or usage: the text says what was read and what is allowed. The command line answers with exit code 2."""


class BadFolder(BadInput):
    """A folder of results is missing, damaged or holds other files; the text says which."""
