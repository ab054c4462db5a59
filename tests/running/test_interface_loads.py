"""What bodies at rest bear on each other is measured after a run, and stored with it."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest
from pydantic import TypeAdapter

from bodycheck.adapters.method import Method
from bodycheck.figures.definition import InterfaceLoad
from bodycheck.reference.contact import ways
from bodycheck.reference.contact.motion import ContactMotion, Interface
from bodycheck.reference.contact.problem import Problem
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.mechanisms.mechanism import WORLD
from bodycheck.reference.scene import Body, Plane, Scene, Sphere, State
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results import records, truth_records
from bodycheck.results.outcome import Completed
from bodycheck.running import simulation

BALL = Scene(Body(1.0, (0.004, 0.004, 0.004), Sphere(0.1)), State((0.0, 0.0, 0.1)), 10.0, Plane(0.5))
T = np.linspace(0, 4, 5)
REST = Trajectory(T, np.tile([0, 0, 0.1], (5, 1)), np.tile([1.0, 0, 0, 0], (5, 1)), np.zeros((5, 3)), np.zeros((5, 3)))
DONE = Completed(REST, 40, 1.0)


class Bearing:
    """An engine that has loads: 11 N, but nothing before 1 s and in steps 20, 30 and 31."""

    def interface_loads(self, scene: object, method: Method, steps: int) -> Mapping[tuple[int, int], Array]:
        loads = np.full(steps, 11.0)
        loads[:10] = loads[[20, 30, 31]] = 0.0
        return {(WORLD, 0): loads, (0, 1): loads}


def resting(problem: Problem, times: Array) -> ContactMotion:
    """A way of a ball that rests."""
    n, zero = len(times), np.zeros((1, len(times), 3), Wide)
    turn = np.tile(np.array([1.0, 0, 0, 0], Wide), (1, n, 1))
    return ContactMotion(zero, zero, turn, zero, {}, (), "rest", "", interfaces=(Interface((WORLD, 0), 10.0),))


def moving(problem: Problem, times: Array) -> ContactMotion:
    """A way of a ball of which nobody says that it rests."""
    found = resting(problem, times)
    return ContactMotion(found.position, found.velocity, found.quaternion, found.spin, {}, (), "", "")


@pytest.fixture(autouse=True)
def _nothing_known() -> Iterator[None]:
    """No motion of another way is known before a test, or left by it."""
    ways.ends.cache_clear()
    yield
    ways.ends.cache_clear()


def test_a_motion_is_computed_once_for_all_methods(monkeypatch: pytest.MonkeyPatch) -> None:
    computed = []

    def counted(problem: Problem, times: Array) -> ContactMotion:
        computed.append(problem)
        return resting(problem, times)

    monkeypatch.setattr(ways, "WAYS", (counted,))
    for method in ("step", "other"):
        assert simulation._interfaces(Bearing(), BALL, BALL, Method(method, 0.1), DONE)
    assert len(computed) == 1


def test_the_mean_and_the_losses_of_contact_after_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ways, "WAYS", (resting,))
    found = simulation._interfaces(Bearing(), BALL, BALL, Method("step", 0.1), DONE)
    assert found == (InterfaceLoad((WORLD, 0), pytest.approx(11.0 * 27 / 30), 2),)


def test_a_run_of_bodies_that_move_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ways, "WAYS", (moving,))
    assert simulation._interfaces(Bearing(), BALL, BALL, Method("step", 0.1), DONE) is None


def test_they_are_stored_and_read_again(tmp_path: Path) -> None:
    told = {"interfaces": [{"bodies": [-1, 0], "load": 10.5, "losses": 3}]}
    kept = json.loads(json.dumps(told))
    assert truth_records.loads(kept) == (InterfaceLoad((WORLD, 0), 10.5, 3),)
    assert truth_records.loads({}) is None
    reader = TypeAdapter(records.BorneRecord)
    assert reader.validate_python(kept["interfaces"][0]).losses == 3


@pytest.mark.parametrize(
    "broken",
    [
        {"bodies": [-2, 0], "load": 1.0, "losses": 0},
        {"bodies": [0], "load": 1.0, "losses": 0},
        {"bodies": [-1, 0], "load": "nan", "losses": 0},
        {"bodies": [-1, 0], "load": 1.0, "losses": -1},
    ],
)
def test_what_strangers_write_there_is_refused(broken: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"bodies|load|losses"):
        records.typed(records.BorneRecord, broken)
