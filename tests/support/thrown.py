"""Ensembles of a brick and of a ball, with the engines that fly them, and what their folders have in the end."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.dataset as ds

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine
from bodycheck.casefile.case import Case, parse
from bodycheck.running.members.chunk_files import MEASURED
from bodycheck.running.members.executors import Executor
from bodycheck.running.members.executors.own import Own
from bodycheck.studies.ensemble import header, study
from bodycheck.studies.ensemble.drawing import members

#: A brick that is thrown with any spin, for a tenth of a second.
BRICK = """
format = 1
name = "thrown"
title = "A brick that is thrown with any spin"
[body]
shape = "brick"
semi_axes = [0.1, 0.2, 0.3]
mass = 1.0
[initial]
angular_velocity = [0.0, 0.0, 1.0]
[scene]
gravity = 9.81
[run]
duration = 0.1
samples = 3
[ensemble]
members = 3500
seed = 1
[[ensemble.vary]]
key = "initial.angular_velocity"
distribution = "normal"
mean = [0.0, 0.0, 0.0]
standard_deviation = [3.0, 3.0, 3.0]
[[ensemble.vary]]
key = "initial.velocity"
distribution = "uniform"
low = -1.0
high = 1.0
"""

#: A ball that is thrown likewise, which the miniature engine `batching` flies.
BALL = BRICK.replace('"brick"\nsemi_axes = [0.1, 0.2, 0.3]', '"sphere"\nradius = 0.1')

#: An engine of balls that ends its process if any of its scenes spins faster than `{limit}` rad/s about the first axis.
MORTAL = """
import os
from batching import Batching
_base = Batching("mortal")
engine = _base.engine

def prepare(scenes, method):
    if any(scene.initial.angular_velocity[0] > {limit} for scene in scenes):
        os._exit(3)
    return _base.prepare(scenes, method)
"""


def brick(**more: Any) -> Case:
    """The case of the brick, with other numbers in the place of some."""
    text = BRICK
    for name, value in more.items():
        lines = [f"{name} = {value}" if line.startswith(f"{name} = ") else line for line in text.splitlines()]
        text = "\n".join(lines)
    return parse(text, "thrown")


def run(
    case: Case,
    folder: Path,
    executor: Executor | None = None,
    engines: Sequence[str] = ("mujoco",),
    integrators: Sequence[str] = ("Euler", "RK4"),
    timesteps: Sequence[float] = (0.01,),
    records: Mapping[str, Engine] | None = None,
    progress: Callable[..., None] = lambda done, count=1: None,
    **options: Any,
) -> Path:
    """An ensemble of a case, by default on this machine with two threads."""
    known = records or {name: registry.load(name).engine for name in engines}
    source = members.drawn(case)
    return study.run(case, source, known, integrators, timesteps, folder, executor or Own(2), progress, **options)


def tables(folder: Path) -> dict[str, pa.Table]:
    """The tables of an ensemble by kind, in the order of their files, without measured times."""
    found = {}
    head = header.read(folder)
    for kind in ("runs", "members", "truths", "trajectories"):
        places = (
            [folder / kind / share["engine"] for share in head["shares"]]
            if kind in ("runs", "trajectories")
            else [folder / kind]
        )
        parts = [ds.dataset(sorted(place.rglob("*.parquet")), format="parquet").to_table() for place in places]
        whole = pa.concat_tables(parts)
        found[kind] = whole.drop_columns([name for name in MEASURED if name in whole.column_names])
    return found


def check_same(one: Path, other: Path) -> None:
    """That two folders have the same rows in the same order, to the last bit, measured times apart."""
    ours, theirs = tables(one), tables(other)
    for kind, table in ours.items():
        assert table.schema == theirs[kind].schema, kind
        assert table.equals(theirs[kind]), kind
    assert header.read(one)["complete"]
    assert not (one / "chunks").exists()


def check_whole(folder: Path, case: Case, methods: int) -> None:
    """That there is exactly one run for each member and method, in their order."""
    size = members.drawn(case).size
    runs = tables(folder)["runs"]
    assert runs["member"].to_pylist() == [member for member in range(size) for _ in range(methods)]
    assert tables(folder)["members"]["member"].to_pylist() == list(range(size))
