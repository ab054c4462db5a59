"""The smallest models of the engines: each agrees with the full one."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck import compare, load, simulate, truth
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.errors import BadInput
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.scene import Body, Plane, Scene, State
from bodycheck.reference.trajectory import Array
from tests.support.cases import shortened
from tests.support.flat_slides import PLANES, flat

MUJOCO, PINOCCHIO = registry.load("mujoco"), registry.load("pinocchio")


#: A body that is symmetric about one axis, thrown so that it tumbles.
TOP = Scene(
    Body(1.5, (0.2, 0.2, 0.25)),
    State((1.0, 2.0, 3.0), (0.5, 0.5, -0.5, 0.5), (3.0, -4.0, 5.0), (1.0, -2.0, 3.0)),
    gravity=9.81,
)


def last(adapter: Any, scene: Scene, method: str, timestep: float = 1e-3, steps: int = 300) -> Array:
    """The states (3, 13) at the start, after a step and at the end."""
    return np.asarray(adapter.prepare([scene], Method.parse(method, timestep)).advance(np.array([0, 1, steps - 1])))[0, :, 0]


def sizes(adapter: Any, scene: Scene, method: str) -> tuple[int, int]:
    """Coordinates and velocities of an engine's model."""
    simulation = adapter.prepare([scene], Method.parse(method, 1e-3))
    if adapter is MUJOCO:
        return simulation.model.nq, simulation.model.nv
    model = simulation.parts[0].model if hasattr(simulation, "parts") else None
    if model is not None:
        return model.nq, model.nv
    q, v = simulation.state
    return len(q), len(v)


@pytest.mark.parametrize(
    ("case", "mujoco", "pinocchio"),
    [
        ("projectile", (3, 3), (3, 3)),
        ("free-brick", (7, 6), (7, 6)),
        ("mujoco-free-body", (7, 6), (4, 3)),
    ],
)
def test_engines_build_the_smallest_model(case: str, mujoco: tuple[int, int], pinocchio: tuple[int, int]) -> None:
    scene = load(case).scene
    for integrator in offers.offered(MUJOCO.engine, scene):
        assert sizes(MUJOCO, scene, integrator) == mujoco
        model = MUJOCO.prepare([scene], Method.parse(integrator, 1e-3)).model
        assert (model.ngeom, model.nsensor) == (0, 0)
    for integrator in offers.offered(PINOCCHIO.engine, scene):
        assert sizes(PINOCCHIO, scene, integrator) == pinocchio


def test_on_a_plane_three_coordinates_are_a_method_of_their_own() -> None:
    scene = load("sliding-brick").scene
    assert sizes(MUJOCO, scene, "Euler:model=planar") == (3, 3)
    assert sizes(MUJOCO, scene, "Euler") == (7, 6)
    assert sizes(PINOCCHIO, scene, "law-force") == (3, 3)
    assert sizes(PINOCCHIO, scene, "law-force:model=planar-joint") == (4, 3)
    for adapter, method in (
        (MUJOCO, "Euler:model=planar"),
        (PINOCCHIO, "law-force"),
        (PINOCCHIO, "law-force:model=planar-joint"),
    ):
        assert method in offers.offered(adapter.engine, scene)
        assert adapter.contact_law(scene, Method.parse(method, 1e-3)) == scene.plane
        assert adapter is PINOCCHIO or adapter.contact_load(scene, Method.parse(method, 1e-3), 10) is None
        own = offers.integrator_of(adapter.engine, Method.parse(method, 1e-3))
        assert own is not None
        assert own.order == 1


def test_everything_as_shipped_is_in_the_largest_model_of_mujoco() -> None:
    scene = load("free-brick").scene
    model = MUJOCO.prepare([scene], Method.parse("Euler:model=everything", 1e-3)).model
    assert (model.ngeom, model.nsensor, model.opt.disableflags) == (2, 6, 0)
    assert model.opt.enableflags


FLIGHTS = ["projectile", "free-brick", "mujoco-free-body", "football-wobble", "football-drag", "osrf-boxes-complex"]

#: Models on which an integrator is another scheme: on the body twist, and on MuJoCo's ball joint.
OTHER_SCHEMES = {
    ("pinocchio", "semi-implicit-euler"): {"six-coordinates", "far-geometry", "everything"},
    ("mujoco", "implicitfast"): {"rotation", "translation-and-rotation"},
    ("mujoco", "discrete"): {"rotation", "translation-and-rotation"},
}


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
@pytest.mark.parametrize("case", FLIGHTS)
def test_the_models_of_a_flight_are_one_physics(engine: str, case: str) -> None:
    adapter, scene = registry.load(engine), load(case).scene
    for integrator in offers.offered(adapter.engine, scene):
        usual = last(adapter, scene, integrator)
        turns, moves = any(scene.initial.angular_velocity), any(scene.initial.velocity)
        for name, model in adapter.models(scene, integrator).items():
            seen = last(adapter, scene, model.method)
            others = OTHER_SCHEMES.get((engine, integrator.removesuffix(":drag=fluid")), set())
            differs = turns and name in others and (engine == "mujoco" or moves)
            # 300 steps round a state of up to 20 m and rad/s.
            assert bool(np.abs(seen - usual).max() > 1e-9) is differs, (integrator, model)
            np.testing.assert_allclose(seen[0], usual[0], rtol=0, atol=1e-14)


