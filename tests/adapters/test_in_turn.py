"""Several scenes for any engine: which of them are stepped together, and that one that fails leaves the others alone."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import EngineDiverged, Method, Signals
from bodycheck.reference.scene import Scene

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
