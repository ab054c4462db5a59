"""Pages to be followed: their commands, the files that they show, and whether what is printed is what they show.

In a page, a block `console` has commands after `$ ` and below each what it prints; a command goes on after a backslash at the
end of its line. A block in any other language is a file, whose name ends the paragraph before it, as in "Save this as
`name.toml`:". The comment `<!-- downloads -->` stands before a block whose commands need a network, and `<!-- an example -->`
before one that is not followed. Blocks of Sphinx, such as `{include}`, are left alone. In what a page shows, `…` stands for
anything.
"""

import os
import pty
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from tests.support import ROOT
from tests.support.commands import bodycheck
from tests.support.terminals import terminal

#: The comment before a block whose commands need a network.
DOWNLOADS = "<!-- downloads -->"

#: The comment before a block that is not followed.
EXAMPLE = "<!-- an example -->"

#: Largest relative difference of a printed number from the one in a page, which has two to four digits.
TOLERANCE = 0.01

#: Size below which numbers are rounding of sums and products of numbers of size 1, after thousands of steps.
ROUNDING = 1e-9

#: Columns of the terminals whose output pages show.
WIDTH = 80

_NUMBER = r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?!\.?\w)"
_TOKEN = re.compile(rf"{_NUMBER}|[^\W\d_]+|([=_-])\1+|\S")


@dataclass(frozen=True)
class Command:
    """A command of a page, with its line there, what the page shows below it, and whether it needs a network."""

    line: int
    text: str
    shown: str
    downloads: bool


@dataclass(frozen=True)
class File:
    """A file that a page shows."""

    name: str
    text: str


@dataclass(frozen=True)
class Printed:
    """What a command printed on its terminal, and its exit code."""

    command: Command
    text: str
    code: int


def steps(page: Path) -> list[Command | File]:
    """The commands and files of a page, in order. Raises ValueError for a block that is neither."""
    lines = page.read_text("utf-8").splitlines()
    found: list[Command | File] = []
    fences = iter(place for place, line in enumerate(lines) if line.startswith("```"))
    for first, last in zip(fences, fences, strict=True):
        before = next((line for line in reversed(lines[:first]) if line), "")
        if lines[first] == "```console":
            found += _commands(lines[first + 1 : last], first + 2, before == DOWNLOADS)
        elif lines[first].startswith("```{") or before == EXAMPLE:
            continue
        elif named := re.search(r"`([\w./-]+)`:$", before):
            found.append(File(named[1], "\n".join(lines[first + 1 : last]) + "\n"))
        else:
            raise ValueError(f"{page}:{first + 1}: this block is neither commands nor a file with a name")
    return found


def _commands(lines: Sequence[str], number: int, downloads: bool) -> Iterator[Command]:
    starts = [place for place, line in enumerate(lines) if line.startswith("$ ")]
    for start, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        last = next(place for place in range(start, end) if not lines[place].endswith("\\"))
        text = " ".join(line.removesuffix("\\").strip() for line in lines[start : last + 1])
        yield Command(number + start, text.removeprefix("$ "), "\n".join(lines[last + 1 : end]), downloads)


def follow_here(page: Path, folder: Path) -> list[Printed]:
    """Follow a page in a folder without a network: bodycheck's commands in this process, all others by a shell."""
    done: list[Printed] = []
    for step in steps(page):
        if isinstance(step, File):
            (folder / step.name).write_text(step.text, "utf-8")
        elif step.text.startswith("bodycheck "):
            if not step.downloads:
                done.append(_here(step, folder))
        elif not step.downloads:
            code = done[-1].code if done else 0
            done.append(_by_shell(step, folder, code))
    return done


def _here(command: Command, folder: Path) -> Printed:
    with terminal(WIDTH) as screen:
        ended = bodycheck(*shlex.split(command.text)[1:], folder=folder, stdout=screen, COLUMNS=str(WIDTH), NO_COLOR="1")
    # Faults of input go to stderr, which a reader sees on the same terminal.
    return Printed(command, screen.getvalue() + (ended.stderr if ended.returncode == 2 else ""), ended.returncode)


def _by_shell(command: Command, folder: Path, code: int) -> Printed:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "PYTHONPATH": str(ROOT), "COLUMNS": str(WIDTH), "NO_COLOR": "1"}
    script = f"(exit {code}); {command.text}"
    ended = subprocess.run(["bash", "-c", script], cwd=folder, env=environment, text=True, stdout=subprocess.PIPE)
    return Printed(command, ended.stdout, ended.returncode)