def test_on_a_ball_joint_implicitfast_of_mujoco_is_semi_implicit_euler() -> None:
    """Which is why a body that turns in its place has a free joint all the same."""
    scene = load("mujoco-free-body").scene
    euler = last(MUJOCO, scene, "Euler")
    for integrator in ("implicitfast", "discrete"):
        np.testing.assert_allclose(last(MUJOCO, scene, f"{integrator}:model=rotation"), euler, rtol=0, atol=1e-13)
        assert np.abs(last(MUJOCO, scene, integrator) - euler).max() > 1e-4


@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize(("velocity", "spin"), [((2.0, 1.0), 0.0), ((0.0, 0.0), -7.0), ((2.0, 1.0), 7.0)])
def test_planar_and_free_joints_agree_to_rounding_in_both_engines(
    plane: Plane, velocity: tuple[float, float], spin: float
) -> None:
    scene = flat(velocity, spin, plane)
    planar = last(MUJOCO, scene, "Euler:model=planar", steps=600)
    for adapter, method in (
        (MUJOCO, "Euler:model=planar"),
        (MUJOCO, "Euler:model=six-coordinates"),
        (MUJOCO, "Euler:model=far-geometry"),
        (PINOCCHIO, "law-force"),
        (PINOCCHIO, "law-force:model=translation-and-rotation"),
    ):
        seen = last(adapter, scene, method, steps=600)
        assert geodesic_angle(seen[:, 3:7], planar[:, 3:7]).max() < 1e-12
        # 600 steps of rounding; the law of friction near the stop multiplies it some ten times.
        np.testing.assert_allclose(np.delete(seen, slice(3, 7), axis=1), np.delete(planar, slice(3, 7), axis=1), atol=1e-11)


@pytest.mark.parametrize(
    ("engine", "integrator"), [("mujoco", "Euler:model=planar"), ("pinocchio", "law-force:model=planar-joint")]
)
@pytest.mark.parametrize(
    "name", ["sliding-brick", "spinning-brick", "curling-brick", "curling-disk", "curling-brick-decoupled"]
)
def test_planar_methods_converge_to_the_truth_with_order_1(engine: str, integrator: str, name: str) -> None:
    case = load(name)
    exact = truth(case)
    errors = [
        max(seen["position_error"], 0.1 * seen["attitude_error"])
        for seen in (compare(exact, simulate(case, engine, integrator, h)).maxima() for h in (2e-3, 1e-3, 5e-4))
    ]
    # The next term of the error is of relative size h times a rate of 20 rad/s, and the stop is found to a step.
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 1, atol=0.15)


def test_at_rest_and_without_friction_nothing_is_braked() -> None:
    resting = last(MUJOCO, flat((0.0, 0.0), 0.0, PLANES[0]), "Euler:model=planar")
    np.testing.assert_array_equal(resting[-1, 7:], 0)
    sliding = last(MUJOCO, flat((2.0, 1.0), 3.0, Plane(0.0)), "Euler:model=planar")
    # 300 roundings of 3 rad/s.
    np.testing.assert_allclose(sliding[-1, [7, 8, 12]], [2.0, 1.0, 3.0], rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    ("engine", "case", "method", "words"),
    [
        ("mujoco", "free-brick", "Euler:model=planar", "no model 'planar' .* there are: six-coordinates, far-geometry"),
        ("mujoco", "sliding-brick", "Euler:model=planar,cone=elliptic", "which has no contact"),
        ("pinocchio", "projectile", "rk4:model=translation-and-rotation", "no model"),
        ("pinocchio", "curling-disk", "admm", "corners"),
    ],
)
def test_models_that_there_are_not_are_refused(engine: str, case: str, method: str, words: str) -> None:
    with pytest.raises(SceneUnsupported, match=words):
        registry.load(engine).prepare([load(case).scene], Method.parse(method, 1e-3))


def test_options_and_a_model_combine() -> None:
    scene = load("sliding-brick").scene
    whole = last(MUJOCO, scene, "Euler:cone=elliptic,model=everything")
    np.testing.assert_array_equal(last(MUJOCO, scene, "Euler:model=contact,cone=elliptic"), whole)
    with pytest.raises(BadInput, match=r"admm:model=planar: read 'planar'; allowed: everything"):
        offers.check(PINOCCHIO.engine, Method.parse("admm:model=planar", 1e-3))


def test_a_body_without_a_shape_has_no_far_geometry() -> None:
    for adapter in (MUJOCO, PINOCCHIO):
        for integrator in offers.offered(adapter.engine, TOP):
            assert "far-geometry" not in adapter.models(TOP, integrator)
            last(adapter, TOP, f"{integrator}:model=everything")


def test_a_turned_body_in_its_own_frame_moves_the_same_on_every_model() -> None:
    """Slides leave the frame of the body to its inertia: MuJoCo's fluid tells whether it is turned the right way."""
    case = shortened(load("football-drag"), 1.0, 11)
    axes = tuple(normalise(np.array([0.9, 0.1, -0.3, 0.2])).tolist())
    start = replace(case.scene.initial, angular_velocity=(0.0, 0.0, 0.0))
    body = replace(case.scene.body, axes=axes, moments=(0.001, 0.002, 0.0025))
    scene = replace(case.scene, body=body, initial=start)
    whole: Callable[[str], Array] = lambda model: last(MUJOCO, scene, f"Euler:drag=fluid,model={model}")  # noqa: E731
    np.testing.assert_allclose(whole("translation")[:, 7:10], whole("six-coordinates")[:, 7:10], rtol=0, atol=1e-12)
