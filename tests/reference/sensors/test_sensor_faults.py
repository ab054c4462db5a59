"""Faults that are planted in the formulas of sensors: the derivatives of momenta find them."""

from collections.abc import Callable

import numpy as np
import pytest

from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.kinematics import cross
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.sensors import expected as expected_module
from bodycheck.reference.sensors import kinetics, wrenches
from bodycheck.reference.sensors.equations import Equations, Solution
from bodycheck.reference.sensors.kinetics import on_body
from bodycheck.reference.truths import Truth
from tests.support import jointed
from tests.support.differentiated import around, check_derivatives


def two_links() -> Mechanism:
    """Two links on hinges with armature, which swing in space."""
    return Mechanism(
        (
            jointed.body("upper", 1.0, (0.02, 0.03, 0.04), (0.1, 0.2, 0.3)),
            jointed.body("lower", 0.5, (0.01, 0.02, 0.02), (0.2, -0.1, 0.1)),
        ),
        (
            Joint("first", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), armature=0.1, start=(0.3,), start_velocity=(3.0,)),
            Joint(
                "second",
                "revolute",
                0,
                1,
                (0.3, 0.0, 0.2),
                axis=(1.0, 0.0, 0.0),
                armature=0.2,
                start=(0.4,),
                start_velocity=(-4.0,),
            ),
        ),
        gravity=9.81,
    )


@pytest.fixture(scope="module")
def swing() -> Truth:
    return around(two_links(), np.array([0.1, 0.3]))


def faulty_wrench(change: Callable[[Equations, Solution, WideArray, int], WideArray]) -> Callable[..., WideArray]:
    """A wrench with a fault: a function of the equations, their solution, the wrench and the child."""
    return lambda written, solved, moving, child: change(
        written, solved, wrenches.wrench(written, solved, moving, child), child
    )


def about_the_centre(written: Equations, _: Solution, felt: WideArray, child: int) -> WideArray:
    return np.hstack(
        [felt[:, :3], felt[:, 3:] - cross(np.broadcast_to(written.linkage.centre[child], felt[:, :3].shape), felt[:, :3])]
    )


def with_armature(written: Equations, solved: Solution, felt: WideArray, child: int) -> WideArray:
    joint = written.mechanism.joints[child]
    rotor = joint.armature * solved.accelerations[:, child, None] * np.array(joint.axis)
    return np.hstack([felt[:, :3], felt[:, 3:] + rotor])


#: The module and the name of a function, and the faulty function in its place.
FAULTS = {
    "the terms of velocities dropped": (kinetics, "cross", lambda one, _: np.zeros_like(one)),
    "gravity with the other sign": (
        expected_module,
        "on_body",
        lambda sensor, arm, gravity, moving: on_body(sensor, arm, -gravity, moving),
    ),
    "the moment about the centre of mass": (expected_module, "wrench", faulty_wrench(about_the_centre)),
    "the armature in the wrench": (expected_module, "wrench", faulty_wrench(with_armature)),
    "the wrench on the parent": (expected_module, "wrench", faulty_wrench(lambda _, __, felt, ___: -felt)),
    "no gyroscopic moment": (wrenches, "cross", lambda one, other: 0 * cross(one, other)),
}


def test_readings_of_two_links(swing: Truth) -> None:
    check_derivatives(two_links(), swing)


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault: str, swing: Truth, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(*FAULTS[fault])
    with pytest.raises(AssertionError):
        check_derivatives(two_links(), swing)
