"""The cache of environments: nothing is run that another user could have put there."""

import os
import stat
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from bodycheck.adapters.installation import Installation
from bodycheck.environments import environments, installation, privacy, user_cache
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.environments.making import Release

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="folders have no such owners there")

#: A user that is neither the administrator nor the one who runs the tests.
STRANGER = 54321

RELEASE = Release("mujoco", Installation("mujoco"), "1.0")


def of_a_stranger(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give a folder to somebody else, or, where only the administrator may, be somebody else to whom it does not belong."""
    if os.getuid() == 0:
        os.chown(folder, STRANGER, -1)
    else:
        monkeypatch.setattr(os, "getuid", lambda: STRANGER)


def for_all(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder.chmod(0o777)


def for_a_group(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder.chmod(0o770)
    monkeypatch.setattr(privacy, "_is_own_group", lambda number: False)


@pytest.fixture
def planted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Environment, Path]:
    """An environment as somebody may plant it, and the file that its interpreter writes."""
    monkeypatch.setenv(user_cache.VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setattr(installation, "versions", lambda distribution: ["1.0"])
    folder = environments._folder(RELEASE)
    python, written = installation.interpreter(folder), tmp_path / "written"
    privacy.make(python.parent)
    python.write_text(f"#!/bin/sh\necho >{written}\necho 1.0\n")
    python.chmod(0o755)
    (folder / environments.MARKER).write_text("{}")
    return Environment("mujoco", "1.0", python), written


@pytest.mark.parametrize("opened", [of_a_stranger, for_all, for_a_group])
@pytest.mark.parametrize("levels", [0, 1, 2, 5])
def test_what_others_can_change_is_not_run(
    planted: tuple[Environment, Path], levels: int, opened: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    environment, written = planted
    place = environment.python.parents[levels]
    opened(place, monkeypatch)
    with pytest.raises(Unobtainable, match="another user can change"):
        environments.obtain("mujoco", "1.0")
    with pytest.raises(Unobtainable, match="BODYCHECK_CACHE"):
        environments.run(environment, "json.tool", (), None, 60.0)
    assert not written.exists()
    assert place.exists()


def test_what_is_ours_is_run_even_in_a_folder_that_all_share(planted: tuple[Environment, Path], tmp_path: Path) -> None:
    """As in /tmp, whose sticky bit keeps others from replacing it."""
    environment, written = planted
    tmp_path.chmod(0o1777)
    assert environments.run(environment, "json.tool", (), None, 60.0).returncode == 0
    assert written.exists()


def test_a_link_is_as_private_as_what_it_leads_to(planted: tuple[Environment, Path], tmp_path: Path) -> None:
    environment, _ = planted
    (tmp_path / "link").symlink_to(tmp_path / "cache")
    through = tmp_path / "link" / environment.python.relative_to(tmp_path / "cache")
    assert privacy.open_to_others(through) is None
    (tmp_path / "cache").chmod(0o777)
    assert privacy.open_to_others(through) == tmp_path / "cache"


def test_folders_of_the_cache_are_made_for_this_user_alone(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        privacy.make(tmp_path / "a" / "b")
    finally:
        os.umask(before)
    assert [stat.S_IMODE(path.stat().st_mode) for path in (tmp_path / "a", tmp_path / "a" / "b")] == [0o700, 0o700]


def test_strange_folders_in_the_cache_are_passed_over(planted: tuple[Environment, Path]) -> None:
    environment, _ = planted
    folder = environment.python.parents[1]
    for name in ("no version", "v1.0", "01", "None", "2.0.dev", "..."):
        strange = folder.parents[1] / name / folder.name
        strange.mkdir(parents=True)
        (strange / environments.MARKER).write_text("{}")
    (folder.parents[1] / "3.0").write_text("a file")
    assert environments.cached("mujoco") == ("1.0",)
    assert environments.kept("mujoco") == {"1.0": environment}
    with pytest.raises(Unobtainable, match=r"3\.0.*: cannot be used as a folder"):
        environments.obtain("mujoco", "3.0")
