"""What a user can get wrong."""


class BadInput(Exception):
    """Bad input or usage: the text says what was read and what is allowed. The command line answers with exit code 2."""
