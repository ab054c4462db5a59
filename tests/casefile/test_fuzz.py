"""Case files come from strangers: whatever one holds, it is a case or has faults with places, and nothing else happens.

Good files are mutated, and read in a process that watches what it does.
"""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from bodycheck.casefile.case import MAX_FILE_BYTES
from tests.support import ROOT
from tests.support.commands import bodycheck
from tests.support.mutants import RICH

#: How a program of its own imports what makes mutants and watches.
IMPORTED = f"import sys; sys.path.insert(0, {str(ROOT)!r}); from tests.support import mutants"


def watched(folder: Path, seed: int, count: int) -> dict[str, Any]:
    """What `watch` found, in a process that any warning would end."""
    code = f"{IMPORTED}\nmutants.watch({str(folder)!r}, {seed}, {count})"
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stderr == ""
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize(("seed", "count"), [(1, 500), pytest.param(2, 10_000, marks=pytest.mark.slow)])
def test_a_mutant_is_a_case_or_has_faults_with_places(tmp_path: Path, seed: int, count: int) -> None:
    """Each within a second of processor time, without opening, importing, compiling or starting anything."""
    found = watched(tmp_path, seed, count)
    assert found["problems"] == []
    assert found["ends"]["faults"] > count / 2, "the mutations do too little"
    assert found["left"] == ["mutant.case.toml"]
    # A file may have 256 KiB, of which pydantic and tree-sitter make some hundred bytes of objects a byte.
    assert found["memory"] < 256, "MiB"


def test_the_watch_sees_what_is_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A process that opens another file, compiles, or starts a program is seen to do so."""
    code = (
        f"{IMPORTED}\nimport bodycheck.casefile.case, subprocess\n"
        "def load(path):\n"
        "    open('/dev/null').close(); eval('1'); subprocess.run(['true']); return good(path)\n"
        "good, mutants.load = mutants.load, load\n"
        "mutants.mutants = lambda seed, count: [('none', mutants.RICH.encode())]\n"
        f"mutants.watch({str(tmp_path)!r}, 0, 1)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    (problem,) = json.loads(done.stdout)["problems"]
    assert all(event in problem for event in ("open ['/dev/null'", "compile", "subprocess.Popen"))


MALFORMED = {
    "nothing": b"",
    "not-toml": b"= 3\n",
    "not-utf8": b"format = 1\nname = \xff\n",
    "nul": RICH.replace("rich", "ri\0ch").encode(),
    "digits": RICH.replace("9.81", "9" * 5000).encode(),
    "digits after a sign": RICH.replace("9.81", "-" + "9" * 5000).encode(),
    "deep": ("x = " + "[" * 5000 + "]" * 5000 + "\n" + RICH).encode(),
    "dotted": ("x." * 100_000 + "x = 1\n" + RICH).encode(),
    "large": RICH.encode() + b"#" * MAX_FILE_BYTES,
    "samples": RICH.replace("samples = 101", "samples = 1000000000000").encode(),
    "duration": RICH.replace("duration = 1.0", "duration = 1e12").encode(),
}


@pytest.mark.parametrize("command", ["validate", "run", "truth"])
def test_the_command_line_answers_a_malformed_file_with_a_message(tmp_path: Path, command: str) -> None:
    paths = [tmp_path / f"{name}.case.toml" for name in MALFORMED]
    for path, content in zip(paths, MALFORMED.values(), strict=True):
        path.write_bytes(content)
    for given in [paths] if command != "truth" else [[path] for path in paths[:3]]:
        done = bodycheck(command, *given)
        assert done.returncode == 2
        assert done.stdout == ""
        assert "Traceback" not in done.stderr
        assert all(any(line.startswith(f"{path}:") for line in done.stderr.splitlines()) for path in given)
    assert sorted(tmp_path.iterdir()) == sorted(paths)
