"""Enclosures of spheres that hit each other, and of towers: no printed bound is below them, and faults are contradicted."""

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.case import load
from bodycheck.reference.mechanisms.mechanism import BodyStart, JointedBody, Mechanism
from bodycheck.reference.scene import Brick, Plane, Solid
from bodycheck.reference.truth import truth
from tests.support.proofs import certificate_of
from tests.support.proved_scenes import two_spheres

pytest.importorskip("flint")

from bodycheck.reference.proof import proving
from bodycheck.reference.proof.enclosure import NotEnclosed

#: The shipped cases of several bodies that are enclosed.
SHIPPED = (
    *("spheres-head-on", "spheres-oblique-sliding", "spheres-oblique-sticking", "spheres-spinning", "ball-hits-ball-on-plane"),
    *("stack-of-ten", "stack-mass-ratio", "gripped-block-holds", "gripped-block-falls"),
)


def faults_of(right: Mechanism, wrong: Mechanism, end: float) -> tuple[str, ...]:
    """The faults of the truth of a scene beside the proof of another one."""
    found = truth(wrong, np.linspace(0, end, 9))
    enclosure = proving.enclosed(right, found.trajectory, found.joints)
    assert enclosure.radius <= 2.0**-60
    assert enclosure.until is None
    return certificate_of(found, enclosure).faults


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_scene_that_has_a_closed_form_is_enclosed(name: str) -> None:
    case = load(name)
    assert isinstance(case.scene, Mechanism)
    assert faults_of(case.scene, case.scene, case.duration) == ()


@pytest.mark.parametrize("seed", [*range(6), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(6, 60))])
def test_no_printed_bound_is_below_its_proof(seed: int) -> None:
    scene = two_spheres(seed)
    found = truth(scene, np.linspace(0, 1, 9))
    enclosure = proving.enclosed(scene, found.trajectory, found.joints)
    assert certificate_of(found, enclosure).faults == ()
    assert enclosure.until is None


def test_spheres_whose_hits_accumulate_are_enclosed_beyond_their_last_hit() -> None:
    """After a hit, friction makes both spheres roll towards each other again, with (2 - 5 e) / 7 of the closing speed."""
    starts = [BodyStart((0.3 * side, 0.0, 0.1), velocity=(-0.8 * side, 0.0, 0.0), rotation=(0.0, 3.0, 1.0)) for side in (-1, 1)]
    scene = two_spheres(15)
    bodies = tuple(replace(body, start=start) for body, start in zip(scene.bodies, starts, strict=True))
    scene = replace(scene, bodies=bodies, contacts=(replace(scene.contacts[0], restitution=0.36),))
    found = truth(scene, np.linspace(0, 1, 9))
    enclosure = proving.enclosed(scene, found.trajectory, found.joints)
    assert enclosure.until is None
    assert found.witnesses
    assert certificate_of(found, enclosure).faults == ()
    hits = [event.time for event in found.events if event.kind == "impact" and event.body == 0]
    assert abs(len(hits) - 80 / math.log2(7 / (2 - 5 * 0.36))) < 2  # they are left out below 2^-80
    assert hits[-1] < 1


CHANGES: dict[str, dict[str, Any]] = {
    "restitution times 1 + 1e-6": {"restitution": 0.8 * (1 + 1e-6)},
    "friction times 1 + 1e-12": {"friction": 0.1 * (1 + 1e-12)},
}


@pytest.mark.parametrize("fault", CHANGES)
def test_a_truth_of_another_impact_is_contradicted(fault: str) -> None:
    case = load("spheres-oblique-sliding")
    assert isinstance(case.scene, Mechanism)
    wrong = replace(case.scene, contacts=(replace(case.scene.contacts[0], **CHANGES[fault]),))
    assert any("is smaller than the proved distance" in each for each in faults_of(case.scene, wrong, case.duration))


def tower(shift: float, incline: float = 0.0, friction: float = 0.5) -> Mechanism:
    """A brick on a brick, shifted along x, on a plane."""
    shape, heights = Brick((0.1, 0.1, 0.05)), (0.05, 0.15)
    half = math.sin(incline / 2)
    bodies = []
    for number, height in enumerate(heights):
        x, z = shift * number, height
        place = (x * math.cos(incline) + z * math.sin(incline), 0.0, z * math.cos(incline) - x * math.sin(incline))
        start = BodyStart(place, (math.cos(incline / 2), 0.0, half, 0.0))
        bodies.append(JointedBody(f"brick{number}", Solid(shape, 1.0), start=start))
    return Mechanism(tuple(bodies), gravity=9.81, plane=Plane(friction, incline=incline))


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        (lambda: tower(0.0999), ""),
        (lambda: tower(0.1), "may tip over"),
        (lambda: tower(0.0, incline=0.2), ""),
        (lambda: tower(0.0, incline=0.2, friction=0.2), "whether friction holds"),
    ],
    ids=["stands", "at the rim", "on an incline", "slides"],
)
def test_a_tower_rests_only_if_every_face_bears_what_is_above_it(scene: Callable[[], Mechanism], reason: str) -> None:
    with proving.precision(128):
        if not reason:
            assert proving.touching(scene()).changes is not None
            return
        with pytest.raises(NotEnclosed, match=reason):
            proving.touching(scene())


@pytest.mark.parametrize(("friction", "falls"), [(0.5, False), (math.nextafter(0.5, 1), False), (math.nextafter(0.5, 0), True)])
def test_fingers_hold_a_brick_whose_weight_equals_their_friction(friction: float, falls: bool) -> None:
    """Two fingers with 8 N and a coefficient of 1/2 bear 8 N, the weight of 1 kg with 8 m/s^2."""
    scene = load("gripped-block-falls").scene
    assert isinstance(scene, Mechanism)
    laws = tuple(replace(law, friction=friction) for law in scene.contacts)
    with proving.precision(128):
        states = proving.touching(replace(scene, gravity=8.0, contacts=laws)).states(Fraction(1, 4))
    fallen = -float(states.bodies[0][0][2].mid())
    assert fallen == (16 * 2.0**-54 / 32 if falls else 0)


def test_a_truth_of_another_grip_is_contradicted() -> None:
    case = load("gripped-block-falls")
    assert isinstance(case.scene, Mechanism)
    laws = tuple(replace(law, friction=law.friction * (1 + 1e-12)) for law in case.scene.contacts)
    wrong = replace(case.scene, contacts=laws)
    assert any("is smaller than the proved distance" in each for each in faults_of(case.scene, wrong, case.duration))


def test_fingers_that_press_beside_the_line_of_the_weight_have_no_proof() -> None:
    scene = load("gripped-block-turns").scene
    assert isinstance(scene, Mechanism)
    with proving.precision(128), pytest.raises(NotEnclosed, match="aside of the vertical line"):
        proving.touching(scene)
