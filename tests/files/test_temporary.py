"""Temporary folders: a command that was killed leaves one, the next command removes it, and no other folder is touched."""

import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from bodycheck.files.temporary import PREFIX, temporary_folder
from tests.support import ROOT

#: A process that says which folder it has, and keeps it until it is ended.
USER = (
    "import time\nfrom bodycheck.files.temporary import temporary_folder\n"
    "with temporary_folder() as folder:\n"
    "    (folder / 'results').mkdir()\n    print(folder, flush=True)\n    time.sleep(600)"
)


@pytest.mark.skipif(sys.platform == "win32", reason="on Windows nothing is removed but one's own")
def test_what_a_killed_process_leaves_is_removed_and_what_is_in_use_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    strange, shared, mine = (tmp_path / f"{PREFIX}{name}" for name in ("link", "shared", "file"))
    (tmp_path / "victim").mkdir()
    strange.symlink_to(tmp_path / "victim")
    shared.mkdir(mode=0o755)  # others may look into it: not made by `temporary_folder`
    mine.write_text("no folder")
    command = [sys.executable, "-c", USER]
    environment = {"TMPDIR": str(tmp_path), "PYTHONPATH": str(ROOT)}
    with (
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as living,
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as dead,
    ):
        assert living.stdout is not None
        assert dead.stdout is not None
        used, left = (Path(process.stdout.readline().strip()) for process in (living, dead))
        dead.send_signal(signal.SIGKILL)
        dead.wait()
        assert (left / "results").is_dir()
        with temporary_folder() as own:
            assert own.stat().st_mode & 0o777 == 0o700
            assert {*tmp_path.iterdir()} == {strange, shared, mine, tmp_path / "victim", used, own}
        living.kill()
    with temporary_folder():
        assert not used.exists()
    assert {*tmp_path.iterdir()} == {strange, shared, mine, tmp_path / "victim"}
