"""The tutorial is followed: every command of it runs, in order, and prints what the page shows."""

import os
import shutil
import sys
from pathlib import Path

import pytest

from tests.support import ROOT
from tests.support.processes import calls_here
from tests.support.walkthrough import agrees, failures, follow_afresh, follow_here, steps

PAGE = ROOT / "docs" / "start" / "tutorial.md"


def test_the_tutorial_prints_what_it_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All but what needs a network, with bodycheck as it is here. Its engines are those of a new user."""
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    (tmp_path / "bodycheck").symlink_to(ROOT)
    (tmp_path / "tutorial").mkdir()
    with calls_here():
        done = follow_here(PAGE, tmp_path / "tutorial")
    assert len(done) > 20
    assert not failures(done), "\n\n".join(failures(done))


@pytest.mark.slow
def test_the_tutorial_can_be_followed_from_a_checkout_on(tmp_path: Path) -> None:
    """Word by word, in an environment that the page makes, by a Python that has nothing of the packages of this one."""
    left_out = shutil.ignore_patterns(".git", ".venv*", "build", "dist", "results", "*.egg-info", "__pycache__", ".*_cache")
    shutil.copytree(ROOT, tmp_path / "bodycheck", symlinks=True, ignore=left_out)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python3").symlink_to(Path(sys.base_prefix) / "bin" / "python3")
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "GITHUB_", "VIRTUAL_ENV"))
    }
    environment |= {"PATH": f"{tmp_path / 'bin'}:/usr/bin:/bin", "BODYCHECK_CACHE": str(tmp_path / "cache")}
    done = follow_afresh(steps(PAGE), tmp_path / "bodycheck", environment)
    assert not failures(done), "\n\n".join(failures(done))
    assert sum(step.downloads for step in steps(PAGE) if hasattr(step, "downloads")) == 6
    assert (tmp_path / "environment" / "bin" / "bodycheck").exists()


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("an error of 2.1 rad.", "an error of\n  2.102 rad.\n", True),
        ("an error of 2.1 rad.", "an error of 2.2 rad.", False),
        ("an error of 2.1 rad.", "an error of 2.1 rad. And more", False),
        ("error …\nthe end", "error 1\nerror 2\nthe end", True),
        ("error …\nthe end", "error 1\nthe end of it", False),
        ("… the end", "not the end", True),
        ("mujoco 4.0.0", "mujoco 4.0.1", False),
        ("at most 3.6e-15 rad", "at most 9.1e-16 rad", True),
        ("===== 1 passed in …", "======== 1 passed in 2.3s =====", True),
        ("1 item …", "0 item\rcollected 1 item", False),
        ("collected 1 item", "collecting ...\rcollected 1 item", True),
    ],
)
def test_what_is_printed_is_compared_with_what_is_shown(shown: str, printed: str, same: bool) -> None:
    assert agrees(shown, printed) is same
