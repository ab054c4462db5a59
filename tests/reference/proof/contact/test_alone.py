"""Enclosures of one body on a plane: no printed bound is below them, and motions with planted faults are contradicted."""

import math
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.case import load, parse
from bodycheck.reference.scene import Brick, Plane, Push, Scene, Solid
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from tests.support import ROOT
from tests.support.proofs import certificate_of, one_body
from tests.support.proved_scenes import ball_on_plane

pytest.importorskip("flint")

from bodycheck.reference.proof import proving
from bodycheck.reference.proof.enclosure import Enclosure, NotEnclosed

#: The shipped cases of one body on a plane that are enclosed.
SHIPPED = (
    *("rolling-ball", "dropped-ball", "thrown-ball-with-spin", "ball-on-ramp", "ball-slips-on-ramp", "sensor-rolling-ball"),
    *("block-pushed-high", "block-rests-on-ramp", "block-slides-on-ramp", "block-up-a-ramp", "sensor-block-on-ramp"),
    *("resting-brick", "sliding-brick", "sliding-brick-slippery", "spinning-brick", "spinning-brick-corners"),
    *("curling-brick-decoupled", "extreme-slide", "ball-held-on-ramp", "ball-rolls-to-rest", "ball-slips-rolls-rests"),
    "ball-spins-down",
)


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_body_that_has_a_closed_form_is_enclosed(name: str) -> None:
    case = load(name)
    found = truth(case.scene, np.linspace(0, case.duration, 31))
    enclosure = proving.enclosed(case.scene, found.trajectory)
    assert enclosure.radius <= 2.0**-60
    assert enclosure.until is None
    assert certificate_of(found, enclosure).faults == ()


@pytest.mark.parametrize("seed", [*range(6), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(6, 120))])
def test_no_printed_bound_is_below_its_proof(seed: int) -> None:
    scene = ball_on_plane(seed)
    found = truth(scene, np.linspace(0, 1.5, 16))
    assert certificate_of(found, proving.enclosed(scene, found.trajectory)).faults == ()


def on_the_plane(scene: Scene, change: dict[str, Any]) -> Scene:
    assert scene.plane is not None
    return replace(scene, plane=replace(scene.plane, **change))


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("thrown-ball-with-spin", lambda scene: on_the_plane(scene, {"restitution": 0.7 * (1 + 1e-6)})),
        ("thrown-ball-with-spin", lambda scene: on_the_plane(scene, {"friction": 0.2 * (1 + 1e-9)})),
        ("dropped-ball", lambda scene: on_the_plane(scene, {"restitution": 0.8 * (1 + 1e-12)})),
        ("rolling-ball", lambda scene: replace(scene, gravity=scene.gravity * (1 + 1e-12))),
        ("ball-on-ramp", lambda scene: on_the_plane(scene, {"incline": 0.3 * (1 + 1e-12)})),
        ("block-up-a-ramp", lambda scene: on_the_plane(scene, {"friction": 0.2 * (1 + 1e-12)})),
        ("ball-slips-rolls-rests", lambda scene: on_the_plane(scene, {"rolling_friction": 0.01 * (1 + 1e-12)})),
        ("ball-spins-down", lambda scene: on_the_plane(scene, {"torsional_friction": 0.003 * (1 + 1e-12)})),
        ("spinning-brick", lambda scene: on_the_plane(scene, {"law": "corners"})),
        ("curling-brick-decoupled", lambda scene: on_the_plane(scene, {"friction": 0.5 * (1 + 1e-12)})),
    ],
    ids=[
        *("restitution", "friction of a ball", "1e-12 of the restitution", "gravity", "incline", "friction", "rolling"),
        *("pivoting", "law", "decoupled"),
    ],
)
def test_a_truth_of_another_motion_is_contradicted(name: str, fault: Callable[[Scene], Scene]) -> None:
    case = load(name)
    assert isinstance(case.scene, Scene)
    found = truth(fault(case.scene), np.linspace(0, case.duration, 31))
    faults = certificate_of(found, proving.enclosed(case.scene, found.trajectory)).faults
    assert any("is smaller than the proved distance" in each for each in faults)


def test_events_are_compared_with_their_instants() -> None:
    case = load("dropped-ball")
    found = truth(case.scene, np.linspace(0, case.duration, 11))
    enclosure = proving.enclosed(case.scene, found.trajectory)
    first, *rest = found.events
    assert faults_of(replace(found, events=(replace(first, time=first.time * (1 + 1e-12)), *rest)), enclosure) == [
        f"the printed bound of the instant of the event impact at t = {first.time:.12g} s, {first.error:.2g} s, is smaller "
        f"than the proved distance, {first.time * 1e-12:.2g} s"
    ]
    assert faults_of(replace(found, events=tuple(rest[:-1])), enclosure) != []
    assert faults_of(replace(found, events=(*found.events, replace(rest[-1], kind="slip"))), enclosure) == [
        f"the truth has the event slip at t = {rest[-1].time:.12g} s, the proof does not have it"
    ]
    assert "the truth does not have it" in faults_of(replace(found, events=found.events[:-1]), enclosure)[0]


def faults_of(found: Truth, enclosure: Enclosure) -> list[str]:
    return list(certificate_of(found, enclosure).faults)


@pytest.mark.parametrize(("push", "moves"), [(4.0, False), (math.nextafter(4.0, 0), False), (math.nextafter(4.0, 5), True)])
def test_a_push_that_equals_the_friction_holds(push: float, moves: bool) -> None:
    """With mu m g = 0.5 1 8 N exactly, a block is held, and one rounding more moves it."""
    scene = one_body(
        *(Solid(Brick((0.5, 0.5, 0.1)), 1.0), (0.0, 0.0, 0.1), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), Plane(0.5)),
        gravity=8.0,
        pushes=(Push((push, 0.0, 0.0)),),
    )
    with proving.precision(128):
        (shown,) = proving.touching(scene).states(Fraction(1)).bodies
    assert (shown[0][0] > 0) == moves
    assert shown[0][0].is_zero() != moves


@pytest.mark.parametrize(("incline", "slides"), [(math.atan(0.5), False), (math.nextafter(math.atan(0.5), 1), True)])
def test_gravity_on_a_ramp_next_to_the_friction_is_decided(incline: float, slides: bool) -> None:
    """The tangent of a rational angle is not rational, so that more digits decide on which side of 1/2 it is."""
    text = (ROOT / "bodycheck" / "cases" / "contact" / "block-rests-on-ramp.case.toml").read_text("utf-8")
    scene = parse(re.sub("incline = [0-9.]+", f"incline = {incline!r}", text), "ramp").scene
    with proving.precision(192):
        motion = proving.touching(scene)
        assert motion.changes is not None
        (then,), (now,) = (motion.states(Fraction(t)).bodies for t in (1, 100))
    assert slides == bool(now[0][0] > then[0][0])
    assert [each.kind for each in motion.changes(Fraction(1))] == (["slip"] if slides else [])


def test_reasons_why_there_is_no_proof() -> None:
    reasons = {
        "curling-brick": "friction over an area",
        "rolling-coin-circle": "does not lie on its side",
        "ball-rolls-in-one-cone": "with one limit",
    }
    for name, reason in reasons.items():
        case = load(name)
        found = truth(case.scene, np.zeros(1))
        with pytest.raises(NotEnclosed, match=reason):
            proving.enclosed(case.scene, found.trajectory)
