"""Commands, called in the process of a test or in one of their own."""

import dataclasses
import inspect
import io
import os
import subprocess
import sys
import warnings
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import pytest

from bodycheck.commands.command_line import app, main
from bodycheck.console.arguments import Robots

#: Columns of a terminal that are enough for any table, whatever terminal runs the tests.
COLUMNS = "200"

Done = subprocess.CompletedProcess[str]


def call(*arguments: object) -> int:
    """The exit code of a command in this process, which prints to wherever the test does. Raises what `main` would print."""
    code = app(list(map(str, arguments)), exit_on_error=False, print_error=False, result_action="return_value")
    assert isinstance(code, int)
    return code


def bodycheck(*arguments: object, folder: Path | None = None, stdout: io.StringIO | None = None, **environment: str) -> Done:
    """A command in this process, from `main` on: its exit code and what it printed.

    folder: where it is called, stdout: what it prints to, environment: variables to be set. Those of GitHub's workflows are not
    there unless given.
    """
    stdout, stderr = stdout or io.StringIO(), io.StringIO()
    command = ["bodycheck", *map(str, arguments)]
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(stdout), redirect_stderr(stderr), warnings.catch_warnings():
        patch.setattr(sys, "argv", command)
        for name in set(os.environ) - set(_environment({})):
            patch.delenv(name)
        for name, value in _environment(environment).items():
            patch.setenv(name, value)
        if folder is not None:
            patch.chdir(folder)
        # It takes its arguments from `sys.argv`, as it does outside of tests.
        warnings.filterwarnings("ignore", "Cyclopts application invoked without tokens")
        with pytest.raises(SystemExit) as ended:
            main()
    return subprocess.CompletedProcess(command, int(ended.value.code or 0), stdout.getvalue(), stderr.getvalue())


def bodycheck_process(*arguments: object, prelude: str = "", folder: Path | None = None, **environment: str) -> Done:
    """The same in a process of its own. prelude: Python code that is run there before the command is imported."""
    command = as_process(*arguments, prelude=prelude)
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, env=_environment(environment))


def as_process(*arguments: object, prelude: str = "") -> list[str]:
    """The program and its arguments that make a command a process."""
    start = "import sys\nsys.argv = ['bodycheck', *sys.argv[1:]]\nfrom bodycheck.commands.command_line import main\nmain()"
    return [sys.executable, "-c", f"{prelude}\n{start}", *map(str, arguments)]


def _environment(more: dict[str, str]) -> dict[str, str]:
    outside = {name: value for name, value in os.environ.items() if not name.startswith("GITHUB_")}
    return outside | {"COLUMNS": COLUMNS} | more


def parameters_of(command: Callable[..., object]) -> dict[str, inspect.Parameter]:
    """Return the parameters of a command by name, with the options of robots' files as parameters of their own."""
    parameters = dict(inspect.signature(command).parameters)
    if parameters.pop("robots", None) is not None:
        fields = dataclasses.fields(Robots)
        keyword = inspect.Parameter.KEYWORD_ONLY
        parameters |= {each.name: inspect.Parameter(each.name, keyword, default=each.default) for each in fields}
    return parameters
