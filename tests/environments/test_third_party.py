"""The engine of another package, as docs/howto/write-an-adapter.md shows it, has all that the engines of bodycheck have."""

import json
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support import ROOT
from tests.support.commands import bodycheck
from tests.support.documents import blocks

ENGINE = """
import numpy as np


def multiply(p, q):
    (a, u), (b, v) = (p[0], p[1:]), (q[0], q[1:])
    return np.array([a * b - u @ v, *(a * v + b * u + np.cross(u, v))])


def step(inertia, gravity, state, h):
    x, q, v, w = np.split(state, [3, 7, 10])
    v = v + h * gravity
    w = w + h * np.linalg.solve(inertia, np.cross(inertia @ w, w))
    q = multiply(q, np.array([1.0, *(h / 2 * w)]))
    return np.concatenate([x + h * v, q / np.linalg.norm(q), v, w])
"""


def test_the_package_of_the_guide_is_an_engine(wheel: Callable[..., Path], place: Path, tmp_path: Path) -> None:
    guide = ROOT / "docs" / "howto" / "write-an-adapter.md"
    ((module,), (project,), (commands,)) = (blocks(guide, language) for language in ("python", "toml", "sh"))
    assert len(module.splitlines()) <= 60  # as the guides say
    (tmp_path / "bodycheck_toy.py").write_text(module, "utf-8")
    (tmp_path / "pyproject.toml").write_text(project, "utf-8")
    installed = tmp_path / "installed"
    options = ("--quiet", "--no-index", "--no-deps", "--no-build-isolation", "--target", str(installed))
    subprocess.run([sys.executable, "-m", "pip", "install", *options, str(tmp_path)], check=True)
    wheel("1.0", ENGINE)
    with pytest.MonkeyPatch.context() as patch:
        # It takes the place of the adapter that other tests have for the same engine.
        patch.setattr(sys, "path", [str(installed), *(path for path in sys.path if path != str(place / "plugin"))])
        patch.setenv("PYTHONPATH", str(installed))
        words = [shlex.split(line) for line in commands.splitlines()]
        done = [bodycheck(*line[1:], *(["--json"] if line[1] == "run" else [])) for line in words]
    assert [line.returncode for line in done] == [0, 0, 0], [line.stderr for line in done]
    assert "toy@1.0" in done[0].stdout
    assert "toy: adapter check passed" in done[1].stdout
    (row,) = json.loads(done[2].stdout)
    # Semi-implicit Euler in the body frame is wrong by some degrees after ten seconds, and not by turns.
    assert (row["status"], row["version"]) == ("ok", "1.0")
    assert 1e-4 < row["attitude_error"] < 1.0
