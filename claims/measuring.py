"""Run the commands and scripts of claims in the releases of engines, and compare what they give with the records."""

import csv
import io
import os
import shlex
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bodycheck.adapters import registry
from bodycheck.environments import environments
from bodycheck.environments.environments import Environment
from claims.records import CLAIMS, PRINTED, Claim, Value

#: Longest time in s that one command or one script may take.
LIMIT_S = 1800.0

#: The rows of a table, each a cell by the name of its column.
Rows = Sequence[Mapping[str, str]]


class Failed(Exception):
    """A command or script could not be run, or does not give a value; the text says which."""


@dataclass(frozen=True)
class Commands:
    """Commands that are run once, although several claims have them.

    Attributes
    ----------
    folder
        An empty folder for the results of commands.
    outputs
        The folder of results and the text on the terminal of each command that has run.
    """

    folder: Path
    outputs: dict[str, tuple[Path, str]] = field(default_factory=dict)

    def tables(self, command: str) -> tuple[Path, str]:
        """Run a command from the folder of the checkout; return the folder of its results and what it printed.

        Exit code 1 means that bodycheck measured something that failed, which a claim may be about. Raises `Failed`.
        """
        if command not in self.outputs:
            out = self.folder / str(len(self.outputs))
            program, *arguments = shlex.split(command)
            start = [sys.executable, "-m", "bodycheck"] if program == "bodycheck" else [sys.executable]
            options = ["--out", str(out)] if program == "bodycheck" else []
            done = _run([*start, *arguments, *options], CLAIMS.parent, {}, command)
            if done.returncode not in (0, 1):
                raise Failed(f"{command}: exit code {done.returncode}: {done.stderr[-2000:]}")
            self.outputs[command] = out, done.stdout
        return self.outputs[command]


def deviations(claim: Claim, release: str, commands: Commands) -> Iterator[str]:
    """Yield a line for each value of a claim that its command or its script does not give in a release."""
    command = command_of(claim, release)
    printed = script_values(claim, release, commands.folder)
    for name, value in claim.values.items():
        if not value.in_release(release):
            continue
        if value.table is not None:
            cell = _cell(value, command, *commands.tables(command))
            if (deviation := _deviation(value, cell)) is not None:
                yield f"{claim.name}: {name}: {command}: {deviation}"
        if value.script:
            deviation = _deviation(value, printed[name]) if name in printed else "does not print it"
            if deviation is not None:
                yield f"{claim.name}: {name}: {claim.name}.py with {claim.engine} {release}: {deviation}"


def command_of(claim: Claim, release: str) -> str:
    """Return the command of a claim for a release: after `--engine`, `audit` and `sensors`, NAME becomes NAME@RELEASE."""
    words = shlex.split(claim.command)
    for place, word in enumerate(words):
        if word == claim.engine and words[place - 1] in ("--engine", "audit", "sensors"):
            words[place] = f"{word}@{release}"
    return shlex.join(words)


def script_values(claim: Claim, release: str, folder: Path) -> dict[str, str]:
    """Run the script of a claim with a release of the engine in a folder; return what it prints, by key. Raises `Failed`."""
    python, variables = _interpreter(claim.engine, release)
    done = _run([python, "-P", str(claim.script)], folder, variables, f"{claim.name}.py")
    if done.returncode:
        raise Failed(f"{claim.name}.py with {claim.engine} {release}: exit code {done.returncode}: {done.stderr[-2000:]}")
    lines = (line.split(None, 1) for line in done.stdout.splitlines())
    return {words[0]: words[1].strip() for words in lines if len(words) == 2}


def _interpreter(engine: str, release: str) -> tuple[str, dict[str, str]]:
    """Return the interpreter with a release, which is installed if it is not there, and the variables of its processes."""
    if registry.installed(engine) == release:
        return sys.executable, dict(registry.installation(engine).variables_in(None))
    environment: Environment = environments.obtain(engine, release)
    return str(environment.python), dict(environments.variables(environment))


def _run(command: Sequence[str], folder: Path, variables: Mapping[str, str], name: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **variables}
    try:
        return subprocess.run(command, capture_output=True, text=True, cwd=folder, env=environment, timeout=LIMIT_S)
    except subprocess.TimeoutExpired as error:
        raise Failed(f"{name}: took longer than {LIMIT_S:g} s") from error


def _cell(value: Value, command: str, folder: Path, printed: str) -> str:
    """Return the cell of a value in the tables of a command. Raises `Failed` unless one row is meant, or all are the same."""
    assert value.table is not None
    assert value.column is not None
    try:
        text = printed if value.table == PRINTED else (folder / value.table).read_text("utf-8")
        rows = _printed_rows(text) if value.table == PRINTED else list(csv.DictReader(io.StringIO(text)))
    except OSError as error:
        raise Failed(f"{command}: {value.table}: cannot be read: {error}") from error
    if missing := [name for name in (value.column, *value.row) if all(name not in row for row in rows)]:
        raise Failed(f"{command}: {value.table}: has no column {', '.join(missing)}")
    # A command may print several tables, of which one has all the columns.
    whole = [row for row in rows if value.column in row and set(value.row) <= set(row)]
    cells = {row[value.column] for row in whole if all(_equal(row[name], cell) for name, cell in value.row.items())}
    if len(cells) != 1:
        raise Failed(f"{command}: {value.table}: {len(cells)} values in rows with {dict(value.row)}, allowed: 1")
    return cells.pop()


def _printed_rows(text: str) -> Rows:
    """Return the rows of all tables in Markdown."""
    rows: list[dict[str, str]] = []
    head: list[str] = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []
        if not cells or not head:
            head = cells
        elif not set(line) <= set("|-: "):
            rows.append(dict(zip(head, cells, strict=True)))
    return rows


def _equal(cell: str, expected: str | float) -> bool:
    """Return whether a cell has the contents that a row is chosen by; the release of an engine, after @, does not count."""
    if isinstance(expected, str):
        return expected in (cell, cell.partition("@")[0])
    try:
        return float(cell) == expected
    except ValueError:
        return False


def _deviation(value: Value, measured: str) -> str | None:
    """Return how a measured value deviates from the record by more than its tolerance; None if it does not."""
    if isinstance(value.value, str):
        return None if measured == value.value else f"gives {measured!r}, the record says {value.value!r}"
    try:
        number = float(measured)
    except ValueError:
        return f"gives {measured!r}, the record says {value.value}"
    assert value.tolerance is not None
    if abs(number - value.value) <= value.tolerance * (abs(value.value) or 1.0):
        return None
    return f"gives {number:.6g}, the record says {value.value:.6g} within {value.tolerance:g}"
