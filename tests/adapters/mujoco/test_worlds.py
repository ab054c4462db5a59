"""Several scenes in MuJoCo at once: to the last bit as if each were alone, in as many rollouts as memory allows."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import EngineReset, Method, SceneUnsupported
from bodycheck.adapters.mujoco import bodies, worlds
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


def with_other_bodies(scene: Scene, count: int) -> list[Scene]:
    """The scene with several masses, moments of inertia, gravities and angular velocities, the first its own."""
    found = []
    for place, one in enumerate(turned(scene, count)):
        a, b, c = one.body.moments
        body = replace(one.body, mass=one.body.mass * (1 + place / 3), moments=(a, b * (1 + place / 50), c), shape=None)
        found.append(replace(one, body=body, gravity=one.gravity * (1 + place / 7)))
    return found


@pytest.mark.parametrize(
    ("case", "method"),
    [
        ("osrf-boxes-complex", "RK4"),
        ("mujoco-free-body", "Euler:model=translation-and-rotation"),
        ("dumbbell", "implicit"),  # principal axes that are not those of the body
        ("football-drag", "Euler"),  # a force in Python: one copy serves all
        ("football-drag", "Euler:drag=fluid"),  # another density of the fluid for each body
        ("projectile", "Euler"),  # an attitude in the model
    ],
)
@pytest.mark.parametrize("threads", [1, 2])
def test_bodies_that_differ_are_each_as_if_alone(case: str, method: str, threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """To the last bit, with fewer copies of the model than scenes, and where one stride takes several rollouts."""
    monkeypatch.setattr("bodycheck.adapters.mujoco.worlds.threads", lambda: threads)
    monkeypatch.setattr(bodies, "COPIES", 3)
    monkeypatch.setattr(worlds, "MOST_STATES", 200)
    spelled = Method.parse(method, 1e-3)
    scenes = with_other_bodies(load(case).scene, 7)
    together = offers.prepare(MUJOCO, scenes, spelled)
    assert isinstance(together, worlds.Worlds)
    found = np.concatenate([together.advance(strides) for strides in PIECES], axis=1)
    for scene, rows in zip(scenes, found, strict=True):
        alone = MUJOCO.prepare([scene], spelled)
        np.testing.assert_array_equal(rows, np.concatenate([alone.advance(strides)[0] for strides in PIECES]))


def test_a_copy_with_another_body_is_the_model_from_its_xml() -> None:
    """In every array and option of the model, to the last bit."""
    scenes = with_other_bodies(load("osrf-boxes-complex").scene, 3)
    first, *others = (MUJOCO.prepare([scene], Method.parse("RK4", 1e-3)).model for scene in scenes)
    assert first.body_mass[1] != others[0].body_mass[1]
    copies = bodies.with_bodies(first, scenes).at([1, 2])
    names = [name for name in dir(first) if isinstance(getattr(first, name), np.ndarray)]
    assert {"body_inertia", "body_subtreemass", "body_invweight0", "dof_M0", "dof_invweight0"} <= set(names)
    for copy, other in zip(copies, others, strict=True):
        for name in names:
            np.testing.assert_array_equal(getattr(copy, name), getattr(other, name), err_msg=name)
        options = [name for name in dir(other.opt) if isinstance(getattr(other.opt, name), float | np.ndarray)]
        assert "gravity" in options
        for name in options:
            np.testing.assert_array_equal(getattr(copy.opt, name), getattr(other.opt, name), name)


def test_a_body_that_mujoco_refuses_is_refused_among_others() -> None:
    scene = load("intermediate-axis-flip").scene
    impossible = replace(scene, body=replace(scene.body, moments=(0.1, 0.2, 0.4), shape=None))
    with pytest.raises(SceneUnsupported) as alone:
        MUJOCO.prepare([impossible], Method.parse("Euler", 1e-3))
    with pytest.raises(SceneUnsupported) as together:
        MUJOCO.prepare([scene, impossible, scene], Method.parse("Euler", 1e-3))
    assert str(together.value) == str(alone.value)
    assert bodies.may_be_refused([scene, impossible, scene]) == [1]
