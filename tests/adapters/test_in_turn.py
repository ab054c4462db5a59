"""Several scenes for any engine: which of them are stepped together, and that one that fails leaves the others alone."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported, Signals, Varied
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Plane, Scene, State

EULER, STRIDES = Method.parse("euler", 0.01), np.array([0, 5, 20])

FLYING = load("free-brick").scene


@pytest.fixture
def batching(miniatures: Path) -> Any:
    """A miniature engine that steps many scenes at once, and counts those that it is given."""
    adapter: Any = registry.load("batching")
    adapter.asked.clear()
    return adapter


def moving(speed: float, scene: Scene = FLYING) -> Scene:
    return replace(scene, initial=replace(scene.initial, velocity=(speed, 0.0, 0.0)))


def test_scenes_that_differ_in_their_initial_states_alone_are_stepped_together(batching: Any) -> None:
    heavier = replace(FLYING, body=replace(FLYING.body, mass=2 * FLYING.body.mass))
    still = replace(FLYING, initial=replace(FLYING.initial, angular_velocity=(0.0, 0.0, 0.0)))
    scenes = [moving(1.0), moving(1.0, heavier), moving(2.0), moving(1.0, still), moving(2.0, heavier), moving(3.0)]
    together = offers.prepare(batching, scenes, EULER).advance(STRIDES)
    assert batching.asked == [3, 2, 1]
    for scene, rows in zip(scenes, together, strict=True):
        np.testing.assert_array_equal(rows, batching.prepare([scene], EULER).advance(STRIDES)[0])


@pytest.mark.parametrize(
    ("varies", "groups"),
    [((), [2, 1, 1, 1, 1]), (("body",), [3, 1, 1, 1]), (("gravity",), [3, 1, 1, 1]), (("body", "gravity"), [4, 1, 1])],
)
def test_scenes_that_differ_in_what_an_engine_allows_are_stepped_together(
    batching: Any, varies: tuple[Varied, ...], groups: list[int]
) -> None:
    """But not a scene with gravity and one without, or one that turns and one that does not: their models are others."""
    allowing = replace(batching, varies=frozenset(varies))
    heavier = replace(FLYING, body=replace(FLYING.body, mass=2.0, moments=(0.3, 0.4, 0.5)))
    turning_alone = replace(FLYING, initial=replace(FLYING.initial, velocity=(0.0, 0.0, 0.0)), gravity=0.0)
    still = replace(FLYING, initial=replace(FLYING.initial, angular_velocity=(0.0, 0.0, 0.0)))
    scenes = [moving(1.0), moving(2.0, heavier), moving(3.0, replace(FLYING, gravity=2.0)), moving(4.0), turning_alone, still]
    together = offers.prepare(allowing, scenes, EULER).advance(STRIDES)
    assert sorted(batching.asked, reverse=True) == groups
    for scene, rows in zip(scenes, together, strict=True):
        np.testing.assert_array_equal(rows, batching.prepare([scene], EULER).advance(STRIDES)[0])


def test_scenes_are_grouped_by_what_they_require(batching: Any) -> None:
    """By `requirements` itself, which is slower: of flights at rest, moving, turning, falling, and against drag at a plane."""
    modelled = batching.engine.models | {"contact", "friction", "rolling", "drag"}
    adapter = SimpleNamespace(engine=replace(batching.engine, models=modelled), prepare=batching.prepare)
    states = [
        State((0.0, 0.0, height), velocity=velocity, angular_velocity=spin)
        for height in (0.1, 0.3)
        for velocity in ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
        for spin in ((0.0, 0.0, 0.0), (0.0, 0.0, 2.0))
    ]
    scenes = [
        Scene(FLYING.body, state, gravity, plane, drag)
        for state in states
        for gravity in (0.0, 9.81)
        for plane in (None, Plane(0.5))
        for drag in (0.0, 0.1)
        if plane is None or drag  # without drag they touch, and are not stepped together
    ]
    offers.prepare(adapter, scenes, EULER)
    assert len(batching.asked) == len({(replace(one, initial=State()), requirements(one)) for one in scenes})


@pytest.mark.parametrize("apart", [False, True])
def test_a_scene_that_is_given_up_leaves_the_others_alone(batching: Any, apart: bool) -> None:
    """Whether it is stepped with others or by itself; later calls of `advance` go on without it."""
    fast = replace(moving(1e6), gravity=1e5) if apart else moving(1e6)
    scenes = [moving(1.0), fast, moving(2.0)]
    simulation = offers.prepare(batching, scenes, EULER)
    assert batching.asked == ([2, 1] if apart else [3])
    found = np.concatenate([simulation.advance(STRIDES[:2]), simulation.advance(STRIDES[2:])], axis=1)
    assert isinstance(simulation, Signals)
    assert simulation.signals == {1: "it is too fast"}
    with pytest.raises(EngineDiverged, match="it is too fast"):
        batching.prepare([fast], EULER).advance(STRIDES)
    assert np.isfinite(found[1, 0]).all()
    assert np.isnan(found[1, 1:]).all()
    for place in (0, 2):
        np.testing.assert_array_equal(found[place], batching.prepare([scenes[place]], EULER).advance(STRIDES)[0])


def test_touching_bodies_are_not_stepped_together_with_others(batching: Any) -> None:
    on_edge = replace(FLYING, plane=Plane(0.5))
    with pytest.raises(SceneUnsupported, match="simulated one by one"):
        offers.prepare(batching, [FLYING, on_edge], EULER)


def test_a_scene_that_the_record_does_not_have_never_gets_to_the_adapter(batching: Any) -> None:
    with pytest.raises(SceneUnsupported, match="batching does not model drag"):
        offers.prepare(batching, [replace(FLYING, drag=0.1)], EULER)
    assert batching.asked == []
