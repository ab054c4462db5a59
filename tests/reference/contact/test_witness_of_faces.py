"""The second ways of blocks, falling bodies, rods, coins and piles: they agree with the first, and faults show in full."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck import load
from bodycheck.casefile.case import parse
from bodycheck.reference.certificate import certify
from bodycheck.reference.contact import dropped
from bodycheck.reference.contact.coin import ends
from bodycheck.reference.contact.coin import way as coin_way
from bodycheck.reference.contact.flat import legs
from bodycheck.reference.contact.leaning import lean, rod
from bodycheck.reference.contact.piles import pushed, rest
from bodycheck.reference.contact.witness import resting
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism, PairContact
from bodycheck.reference.scene import Brick, Plane, Push, Sphere
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import distance
from tests.support.blocks import block_on
from tests.support.cases import a_case
from tests.support.coins import rolling
from tests.support.piles import GRAVITY, body

Patch = pytest.MonkeyPatch

TIMES = np.linspace(0.0, 0.5, 11)

#: How late a planted event is (s).
LATE = 1e-9

#: The shipped cases whose bodies have faces, and that take no second.
SHIPPED = (
    *("block-pushed-high", "block-rests-on-ramp", "block-slides-on-ramp", "block-up-a-ramp"),
    *("dropped-brick-corner", "dropped-brick-edge", "falling-rod", "rolling-coin-circle", "stack-mass-ratio"),
)


def scene_of(text: str) -> AnyScene:
    return parse(text, "scene.case.toml").scene


def coin(friction: float | str) -> AnyScene:
    """The coin of the shipped case that wobbles, on a plane with another friction."""
    body_and_start = load("rolling-coin-wobble").scene
    assert body_and_start.plane is not None
    rough = math.inf if isinstance(friction, str) else friction
    return replace(body_and_start, plane=replace(body_and_start.plane, friction=rough))


def tumbling() -> AnyScene:
    """A brick that falls and spins."""
    start = {"position": [0.0, 0.0, 1.5], "euler_zxz": [0.3, 0.7, 0.5], "angular_velocity": [3.0, -7.0, 5.0]}
    return scene_of(
        a_case(
            body={"shape": "brick", "semi_axes": [0.1, 0.15, 0.05], "mass": 1.0},
            initial=start,
            scene={"gravity": 9.81, "plane": {"friction": 0.5, "incline": 0.2}},
        )
    )


def box_under_balls(end: float = math.inf) -> Mechanism:
    """A box that is pushed under two spheres, of which one rolls and the other slips until they touch."""
    bodies = (
        body("box", Brick((2.0, 2.0, 0.5)), 10.0, (0.0, 0.0, 0.5)),
        body("rolls", Sphere(0.1), 1.0, (-0.3, 0.0, 1.1)),
        body("slips", Sphere(0.1), 1.0, (0.0, 0.0, 1.1)),
    )
    contacts = (PairContact((0, 1), 0.8, 0.0), PairContact((0, 2), 0.01, 0.0))
    return Mechanism(bodies, gravity=GRAVITY, plane=Plane(0.1), contacts=contacts, pushes=(Push((60.0, 0.0, 0.0), end=end),))


def box_under_a_ball_at_its_edge() -> Mechanism:
    """The box under one sphere, which rolls from its edge."""
    scene = box_under_balls()
    box, ball, _ = scene.bodies
    assert ball.start is not None
    at_edge = replace(ball, start=replace(ball.start, position=(-1.9, 0.0, 1.1)))
    return replace(scene, bodies=(box, at_edge), contacts=scene.contacts[:1])


OBLIQUE = block_on(Plane(0.5, incline=0.3), (-1.0, 1.5, 0.0))
STRAIGHT = block_on(Plane(0.2, incline=0.3), (-2.0, 0.0, 0.0))
ROD = load("falling-rod").scene


def reversed_friction(patch: Patch) -> None:
    right = legs._unit
    patch.setattr(legs, "_unit", lambda vector: tuple(-part for part in right(vector)))


def turned_drive(patch: Patch) -> None:
    right = legs.oblique

    def faulty(velocity: Any, force: Any, friction: Any) -> Any:
        x, y = force
        return right(velocity, (x - y / 10**6, y + x / 10**6), friction)

    patch.setattr(legs, "oblique", faulty)


def turned_friction(patch: Patch) -> None:
    """Friction in the direction of a velocity that is turned by a millionth."""
    right = legs.oblique
    patch.setattr(legs, "oblique", lambda velocity, *forces: right((velocity[0] - velocity[1] / 10**6, velocity[1]), *forces))


def wrong_moments_of_what_is_dropped(patch: Patch) -> None:
    right = dropped._alone

    def faulty(given: Any) -> Any:
        scene = right(given)
        a, b, c = scene.body.moments
        return replace(scene, body=replace(scene.body, moments=(a * 3 / 5, b, c)))

    patch.setattr(dropped, "_alone", faulty)


def wrong_moment_of_the_rod(patch: Patch) -> None:
    right = lean._axes

    def faulty(*given: Any) -> Any:
        up, halves, moment, tilted = right(*given)
        return up, halves, moment * 3 / 5, tilted

    patch.setattr(lean, "_axes", faulty)


def wrong_moment_of_the_coin(patch: Patch) -> None:
    right = coin_way.coin
    patch.setattr(coin_way, "coin", lambda problem: replace(right(problem), along=right(problem).along * 3 / 5))


def wrong_roundness(patch: Patch) -> None:
    right = pushed._roundness
    patch.setattr(pushed, "_roundness", lambda given: right(given) * 5 / 3)


#: Faults in the first way, the scene, and the state in which they show.
FAULTS: tuple[tuple[Callable[[Patch], None], AnyScene, str], ...] = (
    (reversed_friction, STRAIGHT, "velocity"),
    (turned_drive, OBLIQUE, "velocity"),
    (turned_friction, OBLIQUE, "position"),
    (wrong_moments_of_what_is_dropped, tumbling(), "angular_velocity"),
    (wrong_moment_of_the_rod, ROD, "position"),
    (wrong_moment_of_the_coin, coin("no-slip"), "velocity"),
    (wrong_roundness, box_under_balls(), "velocity"),
)


@pytest.mark.parametrize(("fault", "scene", "state"), FAULTS, ids=lambda given: getattr(given, "__name__", ""))
def test_a_planted_fault_shows_in_full(fault: Callable[[Patch], None], scene: AnyScene, state: str, monkeypatch: Patch) -> None:
    right = certify(scene, TIMES)
    assert right.faults == ()
    fault(monkeypatch)
    wrong = certify(scene, TIMES)
    error = np.atleast_2d(distance(getattr(wrong.truth.trajectory, state), getattr(right.truth.trajectory, state)))
    share = error / np.maximum(getattr(wrong.truth.bounds, f"{state}_error"), np.finfo(float).tiny)
    assert np.nanmax(error) > 1e-7
    # The whole difference is added to the bound.
    assert 0.5 <= np.nanmax(share) <= 1
    assert not wrong.certified
    assert wrong.faults[0].startswith("truth and ")


def late_tip(patch: Patch) -> None:
    right = legs._tips
    patch.setattr(legs, "_tips", lambda *given: None if (time := right(*given)) is None else time + MP.mpf(LATE))


def late_slip_of_the_rod(patch: Patch) -> None:
    right = rod._event

    def faulty(*given: Any) -> Any:
        return replace(right(*given), time=right(*given).time + LATE)

    patch.setattr(rod, "_event", faulty)


def late_end_of_the_coin(patch: Patch) -> None:
    right = ends._end

    def faulty(*given: Any) -> Any:
        end = right(*given)
        return None if end is None else replace(end, time=end.time + np.longdouble(1e-9 * 30))

    patch.setattr(ends, "_end", faulty)


def late_touch(patch: Patch) -> None:
    right = dropped._impact
    patch.setattr(dropped, "_impact", lambda problem, given, instant: right(problem, given, instant + LATE))


def late_impact_of_spheres(patch: Patch) -> None:
    right = pushed._end

    def faulty(*given: Any) -> Any:
        instant, kind, index = right(*given)
        return instant + LATE, kind, index

    patch.setattr(pushed, "_end", faulty)


#: Faults in the instants of events, and the scene in which they show.
LATE_EVENTS: tuple[tuple[Callable[[Patch], None], AnyScene, str], ...] = (
    (late_tip, block_on(Plane(2.2, incline=0.9), (-0.6, 1.0, 0.0)), "tip"),
    (late_slip_of_the_rod, ROD, "slip"),
    (late_end_of_the_coin, coin(0.4), "slip"),
    (late_end_of_the_coin, rolling(1.5, (0.1, 0.5, -12.0)), "impact"),
    (late_touch, tumbling(), "impact"),
    (late_impact_of_spheres, box_under_balls(), "impact"),
)


@pytest.mark.parametrize(("fault", "scene", "kind"), LATE_EVENTS, ids=lambda given: getattr(given, "__name__", ""))
def test_an_event_that_is_late_shows_in_full(
    fault: Callable[[Patch], None], scene: AnyScene, kind: str, monkeypatch: Patch
) -> None:
    times = np.linspace(0.0, 1.5, 16)
    right = certify(scene, times)
    assert right.faults == ()
    event = next(event for event in right.truth.events if event.kind == kind)
    assert event.error < LATE / 100
    fault(monkeypatch)
    wrong = certify(scene, times)
    late = next(event for event in wrong.truth.events if event.kind == kind)
    assert 0.5 * late.error <= late.time - event.time <= late.error
    assert not wrong.certified
    assert any(f"has the event {kind} at t = " in fault for fault in wrong.faults)


@pytest.mark.parametrize(
    "scene", [box_under_balls(end=0.4), box_under_a_ball_at_its_edge()], ids=["push ends", "sphere leaves"]
)
def test_an_end_that_is_late_and_no_event_shows(scene: Mechanism, monkeypatch: Patch) -> None:
    times = np.linspace(0.0, 1.5, 16)
    right = certify(scene, times)
    assert right.faults == ()
    assert right.truth.events == ()
    assert np.isnan(right.truth.bounds.error[-1])
    late_impact_of_spheres(monkeypatch)
    (fault,) = certify(scene, times).faults
    assert "has the event end at t = " in fault
    assert fault.endswith("has it 1e-09 s before or after")


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_cases_are_cross_checked(name: str) -> None:
    case = load(name)
    assert certify(case.scene, case.instants).faults == ()


def test_a_pile_without_balance_has_no_second_way(monkeypatch: Patch) -> None:
    """A first way that forgot to see whether a stack tips is not confirmed."""
    stack = tuple(body(f"brick-{n}", Brick((0.1, 0.1, 0.05)), 1.0, (0.06 * n, 0.0, 0.05 + 0.1 * n)) for n in range(4))
    scene = Mechanism(stack, gravity=GRAVITY, plane=Plane(0.5))
    monkeypatch.setattr(rest, "_check_tree", lambda *given: None)
    assert certify(scene, TIMES).word == "estimated"


def test_a_pile_that_friction_does_not_hold_has_no_second_way(monkeypatch: Patch) -> None:
    angle = 0.4
    sine, cosine = math.sin(angle), math.cos(angle)
    stack = tuple(
        body(f"brick-{n}", Brick((0.2, 0.2, 0.05)), 1.0, (sine * height, 0.0, cosine * height), tilt=angle)
        for n, height in enumerate((0.05, 0.15))
    )
    scene = Mechanism(stack, gravity=GRAVITY, plane=Plane(math.tan(angle) * (1 + 1e-6), incline=angle))
    assert certify(scene, TIMES).faults == ()
    slippery = replace(scene, plane=Plane(math.tan(angle) * (1 - 1e-6), incline=angle))
    monkeypatch.setattr(rest, "_slope", lambda *given: np.longdouble(math.tan(angle)))
    assert certify(slippery, TIMES).word == "estimated"


def test_the_balance_of_a_pile_needs_the_contacts() -> None:
    """Without the plane nothing bears the lower brick."""
    stack = tuple(body(f"brick-{n}", Brick((0.1, 0.1, 0.05)), 1.0, (0.0, 0.0, 0.05 + 0.1 * n)) for n in range(2))
    witness = resting.second(Mechanism(stack, gravity=GRAVITY, plane=Plane(0.5)), TIMES)
    assert witness is not None
    lifted = tuple(
        replace(each, start=replace(each.start, position=(0.0, 0.0, each.start.position[2] + 0.1))) for each in stack
    )
    assert resting.second(Mechanism(lifted, gravity=GRAVITY, plane=Plane(0.5)), TIMES) is None


def test_spheres_on_a_box_touch_when_they_touch() -> None:
    """The instant has no slack: the slack of the decision whether spheres touch at the start was a thousand errors."""
    scene = box_under_balls()
    (event,) = truth(scene, np.linspace(0.0, 1.5, 4)).events
    box = (60.0 - 0.1 * 12 * GRAVITY - 0.01 * GRAVITY) / (10 + 2 / 7)
    closing = 2 / 7 * box - 0.01 * GRAVITY
    assert event.time == pytest.approx(math.sqrt(2 * 0.1 / closing), rel=1e-15)
