"""Several bodies in one model of Pinocchio: each as if it were alone."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.pinocchio.flights import BODIES, Flights
from bodycheck.reference.scene import Scene

PINOCCHIO = registry.load("pinocchio")

#: Strides of nothing, of one step and of more, in two calls of `advance`.
PIECES = (np.array([0, 3, 0]), np.array([1, 60]))


def different(scene: Scene, count: int) -> list[Scene]:
    """The scene with several masses, moments of inertia, attitudes and velocities."""
    generator = np.random.default_rng(3)
    found = []
    for _ in range(count):
        quaternion = generator.normal(size=4)
        quaternion /= np.linalg.norm(quaternion)
        initial = replace(
            scene.initial,
            position=tuple(generator.normal(size=3).tolist()),
            quaternion=tuple(quaternion.tolist()),
            velocity=tuple((generator.normal(size=3) * np.any(scene.initial.velocity)).tolist()),
            angular_velocity=tuple((3 * generator.normal(size=3) * np.any(scene.initial.angular_velocity)).tolist()),
        )
        # Moments of half to one and a half times one another fulfil the triangle inequality.
        moments = tuple((0.2 * generator.uniform(1.0, 1.9, 3)).tolist())
        body = replace(scene.body, mass=float(generator.uniform(0.5, 2.0)), moments=moments, shape=None)
        found.append(replace(scene, initial=initial, body=body))
    return found


@pytest.mark.parametrize(
    ("case", "method"),
    [
        ("osrf-boxes-complex", "semi-implicit-euler"),
        ("osrf-boxes-complex", "body-twist-euler"),
        ("osrf-boxes-complex", "rk4"),
        ("osrf-boxes-complex", "rk4-naive"),
        ("mujoco-free-body", "semi-implicit-euler"),  # a spherical joint
        ("mujoco-free-body", "rk4"),
        ("projectile", "rk4"),  # a translation joint
        ("football-drag", "semi-implicit-euler"),
        ("football-drag", "rk4"),
        ("dumbbell", "rk4-naive"),  # principal axes that are not those of the body
    ],
)
@pytest.mark.parametrize("count", [2, BODIES + 1])
def test_bodies_in_one_model_are_each_as_if_alone(case: str, method: str, count: int) -> None:
    """To the last bit, but for the products of `rk4`, which are summed in another order: some roundings a step."""
    scenes, spelled = different(load(case).scene, count), Method.parse(method, 1e-3)
    together = offers.prepare(PINOCCHIO, scenes, spelled)
    assert isinstance(together, Flights)
    found = np.concatenate([together.advance(strides) for strides in PIECES], axis=1)
    tolerance = 1e-13 if method == "rk4" else 0.0
    for scene, rows in zip(scenes, found, strict=True):
        alone = PINOCCHIO.prepare([scene], spelled)
        expected = np.concatenate([alone.advance(strides)[0] for strides in PIECES])
        np.testing.assert_allclose(rows, expected, rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize("method", ["semi-implicit-euler", "body-twist-euler", "rk4", "rk4-naive"])
def test_a_body_that_overflows_leaves_the_others_of_its_model_alone(method: str) -> None:
    scenes, spelled = different(load("osrf-boxes-complex").scene, 3), Method.parse(method, 1e-3)
    wild = replace(scenes[1], initial=replace(scenes[1].initial, angular_velocity=(1e200, 2e200, 3e200)))
    with np.errstate(all="ignore"):
        found = PINOCCHIO.prepare([scenes[0], wild, scenes[2]], spelled).advance(np.array([20]))
    assert not np.isfinite(found[1]).all()
    np.testing.assert_array_equal(found[[0, 2]], PINOCCHIO.prepare(scenes, spelled).advance(np.array([20]))[[0, 2]])


def test_what_pinocchio_cannot_have_in_one_model_is_stepped_apart() -> None:
    """Gravity is a property of a model; contacts and additional computations are those of one body."""
    scene, brick = load("osrf-boxes-complex").scene, load("curling-brick").scene
    falling = [scene, replace(scene, gravity=1.0), scene]
    for scenes, method in (
        (falling, "rk4"),
        ([scene, scene], "rk4:model=everything"),
        ([brick, brick], "law-force"),
    ):
        spelled = Method.parse(method, 1e-3)
        found = offers.prepare(PINOCCHIO, scenes, spelled).advance(np.array([0, 20]))
        for one, rows in zip(scenes, found, strict=True):
            # As in the models of one body, up to the products of `rk4`.
            expected = PINOCCHIO.prepare([one], spelled).advance(np.array([0, 20]))[0]
            np.testing.assert_allclose(rows, expected, rtol=1e-13, atol=1e-13)
