"""Faults planted in what the truth stands on: its bounds grow to what the fault does."""

import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.case import parse
from bodycheck.reference.exact import inertia, rotations
from bodycheck.reference.exact import start as exact_start
from bodycheck.reference.flight import closed_form, torque_free
from bodycheck.reference.independent import border
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truth import truth
from tests.support.cases import a_case

Patch = pytest.MonkeyPatch

TIMES = np.linspace(0, 3, 61)

BRICK = {"shape": "brick", "mass": 2.0, "semi_axes": [0.1, 0.3, 0.2]}
TENSOR = {"shape": "none", "mass": 1.0, "inertia": [[0.3, 0.05, -0.02], [0.05, 0.45, 0.04], [-0.02, 0.04, 0.4]]}
PARTICLES = {
    "particles": [
        {"mass": 1.0, "position": [0.5, 0.1, 0.0]},
        {"mass": 2.0, "position": [-0.2, 0.4, 0.1]},
        {"mass": 0.5, "position": [0.1, -0.3, 0.6]},
    ]
}
TURNED = {"euler_zxz": [0.3, 0.8, -0.4], "velocity": [1.0, 2.0, 3.0]}
SPIN = {"angular_velocity": [1.0, 2.0, -3.0]}
RATES = {"euler_rates": [1.0, 2.0, -3.0]}


def replaced(function: Callable[..., Any], change: Callable[[Any], Any]) -> Callable[..., Any]:
    """A function whose result is changed."""

    @functools.wraps(function)
    def faulty(*arguments: Any) -> Any:
        return change(function(*arguments))

    return faulty


def wrong_dtheta(patch: Patch) -> None:
    right = rotations.body_rates

    def faulty(given: Any, rates: Any) -> Any:
        return right(given, type(rates)(rates.dphi, -rates.dtheta, rates.dpsi))

    patch.setattr(exact_start, "body_rates", faulty)


def wrong_moment(patch: Patch) -> None:
    patch.setattr(inertia, "moments", replaced(inertia.moments, lambda abc: (abc[0] * 3 / 4, abc[1], abc[2])))


def wrong_products(patch: Patch) -> None:
    def opposite(made: inertia.MassProperties) -> inertia.MassProperties:
        xx, yy, zz, xy, xz, yz = made.tensor
        return inertia.MassProperties(made.mass, made.centre, (xx, yy, zz, -xy, -xz, -yz))

    patch.setattr(exact_start, "mass_properties", replaced(inertia.mass_properties, opposite))


def wrong_way_to_the_axes(patch: Patch) -> None:
    right = exact_start._along
    patch.setattr(exact_start, "_along", lambda axes, rates: right(rotations.conjugate(axes), rates))


def conjugated_attitude(patch: Patch) -> None:
    patch.setattr(exact_start, "attitude", replaced(rotations.attitude, rotations.conjugate))


def wrong_sign_of_rates(patch: Patch) -> None:
    def backwards(form: closed_form.Form) -> closed_form.Form:
        def rotation(begin: Any, times: Any) -> Any:
            turning = form.rotation(begin, times)
            return type(turning)(**(vars(turning) | {"angular_velocity": -turning.angular_velocity}))

        return closed_form.Form(form.name, form.reason, rotation)

    patch.setattr(closed_form, "smallest_form", replaced(closed_form.smallest_form, backwards))


def gravity_upwards(patch: Patch) -> None:
    from dataclasses import replace

    right = closed_form.parabola
    patch.setattr(closed_form, "parabola", lambda scene, times: right(replace(scene, gravity=-scene.gravity), times))


def slow_clock(patch: Patch) -> None:
    right = torque_free.tumbling
    patch.setattr(torque_free, "tumbling", lambda motion, t: right(motion, t * (1 + 1e-9)))


#: What is planted, and the body and the start of the motion that it disturbs.
FAULTS: dict[str, tuple[Callable[[Patch], None], dict[str, Any], dict[str, Any]]] = {
    "sign of dtheta": (wrong_dtheta, BRICK, TURNED | RATES),
    "moment A times 3/4": (wrong_moment, BRICK, TURNED | SPIN),
    "sign of the products of inertia": (wrong_products, PARTICLES, TURNED | SPIN),
    "sign of the products of inertia, tensor": (wrong_products, TENSOR, TURNED | SPIN),
    "rates to principal axes the wrong way": (wrong_way_to_the_axes, TENSOR, TURNED | SPIN),
    "attitude conjugated": (conjugated_attitude, BRICK, TURNED | SPIN),
    "attitude conjugated, at rest": (conjugated_attitude, BRICK, TURNED),
    "sign of the rates": (wrong_sign_of_rates, BRICK, TURNED | SPIN),
    "gravity upwards": (gravity_upwards, BRICK, TURNED | SPIN),
    "gravity upwards, without spin": (gravity_upwards, BRICK, TURNED),
    "clock": (slow_clock, BRICK, TURNED | SPIN),
    "clock, of a tensor": (slow_clock, TENSOR, TURNED | SPIN),
}


@pytest.fixture
def planted() -> Iterator[None]:
    """Nothing of a faulty start is kept, neither before nor after a test."""
    caches = (exact_start.start, exact_start.defined_inertia, border._border, border._of_file, border._of_doubles)
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()


def differences(one: Trajectory, other: Trajectory) -> dict[str, np.ndarray]:
    return {
        "error": geodesic_angle(one.quaternion, other.quaternion),
        **{
            f"{name}_error": np.linalg.norm(getattr(one, name) - getattr(other, name), axis=1)
            for name in ("position", "velocity", "angular_velocity")
        },
    }


@pytest.mark.parametrize("times", [TIMES, TIMES * 1000], ids=["seconds", "an hour"])
@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_in_the_bounds(
    fault: str, times: np.ndarray, planted: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    plant, body, initial = FAULTS[fault]
    text = a_case("planted", body=body, initial=initial, scene={"gravity": 9.81})
    right = truth(parse(text, "planted").scene, times).trajectory
    with monkeypatch.context() as patch:
        for cache in (exact_start.start, exact_start.defined_inertia):
            cache.cache_clear()
        plant(patch)
        found = truth(parse(text, "planted").scene, times)
    apart = differences(found.trajectory, right)
    assert max(distance.max() for distance in apart.values()) > 1e-9
    for name, distance in apart.items():
        # The doubles of both motions and of the start differ by a few roundings besides.
        assert (getattr(found.bounds, name) >= 0.999 * distance - 1e-15).all(), name
