"""Several scenes in MuJoCo at once: to the last bit as if each were alone, in as many rollouts as memory allows."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import EngineReset, Method
from bodycheck.adapters.mujoco import worlds
from bodycheck.reference.scene import Scene

MUJOCO = registry.load("mujoco")

#: Strides of nothing, dense and sparse ones, in two calls of `advance`.
PIECES = (np.array([0, 3, 0, 4, 1]), np.array([60, 400, 1]))


def turned(scene: Scene, count: int) -> list[Scene]:
    """The scene with several angular velocities, the first its own."""
    spins = [tuple(part * (1 + place / 8) for part in scene.initial.angular_velocity) for place in range(count)]
    return [replace(scene, initial=replace(scene.initial, angular_velocity=spin)) for spin in spins]


@pytest.mark.parametrize(
    ("case", "method"),
    [
        ("osrf-boxes-complex", "RK4"),
        ("football-wobble", "Euler"),
        ("football-drag", "RK4"),  # a force in Python
        ("curling-brick", "Euler"),  # a warm start of the solver of contacts
        ("curling-brick", "Euler:model=planar"),
        ("projectile", "Euler"),  # another model for each attitude
    ],
)
@pytest.mark.parametrize("most", [1, 100, worlds.MOST_STATES])
def test_to_the_last_bit_as_if_alone(case: str, method: str, most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worlds, "MOST_STATES", most)
    spelled = Method.parse(method, 1e-3)
    scenes = turned(load(case).scene, 5)
    if case == "projectile":
        turns = [(np.cos(angle), 0.0, 0.0, np.sin(angle)) for angle in np.arange(5) / 8]
        scenes = [replace(one, initial=replace(one.initial, quaternion=turn)) for one, turn in zip(scenes, turns, strict=True)]
    together = MUJOCO.prepare(scenes, spelled)
    found = np.concatenate([together.advance(strides) for strides in PIECES], axis=1)
    for scene, rows in zip(scenes, found, strict=True):
        alone = MUJOCO.prepare([scene], spelled)
        np.testing.assert_array_equal(rows, np.concatenate([alone.advance(strides)[0] for strides in PIECES]))
    assert together.signals == {}


@pytest.mark.parametrize("most", [100, worlds.MOST_STATES])
def test_a_reset_ends_one_scene_alone(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two of four scenes reset after some hundred steps, with the text, the instant and the states of each alone."""
    monkeypatch.setattr(worlds, "MOST_STATES", most)
    spelled, strides = Method.parse("Euler", 2e-3), np.full(100, 25)
    scene = load("intermediate-axis-flip").scene
    scenes = [replace(scene, initial=replace(scene.initial, angular_velocity=(0.0, 0.1, w))) for w in (10.0, 300.0, 5.0, 310.0)]
    together = MUJOCO.prepare(scenes, spelled)
    found = np.concatenate([together.advance(part) for part in (strides[:3], strides[3:])], axis=1)
    assert set(together.signals) == {1, 3}
    for place, (one, rows) in enumerate(zip(scenes, found, strict=True)):
        if place not in together.signals:
            np.testing.assert_array_equal(rows, MUJOCO.prepare([one], spelled).advance(strides)[0])
            continue
        with pytest.raises(EngineReset) as signal:
            MUJOCO.prepare([one], spelled).advance(strides)
        assert together.signals[place] == str(signal.value)
        sound = signal.value.states[0, :-1]
        assert 3 < len(sound) < len(strides)
        np.testing.assert_array_equal(rows[: len(sound)], sound)
        assert np.isnan(rows[len(sound) :]).all()
