"""One run in this process: what is bad input, and that nothing which an engine raises leaves it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from bodycheck import load, simulate
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine, Integrator, Method
from bodycheck.errors import BadInput
from bodycheck.reference.scene import Plane, Scene
from bodycheck.running.outcome import Crashed

SLIDE = replace(load("sliding-brick"), samples=3, expectations=())
EVERYTHING = frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"})
ENGINE = Engine("faulty", "faulty", "1.0", (Integrator("step"),), EVERYTHING)


@dataclass(frozen=True)
class Faulty:
    """An adapter that fails where it is told to."""

    where: str
    error: BaseException
    engine: Engine = ENGINE

    def _do(self, where: str) -> None:
        if where == self.where:
            raise self.error

    def contact_law(self, scene: Scene, method: Method) -> Plane | None:
        self._do("contact_law")
        return None

    def contact_load(self, scene: Scene, method: Method, steps: int) -> None:
        self._do("contact_load")

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Any:
        self._do("prepare")
        return self

    def advance(self, strides: np.ndarray) -> np.ndarray:
        self._do("advance")
        initial = SLIDE.scene.initial
        row = [*initial.position, *initial.quaternion, *initial.velocity, *initial.angular_velocity]
        rows = np.tile(row, (len(strides), 1))
        rows[:, 0] += np.arange(len(strides))
        return rows[None, :, None, :]


@pytest.mark.parametrize("where", ["contact_law", "prepare", "advance", "contact_load"])
@pytest.mark.parametrize("error", [RuntimeError("no"), SystemExit(3), MemoryError(), KeyError("x")])
def test_nothing_that_an_engine_raises_leaves_simulate(
    where: str, error: BaseException, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(registry, "load", lambda name: Faulty(where, error))
    outcome = simulate(SLIDE, "faulty", "step", 0.1).outcome
    assert isinstance(outcome, Crashed)
    assert outcome.status == "crashed"


def test_an_adapter_that_fails_nowhere_completes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "load", lambda name: Faulty("nowhere", RuntimeError()))
    assert simulate(SLIDE, "faulty", "step", 0.1).outcome.status == "ok"


@pytest.mark.parametrize(
    ("spelling", "words"),
    [
        ("Eulr", "mujoco has no integrator 'Eulr'.*did you mean 'Euler'"),
        ("Euler:cone=elliptc", "read 'elliptc'; allowed: elliptic or pyramidal; did you mean 'elliptic'"),
        ("Euler:con=elliptic", "has no option 'con'; allowed: .*did you mean 'cone'"),
        ("Euler-planar", "is now spelled 'Euler:model=planar'"),
    ],
)
def test_a_misspelled_method_is_bad_input(spelling: str, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        simulate(SLIDE, "mujoco", spelling)


def test_an_adapter_without_its_record_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    class Point:
        name = "halfway"

        def load(self) -> object:
            return object()

    monkeypatch.setattr(registry, "entry_points", lambda **_: [Point()])
    with pytest.raises(registry.EngineMissing, match="halfway has no adapter: object lacks `engine` or `prepare`"):
        registry.load("halfway")
