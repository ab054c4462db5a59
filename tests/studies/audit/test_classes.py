"""Engines are run on the scenes that tell methods apart, and their classes are named by schemes."""

from pathlib import Path

import pytest

from bodycheck.studies.audit.classes import measure, tasks
from bodycheck.studies.audit.rows import CLASSES, Classes, ClassRow
from tests.support.campaigns import records

METHODS = ("Euler", "RK4", "semi-implicit-euler", "rk4", "closed-form")


@pytest.fixture
def measured(miniatures: Path, calls_here: None) -> Classes:
    """MuJoCo and Pinocchio beside miniature engines, one of which keeps its angular velocity and one of which fails."""
    engines, done = records("mujoco", "pinocchio", "exact", "raising"), []
    found = measure(engines, 1, METHODS, done.append)
    assert len(done) == len(tasks(engines, METHODS))
    return found


def test_methods_of_different_engines_are_one_class_named_by_its_scheme(measured: Classes) -> None:
    flight = {(row.engine, row.integrator): row for row in measured.rows if row.kind == "flight"}
    euler, same = flight["mujoco", "Euler"], flight["pinocchio", "semi-implicit-euler"]
    assert euler.name == euler.scheme == same.name == "semi-implicit Euler"
    assert 0 < euler.distance == same.distance < 1e-13  # eight steps of rounding, by turns of some radians
    assert len({flight[method].name for method in flight if method != ("pinocchio", "semi-implicit-euler")}) == len(flight) - 1
    assert [row.kind for row in measured.rows] == sorted(
        (row.kind for row in measured.rows), key=["flight", "drag", "plane"].index
    )


def test_a_class_whose_scheme_is_not_known_is_numbered(measured: Classes) -> None:
    (own,) = [row for row in measured.rows if row.engine == "exact"]
    name = "no gyroscopic torque in rotation"  # its fall is the exact one
    assert (own.kind, own.name, own.scheme, own.distance) == ("flight", name, name, 0.0)
    assert len({row.name for row in measured.rows if row.kind == "plane"}) > 1
    assert all(row.name.startswith("not identified ") for row in measured.rows if row.kind == "plane")


def test_a_method_that_failed_is_in_no_class(measured: Classes) -> None:
    assert "raising" not in {row.engine for row in measured.rows}
    reasons = {one.kind: one.reason for one in measured.unclassed if one.engine == "raising"}
    assert reasons["flight"] == "RuntimeError: the miniature engine gives up"
    assert reasons["drag"] == "raising 1.0 does not model drag"


def test_the_row_has_the_columns_of_the_table() -> None:
    row = ClassRow("flight", "not identified 1", "", "mujoco", "4.0.0", "Euler", 0.0, 0.03125)
    (record,) = CLASSES.records([row])
    assert list(record) == ["kind", "class", "scheme", "engine", "version", "integrator", "distance", "scene_timestep"]
    assert record["class"] == "not identified 1"