def follow_afresh(followed: Sequence[Command | File], folder: Path, environment: Mapping[str, str]) -> list[Printed]:
    """Follow the steps of a page from a folder by one shell on a terminal, as a reader does, with all that needs a network.

    environment: the variables of the shell, to which those of the terminal come.
    """
    folder.mkdir(exist_ok=True)
    errors = folder.parent / "errors"
    errors.mkdir()
    commands: list[Command] = []
    script = [f"cd {shlex.quote(str(folder))}", "code=0"]
    for step in followed:
        if isinstance(step, File):
            script.append(f"cat > {shlex.quote(step.name)} << 'END OF FILE'\n{step.text}END OF FILE")
        else:
            # The command sees the exit code of the one before it.
            run = f"{{ {step.text}\n}} 2> {shlex.quote(str(errors / str(len(commands))))}"
            script += ["(exit $code)", run, "code=$?", r"printf '\036%s\036' $code"]
            commands.append(step)
    (folder.parent / "script").write_text("\n".join(script) + "\n", "utf-8")
    fields = _on_terminal(["bash", str(folder.parent / "script")], environment).split("\036")
    done = []
    for number, command in enumerate(commands):
        text, code = fields[2 * number : 2 * number + 2]
        faults = (errors / str(number)).read_text("utf-8")
        done.append(Printed(command, text + (faults if int(code) else ""), int(code)))
    return done


def _on_terminal(command: Sequence[str], environment: Mapping[str, str]) -> str:
    """What a program prints on a terminal of its own."""
    screen, end = pty.openpty()
    variables = {**environment, "COLUMNS": str(WIDTH), "LINES": "24", "NO_COLOR": "1", "TERM": "dumb"}
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=end, env=variables, start_new_session=True):
        os.close(end)
        parts = []
        # A terminal whose program has ended is an error to read on Linux.
        with suppress(OSError):
            while part := os.read(screen, 65536):
                parts.append(part)
    os.close(screen)
    return b"".join(parts).decode("utf-8")


def failures(done: Sequence[Printed]) -> list[str]:
    """What of the commands of a page is not as the page says, in words. One that fails is followed by `echo $?`."""
    told = []
    for printed, after in zip(done, [*done, None][1:], strict=True):
        where = f"line {printed.command.line}: {printed.command.text}"
        if printed.code and (after is None or after.command.text != "echo $?"):
            told.append(f"{where}\nhas the exit code {printed.code}\n{printed.text}")
        if printed.command.shown and not agrees(printed.command.shown, printed.text):
            told.append(f"{where}\nprints\n{printed.text}\nThe page shows\n{printed.command.shown}")
    return told


def agrees(shown: str, printed: str) -> bool:
    """Whether a text is what a page shows, but for line breaks and widths, within the tolerance, with anything for `…`."""
    # A progress of pytest is overwritten from the beginning of the line.
    text = re.sub(r"^.*\r(?!\n)", "", printed.replace("\r\n", "\n"), flags=re.MULTILINE)
    seen = _tokens(text)
    parts = [_tokens(part) for part in shown.split("…")]
    place = 0
    for number, part in enumerate(parts):
        ends = [len(seen) - len(part)] if number == len(parts) - 1 else range(place, len(seen) - len(part) + 1)
        starts = [place] if number == 0 else [start for start in ends if start >= place]
        if number == 0 and len(parts) == 1 and len(part) != len(seen):
            return False
        matching = [start for start in starts if _same(part, seen[start : start + len(part)])]
        if not matching:
            return False
        place = matching[0] + len(part)
    return True


def _tokens(text: str) -> list[str]:
    return [match[0][:2] if match[1] else match[0] for match in _TOKEN.finditer(text)]


def _same(shown: Sequence[str], seen: Sequence[str]) -> bool:
    return len(shown) == len(seen) and all(map(_alike, shown, seen))


def _alike(shown: str, seen: str) -> bool:
    if not (re.fullmatch(_NUMBER, shown) and re.fullmatch(_NUMBER, seen)):
        return shown == seen
    one, other = abs(float(shown)), abs(float(seen))
    return abs(float(shown) - float(seen)) <= TOLERANCE * max(one, other) or max(one, other) < ROUNDING
