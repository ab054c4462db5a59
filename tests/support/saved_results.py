"""Small results and studies, as commands have written them, for the tests of what is made of them later."""

import fcntl
import os
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bodycheck.commands.command_line import app
from bodycheck.studies import cost
from tests.support import MINIATURES
from tests.support.processes import calls_here

SPIN = """\
format = 1
name = "spin"
title = "A sphere that spins and falls"
tags = ["short"]
[body]
shape = "sphere"
radius = 0.1
mass = 1.0
[initial]
velocity = [1.0, 0.0, 0.0]
angular_velocity = [0.0, 0.0, 5.0]
[scene]
gravity = 9.81
[run]
duration = 1.0
samples = 6
[extremes]
spin = [1.0, 10.0]
[[expect]]
engine = "mujoco"
integrator = "Euler"
timestep = 0.01
position_error = 1e-9
[[expect]]
engine = "mujoco"
integrator = "Euler"
timestep = 0.01
velocity_error = 1e-9
"""

SLIDE = """\
format = 1
name = "slide"
title = "A brick that slides to rest"
[body]
shape = "brick"
semi_axes = [0.1, 0.1, 0.02]
mass = 1.0
[initial]
position = [0.0, 0.0, 0.02]
velocity = [0.5, 0.0, 0.0]
[scene]
gravity = 9.81
[scene.plane]
friction = 0.5
[run]
duration = 0.2
samples = 11
"""

REPORT = ("report.html", "report.md")
TABLES = (
    *("results.csv", "results.csv-metadata.json", "results.parquet", "results.json"),
    *("attribution.csv", "attribution.csv-metadata.json"),
)
METHODS = ("--integrator", "Euler", "--integrator", "RK4", "--integrator", "closed-form")


def shared(factory: pytest.TempPathFactory, name: str) -> Path:
    """A folder that all processes of a run of all tests have in common."""
    base = factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / name
    folder.mkdir(exist_ok=True)
    return folder


def once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """A folder that is filled once in a run of all tests, by the first process that asks for it.

    make: fills the empty folder that it is given.
    """
    folder = shared(factory, name)
    filled = folder.parent / f"{name}.filled"
    with (folder.parent / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not filled.exists():
            make(folder)
            filled.touch()
    return folder


def made(factory: pytest.TempPathFactory, *kinds: str) -> Path:
    """The folder with results of these kinds, which are made once in a run of all tests, by the first process that asks."""
    folder = shared(factory, "saved")
    for kind in kinds:
        with (folder / f"{kind}.lock").open("w") as lock, pytest.MonkeyPatch.context() as patch:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (folder / kind / "report.html").exists():
                patch.syspath_prepend(MINIATURES)
                patch.setattr(cost, "MIN_TIMING_S", cost.MIN_TIMING_S / 10)  # no digit of a cost is looked at
                with calls_here():
                    run(folder) if kind == "run" else study(kind, folder)
    return folder


def call(*arguments: object) -> int:
    """A command's exit code. Raises what `main` would print."""
    code = app(list(map(str, arguments)), exit_on_error=False, print_error=False, result_action="return_value")
    assert isinstance(code, int)
    return code


def run(folder: Path) -> Path:
    """Runs that hold and break what is expected, are unsupported, diverge and crash; the folder of their results."""
    cases = []
    for name, text in (("spin", SPIN), ("slide", SLIDE)):
        cases.append(folder / f"{name}.case.toml")
        cases[-1].write_text(text)
    engines = [word for engine in ("mujoco", "raising", "exploding") for word in ("--engine", engine)]
    steps = ("--timestep", 0.01, "--timestep", 0.005)
    options = ("--jobs", 1, "--out", folder / "run", "--figures", "svg", "--junit", folder / "junit.xml")
    assert call("run", *cases, *engines, *METHODS, *steps, *options) == 1
    return folder / "run"


def move(folder: Path, by: float, along: str = "x", integrator: str = "RK4", timestep: float = 0.01) -> None:
    """Move the body of the spin by some metres in the stored trajectory of a run of MuJoCo."""
    path = folder / "trajectories" / "spin" / f"mujoco-{integrator}-{timestep!r}s.parquet"
    table = pq.read_table(path)
    moved = pa.array(table[along].to_numpy() + by)
    pq.write_table(table.set_column(table.column_names.index(along), along, moved), path)


def study(kind: str, folder: Path) -> Path:
    """The folder of a study: tradeoff, recommend, extremes or ablate."""
    case = folder / "spin.case.toml"
    case.write_text(SPIN)
    options: dict[str, tuple[object, ...]] = {
        "tradeoff": (
            "--engine",
            "mujoco",
            *METHODS[:4],
            *(w for h in (0.1, 0.05, 0.02, 0.01, 0.005) for w in ("--timestep", h)),
        ),
        "recommend": ("--engine", "mujoco", *METHODS[:2], "--quantity", "position", "--error", 1e-2),
        "extremes": ("--engine", "exact", "--engine", "exploding"),
        "ablate": ("--engine", "mujoco", "--integrator", "Euler", "--timestep", 0.01),
    }
    assert call(kind, case, *options[kind], "--jobs", 1, "--out", folder / kind) == 0
    return folder / kind
