"""The entry point of the command `bodycheck`, and of `python -m bodycheck`.

The command line is imported in here, so that an interruption or a failure during this import ends with a message too.
"""

import io
import os
import sys

from bodycheck.errors import BAD_INPUT, INTERRUPTED


def main() -> None:
    """Run the command line and exit with its code."""
    open_standard_streams()
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # names of files may have bytes that no encoding knows
    try:
        from bodycheck.commands.command_line import main as run_command_line
    except KeyboardInterrupt:
        sys.exit(_told("interrupted", INTERRUPTED))
    except (ImportError, MemoryError) as error:
        sys.exit(_told(f"cannot start: {type(error).__name__}: {error}", BAD_INPUT))
    run_command_line()


def open_standard_streams() -> None:
    """Open the null device for each standard stream that the caller closed.

    Otherwise the next file that is opened gets the number of the closed stream, and what is printed goes into that file.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free, which is this one
            os.set_inheritable(number, True)
            setattr(sys, name, open(number, "w" if number else "r", encoding="utf-8", closefd=False))  # noqa: SIM115


def _told(text: str, code: int) -> int:
    """Print a message on stderr and return the exit code that belongs to it."""
    print(f"bodycheck: {text}", file=sys.stderr)
    return code


if __name__ == "__main__":
    main()
