"""The exit codes of commands, and the exception for bad input."""

import errno

#: Exit codes of commands. FAILED means that an expectation or a run failed. INTERRUPTED and NO_READER are 128 plus the numbers
#: of the signals SIGINT and SIGPIPE, as in shells.
OK, FAILED, BAD_INPUT, INTERRUPTED, NO_READER = 0, 1, 2, 130, 141


#: Errors of the operating system if the disk is full or read-only, or a file is too large for a quota or a limit.
NO_ROOM = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS})

#: The longest part of the name of a file or folder in a message about its length (characters).
SHOWN_OF_NAME = 60


class BadInput(Exception):
    """Bad input or usage. The text says what was read and what is allowed; the command line exits with code 2."""


class Failed(Exception):
    """The requested work failed; the text says how, and the command line exits with code 1."""


class BadFolder(BadInput):
    """A folder of results is missing, damaged or holds other files; the text says which."""
