"""Folders from strangers and full disks: nothing outside a folder is touched, and every fault is a message with exit code 2."""

import errno
import os
import shutil
import stat
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from bodycheck.results import journal
from tests.support import journals
from tests.support.commands import as_process, bodycheck, bodycheck_process
from tests.support.saved_results import SPIN, made

RUN = ("--engine", "mujoco", "--integrator", "Euler", "--jobs", 1)


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory, "run") / "run"


@pytest.fixture
def folder(saved: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(saved, tmp_path / "results"))


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "spin.case.toml"
    path.write_text(SPIN.partition("[[expect]]")[0])
    return path


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A folder with files that nobody may touch."""
    folder = tmp_path / "outside"
    (folder / "deep").mkdir(parents=True)
    for name in ("thesis.txt", "deep/thesis.parquet"):
        (folder / name).write_text("irreplaceable")
    return folder


def untouched(outside: Path) -> bool:
    found = {path.relative_to(outside).as_posix(): path.read_text() for path in outside.rglob("*") if path.is_file()}
    return found == {"thesis.txt": "irreplaceable", "deep/thesis.parquet": "irreplaceable"}


PLANTED = ("trajectories", "trajectories/spin", "figures", "report.html", "results.csv", "run.jsonl.lock", "run.jsonl")


@pytest.mark.parametrize("command", ["run", "report"])
@pytest.mark.parametrize("name", PLANTED)
def test_a_link_in_a_results_folder_is_refused(
    calls_here: None, command: str, name: str, folder: Path, case: Path, outside: Path
) -> None:
    link = folder / name
    if link.is_dir():
        shutil.rmtree(link)
    link.unlink(missing_ok=True)
    link.symlink_to(outside / "thesis.txt" if "." in name else outside)
    words = ("report", folder) if command == "report" else ("run", case, *RUN, "--out", folder)
    done = bodycheck(*words)
    assert done.returncode == 2
    assert f"{link}: is a symbolic link; a results folder must not contain any" in done.stderr
    assert untouched(outside)


def test_a_results_folder_may_itself_be_a_link(calls_here: None, folder: Path, tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(folder)
    assert bodycheck("report", tmp_path / "link").returncode == 1  # an expectation of these results is broken


def test_files_that_share_their_content_with_others_are_replaced(
    calls_here: None, folder: Path, case: Path, outside: Path
) -> None:
    for name in ("report.html", "results.csv"):
        (folder / name).unlink()
        (folder / name).hardlink_to(outside / "thesis.txt")
    copied = (folder / "run.jsonl").read_bytes()
    (outside.parent / "backup.jsonl").hardlink_to(folder / "run.jsonl")
    assert bodycheck("run", case, *RUN, "--out", folder).returncode == 0
    assert untouched(outside)
    assert (outside.parent / "backup.jsonl").read_bytes() == copied != (folder / "run.jsonl").read_bytes()


def fill(monkeypatch: pytest.MonkeyPatch, room: int) -> None:
    """Make every file system full after some more bytes."""
    write, left = os.write, [room]

    def limited(descriptor: int, content: memoryview) -> int:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            return write(descriptor, content)
        if left[0] == 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written = write(descriptor, content[: left[0]])
        left[0] -= written
        return written

    monkeypatch.setattr(os, "write", limited)


@pytest.mark.parametrize("room", [0, 500, 3000, 8000, 13000, 30_000])
def test_a_full_disk_is_said_and_the_run_is_resumed(
    calls_here: None, room: int, case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    with monkeypatch.context() as patch:
        fill(patch, room)
        done = bodycheck("run", case, *RUN, "--out", out)
    assert done.returncode == 2
    assert "cannot be written: No space left on device" in done.stderr
    there = journal.read(out / "run.jsonl").records if room >= 3000 else ()
    again = bodycheck("run", case, *RUN, "--out", out)
    assert again.returncode == 0
    done_before = len(there) // 2  # a run counts as done when its truth is there too
    assert (f"resuming the interrupted run in {out}: {done_before} of 1 are done" in again.stderr) == bool(there)
    assert journal.read(out / "run.jsonl").complete
    assert (out / "report.html").exists()
    assert not [path for path in out.rglob("*") if path.suffix in (".part", ".lock")]


def test_a_limit_of_the_size_of_files_is_said(case: Path, tmp_path: Path) -> None:
    """In a process of its own, whose limit is the operating system's."""
    prelude = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))"
    done = bodycheck_process("run", case, *RUN, "--out", tmp_path / "out", prelude=prelude)
    assert (done.returncode, done.stderr.count("Traceback")) == (2, 0)
    assert "cannot be written: File too large" in done.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no device that is always full")
def test_full_standard_output_is_said() -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run(as_process("validate", "projectile"), stdout=full, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (2, "bodycheck: cannot write: [Errno 28] No space left on device\n")


def with_line(text: str) -> Callable[[Path], None]:
    """Put a line with its checksum in the place of the footer of a journal."""

    def damage(path: Path) -> None:
        lines = path.read_text().splitlines(keepends=True)
        path.write_text("".join([*lines[:-1], journals.sealed(text)]))

    return damage


def replaced(old: str, new: str) -> Callable[[Path], None]:
    def damage(path: Path) -> None:
        journals.spoil(path, lambda text: text.replace(old, new, 1))
        assert new in path.read_text()

    return damage


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda path: path.write_bytes(path.read_bytes().replace(b'"steps": 1', b'"steps": 7', 1)), "its checksum is wrong"),
        (with_line('{"record": "run"}'), "the status 'None' of a run"),
        (with_line('{"record": ["run"]}'), "unknown kind"),
        (with_line('{"record": "truth", "case": "../../outside/deep", "timestep": 0.1, "reason": ""}'), "'case'"),
        (with_line('{"record": "stop", "case": "spin", "law": {"friction": NaN}, "stop": null}'), "'law', 'friction'"),
        (replaced('"place": 1', '"place": "1"'), "'place'"),
        (replaced('"engine": "mujoco"', '"engine": "../mujoco"'), "'engine'"),
        (replaced('"timestep": 0.01', '"timestep": -0.01'), "'timestep'"),
        (replaced('"timestep": 0.01', '"timestep": Infinity'), "'timestep'"),
        (replaced('"case": "spin"', '"case": "other"'), "the case 'other'"),
        (replaced('"name": "spin"', '"name": "spun"'), "the case"),
        (replaced('"machine": {', '"machine": {"size": 2, '), "'machine', 'size'"),
        (replaced('"command": [', '"command": [7, '), "'command'"),
        (replaced('"cases": [', '"cases": [3, '), "'cases'"),
    ],
)
def test_a_changed_record_is_seen(damage: Callable[[Path], None], words: str, folder: Path) -> None:
    damage(folder / "run.jsonl")
    done = bodycheck("report", folder)
    assert done.returncode == 2
    assert str(folder) in done.stderr
    assert words in done.stderr


def test_a_trajectory_that_never_ends_is_refused(folder: Path) -> None:
    path = next(folder.glob("trajectories/spin/mujoco-*"))
    path.unlink()
    os.mkfifo(path)
    done = bodycheck("report", folder)
    assert done.returncode == 2
    assert f"{path}: is not a regular file" in done.stderr


def test_a_name_that_is_too_long_for_a_folder_is_said_in_one_short_line(case: Path, tmp_path: Path) -> None:
    done = bodycheck_process("run", case, *RUN, "--out", tmp_path / ("a" * 10_000))
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert done.stderr.endswith("this name is too long for a file or folder\n")
    assert len(done.stderr) < 200
