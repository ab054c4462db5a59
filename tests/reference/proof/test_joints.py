"""Enclosures of bodies on one joint: no printed bound is below them, faults are found, and friction is decided exactly."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.case import load
from bodycheck.reference.mechanisms.control import Controller
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.proof.enclosure import COORDINATES, QUANTITIES, Enclosure, NotEnclosed
from bodycheck.reference.truths import Truth
from tests.support.proofs import certificate_of
from tests.support.proved_scenes import driven_slider, hinge_or_slider, top

pytest.importorskip("flint")

from bodycheck.reference.proof import proving

#: The shipped cases of a body on one joint, and of one that a controller drives.
PASSIVE = (
    *("hinge-all", "hinge-armature", "hinge-damping", "hinge-effort", "hinge-friction", "hinge-spring", "slider-all"),
    *("slider-armature", "slider-damping", "slider-effort", "slider-friction", "slider-spring", "oscillator-critical"),
    *("oscillator-overdamped", "oscillator-underdamped", "pendulum-large", "pendulum-over-the-top", "pendulum-small"),
)
DRIVEN = (
    *("driven-hinge-continuous", "driven-hinge-delayed", "driven-hinge-integral", "driven-hinge-sampled"),
    *("driven-hinge-saturated-sampled", "driven-hinge-sine", "driven-slider-held-targets", "driven-slider-integral-sampled"),
    *("driven-slider-linear-targets", "driven-wheel-effort", "driven-wheel-effort-sampled", "driven-hinge-saturated"),
    *(
        "driven-hinge-torque-speed",
        "driven-slider-friction",
        "driven-stop-elastic",
        "driven-stop-rebounds",
        "driven-stop-rigid",
    ),
)


def proof(scene: Mechanism, found: Truth) -> Enclosure:
    """The enclosure of a scene at the states of a truth."""
    return proving.enclosed(scene, found.trajectory, found.joints)


def below(enclosure: Enclosure, found: Truth) -> list[str]:
    """The quantities in which a printed bound is smaller than the proved distance."""
    return [name for name in QUANTITIES if (enclosure.nearest[name] > getattr(found.bounds, name)).any()]


@pytest.mark.parametrize("name", [*PASSIVE, *DRIVEN])
def test_every_shipped_joint_is_enclosed(name: str) -> None:
    case = load(name)
    assert isinstance(case.scene, Mechanism)
    found = mechanism_truth(case.scene, np.linspace(0, case.duration, 51))
    enclosure = proof(case.scene, found)
    assert enclosure.radius <= 2.0**-60
    assert enclosure.until is None
    assert below(enclosure, found) == []
    assert enclosure.farthest[COORDINATES[0]].max() < 1e-14


@pytest.mark.parametrize("seed", range(24))
def test_no_printed_bound_is_below_its_proof(seed: int) -> None:
    scene = hinge_or_slider(seed)
    found = mechanism_truth(scene, np.linspace(0, 3, 31))
    assert below(proof(scene, found), found) == []


def test_energy_momentum_and_coordinates_of_joints_are_compared_too() -> None:
    """A printed coordinate or velocity of a joint that is off, and bounds of energy and momentum of zero, are contradicted."""
    scene = load("hinge-all").scene
    assert isinstance(scene, Mechanism)
    found = mechanism_truth(scene, np.linspace(0, 1, 5))
    assert found.joints is not None
    assert certificate_of(found, proof(scene, found)).faults == ()
    turned = replace(found.joints, position=found.joints.position + 1e-12)
    faster = replace(found.joints, velocity=found.joints.velocity * (1 + 1e-12))
    sure = replace(found.bounds, energy_error=np.zeros(5), angular_momentum_error=np.zeros(5))
    for wrong, words in (
        (replace(found, joints=turned), ["of a joint's coordinate"]),
        (replace(found, joints=faster), ["of a joint's velocity"]),
        (replace(found, bounds=sure), ["in energy", "in angular momentum"]),
    ):
        faults = certificate_of(wrong, proof(scene, wrong)).faults
        assert all(any(f"the error {each}, " in fault for fault in faults) for each in words), faults


CHANGES: dict[str, Callable[[Joint], Joint]] = {
    "damping doubled": lambda joint: replace(joint, damping=2 * joint.damping),
    "armature ignored": lambda joint: replace(joint, armature=0.0),
    "spring at zero": lambda joint: replace(joint, rest=0.0),
    "friction times 1 + 1e-9": lambda joint: replace(joint, friction=joint.friction * (1 + 1e-9)),
    "axis turned by 1e-9": lambda joint: replace(joint, axis=(joint.axis[0] + 1e-9, *joint.axis[1:])),
}


@pytest.mark.parametrize("fault", CHANGES)
def test_a_truth_of_another_motion_is_contradicted(fault: str) -> None:
    scene = load("hinge-all").scene
    assert isinstance(scene, Mechanism)
    joint = replace(scene.joints[0], armature=0.01, rest=0.1, axis=(0.0, 1.0, 0.0))
    right, wrong = (replace(scene, joints=(each,)) for each in (joint, CHANGES[fault](joint)))
    found = mechanism_truth(wrong, np.linspace(0, 1, 21))
    assert below(proof(right, found), found) != []


@pytest.mark.parametrize("change", [{"delay": 1}, {"kd": 0.3}, {"rate": 400.0}, {"effort_limit": 2.9}])
def test_a_truth_of_another_law_is_contradicted(change: dict[str, Any]) -> None:
    scene = load("driven-hinge-saturated-sampled").scene
    assert isinstance(scene, Mechanism)
    other: tuple[Controller, ...] = (replace(scene.controllers[0], **change),)
    found = mechanism_truth(replace(scene, controllers=other), np.linspace(0, 0.5, 21))
    assert "error" in below(proof(scene, found), found)


@pytest.mark.parametrize(("drive", "moves"), [(1.0, False), (math.nextafter(1.0, 0), False), (math.nextafter(1.0, 2), True)])
def test_dry_friction_at_rest_is_decided_exactly(drive: float, moves: bool) -> None:
    """A force that equals the friction holds the joint, and one that is larger by a rounding moves it."""
    joint = replace(load("slider-friction").scene.joints[0], friction=1.0, effort=drive, start=(0.0,), start_velocity=(0.0,))  # type: ignore[union-attr]
    scene = replace(load("slider-friction").scene, joints=(replace(joint, stiffness=0.0, damping=0.0),), gravity=0.0)
    with proving.precision(128):
        (q, _), *_ = proving.one_joint.states(scene)(proving.Fraction(1))  # type: ignore[arg-type]
    assert (q > 0) == moves
    assert q.is_zero() != moves


@pytest.mark.parametrize(
    ("name", "of_stops", "change"),
    [
        ("driven-stop-rebounds", True, {"restitution": 0.5 * (1 + 1e-6)}),
        ("driven-stop-rigid", True, {"upper": 0.3 * (1 + 1e-12)}),
        ("driven-stop-elastic", True, {"damping": 40.0}),
        ("driven-hinge-torque-speed", False, {"no_load_speed": 10.0 * (1 + 1e-12)}),
        ("driven-hinge-saturated", False, {"effort_limit": 3.0 * (1 + 1e-12)}),
    ],
    ids=["restitution", "limit", "damping doubled", "no-load speed", "limit of the effort"],
)
def test_a_truth_with_other_stops_or_limits_is_contradicted(name: str, of_stops: bool, change: dict[str, Any]) -> None:
    case = load(name)
    scene = case.scene
    assert isinstance(scene, Mechanism)
    (joint,), (controller,) = scene.joints, scene.controllers
    if of_stops:
        assert joint.stops is not None
        other = replace(scene, joints=(replace(joint, stops=replace(joint.stops, **change)),))
    else:
        other = replace(scene, controllers=(replace(controller, **change),))
    found = mechanism_truth(other, np.linspace(0, case.duration, 21))
    assert below(proof(scene, found), found) != []


@pytest.mark.parametrize("seed", [*range(8), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(8, 80))])
def test_limits_friction_and_stops_at_once(seed: int) -> None:
    scene = driven_slider(seed)
    found = mechanism_truth(scene, np.linspace(0, 2, 9))
    assert below(proof(scene, found), found) == []


def test_reasons_why_there_is_no_proof() -> None:
    scene = load("driven-hinge-sampled").scene
    assert isinstance(scene, Mechanism)
    scene = replace(scene, joints=(replace(scene.joints[0], friction=0.1),))
    found = mechanism_truth(scene, np.zeros(1))
    with pytest.raises(NotEnclosed, match="a sampled law beside dry friction"):
        proof(scene, found)


@pytest.mark.parametrize("seed", [0, 1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_top_on_a_ball_joint_is_enclosed(seed: int) -> None:
    scene = top(seed)
    found = mechanism_truth(scene, np.linspace(0, 0.5, 5))
    enclosure = proof(scene, found)
    assert enclosure.radius <= 2.0**-60
    assert below(enclosure, found) == []
    (joint,) = scene.joints
    faster = replace(joint, start_velocity=(joint.start_velocity[0] * (1 + 1e-9), *joint.start_velocity[1:]))
    wrong = mechanism_truth(replace(scene, joints=(faster,)), np.linspace(0, 0.5, 5))
    assert "error" in below(proof(scene, wrong), wrong)
