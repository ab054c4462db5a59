"""The command line: it registers all commands, and turns errors into messages and exit codes."""

import errno
import os
import sys
from collections.abc import Callable

from cyclopts import App, CycloptsError, Parameter

from bodycheck.commands.authoring import cases, expect, new, schema, validate
from bodycheck.commands.cite import cite
from bodycheck.commands.compare import compare
from bodycheck.commands.engines import engines
from bodycheck.commands.ensembles import gather, query
from bodycheck.commands.report import diff, report
from bodycheck.commands.rerun import rerun
from bodycheck.commands.run import export, run
from bodycheck.commands.truth import truth
from bodycheck.errors import BAD_INPUT, FAILED, INTERRUPTED, NO_READER, NO_ROOM, SHOWN_OF_NAME, BadInput, Failed
from bodycheck.runner_log import ReaderGone, escaped, guarded
from bodycheck.site.command import site, submit
from bodycheck.studies import plain_command

app = App(
    name="bodycheck",
    help="Compare physics engines with the exact mechanics of a rigid body.",
    help_epilogue="Exit codes: 0 success; 1 an expectation or a run failed; 2 bad input or usage; 130 interrupted; "
    "141 the program that reads the output has ended.",
    version_flags=["--version"],
    default_parameter=Parameter(negative=(), show_default=False),
    suppress_keyboard_interrupt=False,  # `main` says that the command was interrupted
)

#: All commands, in the order of their registration.
COMMANDS: tuple[Callable[..., int] | App, ...] = (
    run,
    *plain_command.of_studies(),
    gather,
    query,
    *(compare, report, rerun, diff, site, submit, truth, export, cases, engines, validate, new, schema, expect, cite),
)

for command in COMMANDS:
    app.command(command)


def main() -> None:
    """Run the command line and exit with its code."""
    try:
        with guarded():
            code = _exit_code()
    except ReaderGone:
        _drop_output()
        code = NO_READER
    sys.exit(code)


def _exit_code() -> int:
    """Run the command line and return its exit code. Raises `ReaderGone` if nothing reads its output any more."""
    try:
        code: int = app(exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
    except (CycloptsError, BadInput) as error:
        print(escaped(str(error)), file=sys.stderr)
        code = BAD_INPUT
    except Failed as error:
        print(escaped(str(error)), file=sys.stderr)
        code = FAILED
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            print(f"{str(error.filename)[:SHOWN_OF_NAME]!r}…: this name is too long for a file or folder", file=sys.stderr)
        elif error.errno in NO_ROOM:
            print(f"bodycheck: cannot write: {error}", file=sys.stderr)
        else:
            raise
        code = BAD_INPUT
    except KeyboardInterrupt:
        print("bodycheck: interrupted", file=sys.stderr)
        code = INTERRUPTED
    return code


def _drop_output() -> None:
    """Connect stdout and stderr to the null device, so that Python finds no error in the rest of the output when it ends."""
    null = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        os.dup2(null, stream.fileno())
    os.close(null)
