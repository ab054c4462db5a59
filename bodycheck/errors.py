"""What a user can get wrong, and what a command ends in."""

OK, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
"""Exit codes. FAILED: an expectation or a run."""


class BadInput(Exception):
    """Bad input or usage: the text says what was read and what is allowed. The command line answers with exit code 2."""
