"""A block that lies flat: rest, straight and oblique slides, pushes, and the onset of tipping."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy
from hypothesis import example, given
from hypothesis import strategies as st

from bodycheck.reference.contact.flat.oblique import EXACT, Oblique, at_angle, oblique, state, states, stop
from bodycheck.reference.contact.problem import problem
from bodycheck.reference.contact.ways import contact_motion
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import MP, wide
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Push, Scene, State, Vector
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from tests.support.blocks import GRAVITY, HALVES, MASS, block_on, in_world, integrated

#: Agreement with an integration in double precision whose tolerance is 3e-14 a step (m and m/s).
INTEGRATION = 1e-12

#: An incline without a name in the tests (rad).
SLOPE = 0.3


def along(found: Truth) -> Array:
    """Places and velocities (n, 4) along the axes of the plane, from the place at t = 0."""
    plane = found.scene.plane
    assert plane is not None
    back = conjugate(np.array([math.cos(plane.incline / 2), 0.0, math.sin(plane.incline / 2), 0.0]))
    place, velocity = rotate(back, found.trajectory.position), rotate(back, found.trajectory.velocity)
    return np.hstack([place[:, :2], velocity[:, :2]])


#: Planes, velocities along them, and pushes along them at the centre of mass.
MOTIONS: dict[str, tuple[Plane, Vector, tuple[Push, ...]]] = {
    "downhill, faster": (Plane(0.2, incline=SLOPE), (0.5, 0.0, 0.0), ()),
    "downhill, until it rests": (Plane(0.5, incline=SLOPE), (1.5, 0.0, 0.0), ()),
    "uphill and back": (Plane(0.2, incline=SLOPE), (-2.0, 0.0, 0.0), ()),
    "uphill, and stays": (Plane(0.5, incline=SLOPE), (-2.0, 0.0, 0.0), ()),
    "from rest": (Plane(0.2, incline=SLOPE), (0.0, 0.0, 0.0), ()),
    "across, until it rests": (Plane(0.5, incline=SLOPE), (-1.0, 1.5, 0.0), ()),
    "across, and goes on": (Plane(0.2, incline=SLOPE), (-1.0, -1.5, 0.0), ()),
    "nearly uphill": (Plane(0.2, incline=SLOPE), (-1.0, 0.02, 0.0), ()),
    "nearly downhill": (Plane(0.3, incline=SLOPE), (1.0, 1e-9, 0.0), ()),
    "without friction": (Plane(0.0, incline=SLOPE), (-1.0, 1.5, 0.0), ()),
    "pushed aside while it slides": (
        Plane(0.4, incline=SLOPE),
        (1.0, 0.5, 0.0),
        (Push((0.0, -6.0, 0.0), start=0.2, end=0.9), Push((1.0, 0.0, -8.0), start=0.5)),
    ),
    "pushed twice": (Plane(0.3), (0.0, 0.0, 0.0), (Push((6.0, 4.0, 2.0), end=0.4), Push((0.0, -9.0, 0.0), start=1.1, end=1.2))),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_a_block_moves_as_an_independent_integration_says(name: str) -> None:
    plane, velocity, pushes = MOTIONS[name]
    times = np.linspace(0.0, 1.6, 17)
    found = along(truth(block_on(plane, velocity, *pushes), times))
    expected = integrated(plane, velocity, pushes, times)
    start = np.array([*found[0, :2], 0.0, 0.0])
    assert np.abs(found - start - expected).max() < INTEGRATION


@pytest.mark.parametrize("angle", [0.0, 0.7, math.pi])
def test_a_level_slide_is_that_of_a_body_that_is_not_pushed(angle: float) -> None:
    """A push without force changes nothing, but another module has the slide of a body alone on a level plane."""
    scene = block_on(Plane(0.4), (2 * math.cos(angle), 2 * math.sin(angle), 0.0), yaw=0.4)
    times = np.linspace(0.0, 1.0, 11)
    alone, pushed = truth(scene, times), truth(replace(scene, pushes=(Push((0.0, 0.0, 0.0)),)), times)
    assert alone.model != pushed.model
    assert alone.stop is not None
    assert [event.kind for event in pushed.events] == ["rest"]
    assert pushed.events[0].time == pytest.approx(alone.stop.time, abs=1e-15)
    assert pushed.trajectory.position == pytest.approx(alone.trajectory.position, abs=1e-14)
    assert pushed.trajectory.velocity == pytest.approx(alone.trajectory.velocity, abs=1e-14)


def test_an_oblique_slide_solves_its_equations_of_motion() -> None:
    """The closed form in lambda, by SymPy, with dt = v dlambda / D: v' = D (along) - mu N v / |v|."""
    turned, c, s, k, d, v0 = sympy.symbols("lambda c s kappa D v0", positive=True)
    sine = 2 * sympy.sqrt(c * s)
    grown = lambda power: (1 - sympy.exp(-power * turned)) / power  # noqa: E731
    time = v0 / d * (c * grown(k - 1) + s * grown(k + 1))
    x = v0**2 / d * (c**2 * grown(2 * k - 2) - s**2 * grown(2 * k + 2))
    y = v0**2 / d * sine * (c * grown(2 * k - 1) + s * grown(2 * k + 1))
    u = v0 * (c * sympy.exp(-(k - 1) * turned) - s * sympy.exp(-(k + 1) * turned))
    v = v0 * sine * sympy.exp(-k * turned)
    speed = v0 * (c * sympy.exp(-(k - 1) * turned) + s * sympy.exp(-(k + 1) * turned))
    rate = sympy.diff(time, turned)
    assert sympy.simplify(sympy.expand(u**2 + v**2 - speed**2)) == 0
    for place, velocity, drive in ((x, u, d), (y, v, 0)):
        assert sympy.simplify(sympy.expand(sympy.diff(place, turned) - velocity * rate)) == 0
        residual = sympy.diff(velocity, turned) - rate * (drive - k * d * velocity / speed)
        assert sympy.simplify(sympy.expand(residual)) == 0
    # At lambda = 0 the velocity is v0 (c - s, 2 sqrt(c s)), which is v0 (cos phi0, sin phi0).
    assert sympy.simplify(u.subs(turned, 0) - v0 * (c - s)) == 0


@given(st.floats(0.01, 3.13), st.one_of(st.floats(0.0, 5.0), st.sampled_from([0.5, 1.0, 1.0 + 1e-12])), st.floats(0.01, 0.999))
def test_the_wide_type_keeps_the_digits_of_an_oblique_slide(angle: float, ratio: float, part: float) -> None:
    """Newton's method in the wide type against that with a hundred digits, within the bound that `block` states."""
    slide = oblique((MP.cos(angle), MP.sin(angle)), (MP.mpf(1), MP.mpf(0)), MP.mpf(ratio))
    last = min(stop(slide), MP.mpf(20))
    time = MP.mpf(float(last * part))
    ways, velocities = states(slide, np.array([wide(time)]))
    way, velocity = state(slide, time)
    unit = 256 * float(np.finfo(np.longdouble).eps)
    travelled, gained = float((1 + (1 + ratio) * time) * time), float(1 + (1 + ratio) * time)
    assert max(abs(MP.convert(one) - other) for one, other in zip(ways[0], way, strict=True)) <= unit * travelled
    assert max(abs(MP.convert(one) - other) for one, other in zip(velocities[0], velocity, strict=True)) <= unit * gained


@given(st.floats(1e-3, 10.0), st.integers(-3, 3))
@example(0.5, 0)
@example(1.0, 0)
def test_rest_and_slip_are_decided_exactly(friction: float, ulps: int) -> None:
    """At inclines about atan(mu) rounded to a double, where the two motions differ by less than their bound."""
    incline = math.atan(friction)
    for _ in range(abs(ulps)):
        incline = math.nextafter(incline, math.copysign(2.0, ulps))
    flat = Cylinder(100.0, 0.01)
    start = State(in_world(incline, (0.0, 0.0, 0.01)), (math.cos(incline / 2), 0.0, math.sin(incline / 2), 0.0))
    scene = Scene(Body(1.0, principal_moments(flat, 1.0), flat), start, GRAVITY, Plane(friction, incline=incline))
    times = np.array([0.0, 60.0])
    found = contact_motion(problem(scene), times)
    rests = bool(MP.tan(MP.mpf(incline)) <= MP.mpf(friction))
    assert bool(found.interfaces) is rests
    assert [event.kind for event in found.events] == ([] if rests else ["slip"])
    excess = MP.mpf(GRAVITY) * (MP.sin(MP.mpf(incline)) - MP.mpf(friction) * MP.cos(MP.mpf(incline)))
    if ulps == 0:
        assert abs(excess) * 1800 <= float(found.errors["position_error"][1])
        assert abs(excess) * 60 <= float(found.errors["velocity_error"][1])
    if friction == 0.5 and ulps == 0:
        assert float(found.errors["position_error"][1]) < 2.5e-12


def test_what_it_needs_to_rest_without_slip() -> None:
    plane = Plane(math.inf, incline=0.25)
    found = truth(block_on(plane), np.array([0.0, 1.0]))
    assert found.friction == pytest.approx(math.tan(0.25), rel=1e-15)
    assert [interface.bodies for interface in found.interfaces] == [(-1, 0)]
    assert found.interfaces[0].load == pytest.approx(MASS * GRAVITY * math.cos(0.25), rel=1e-15)


def test_events_are_the_instants_of_stops_and_pushes() -> None:
    up = truth(block_on(Plane(0.2, incline=SLOPE), (-2.0, 0.0, 0.0)), np.array([0.0, 5.0]))
    turn = 2 / (GRAVITY * (math.sin(SLOPE) + 0.2 * math.cos(SLOPE)))
    assert [(event.kind, event.time) for event in up.events] == [("slip", pytest.approx(turn, abs=1e-15))]
    stays = truth(block_on(Plane(0.5, incline=SLOPE), (-2.0, 0.0, 0.0)), np.array([0.0, 5.0]))
    assert [event.kind for event in stays.events] == ["rest"]
    assert not stays.trajectory.velocity[-1].any()
    pushed = truth(block_on(Plane(0.3), (0.0, 0.0, 0.0), Push((7.0, 0.0, 0.0), start=0.5, end=1.0)), np.array([0.0, 5.0]))
    gained = 0.5 * (7.0 / MASS - 0.3 * GRAVITY)
    expected = [("slip", 0.5), ("rest", pytest.approx(1.0 + gained / (0.3 * GRAVITY), abs=1e-15))]
    assert [(event.kind, event.time) for event in pushed.events] == expected
    # A push below the limit of friction moves nothing.
    weak = truth(block_on(Plane(0.3), (0.0, 0.0, 0.0), Push((5.8, 0.0, 0.0))), np.array([0.0, 5.0]))
    assert weak.events == ()


def test_where_the_resultant_of_the_normal_forces_is() -> None:
    """Forces and moments about the centre of mass of a body that does not turn, by SymPy, where `legs` says."""
    h, n, fx, fy, px, py, pz, gx, gy, gz = sympy.symbols("h N Fx Fy px py pz Px Py Pz")
    push, point = sympy.Matrix([gx, gy, gz]), sympy.Matrix([px, py, pz])
    lever = sympy.Matrix([pz * gx - px * gz, pz * gy - py * gz])
    place = (lever - h * sympy.Matrix([fx, fy])) / n
    contact = sympy.Matrix([place[0], place[1], -h])
    moment = contact.cross(sympy.Matrix([fx, fy, n])) + point.cross(push)
    assert sympy.simplify(moment[0]) == 0
    assert sympy.simplify(moment[1]) == 0
    twist = px * gy - py * gx + (lever[0] * fy - lever[1] * fx) / n
    assert sympy.simplify(moment[2] - twist) == 0


@pytest.mark.parametrize(("yaw", "reach"), [(0.0, HALVES[0]), (math.pi / 2, HALVES[1]), (0.5, HALVES[1] / math.sin(0.5))])
def test_a_block_at_rest_tips_where_its_weight_leaves_its_base(yaw: float, reach: float) -> None:
    """The foot of a vertical through the centre of mass leaves a turned rectangle through one of its edges."""
    reach = min(reach, HALVES[0] / abs(math.cos(yaw)))
    border = math.atan(reach / HALVES[2])
    times = np.array([0.0, 1.0])
    held = truth(block_on(Plane(math.inf, incline=border * (1 - 1e-9)), yaw=yaw), times)
    falls = truth(block_on(Plane(math.inf, incline=border * (1 + 1e-9)), yaw=yaw), times)
    assert held.events == ()
    assert [(event.kind, event.time) for event in falls.events] == [("tip", 0.0)]
    assert np.isfinite(falls.trajectory.position[0]).all()
    assert np.isnan(falls.trajectory.position[1]).all()
    assert np.isnan(falls.bounds.position_error[1])


@pytest.mark.parametrize("shape", [Brick((0.1, 0.1, 0.2)), Cylinder(0.1, 0.2)])
def test_a_block_that_slides_tips_where_friction_is_large(shape: Brick | Cylinder) -> None:
    """mu h > reach, whatever pushes the centre of mass down."""
    for friction, tips in ((0.5, False), (0.5000001, True)):
        start = State((0.0, 0.0, 0.2), velocity=(1.0, 0.0, 0.0))
        body = Body(1.0, principal_moments(shape, 1.0), shape)
        scene = Scene(body, start, GRAVITY, Plane(friction), pushes=(Push((0.0, 0.0, -1.0)),))
        found = truth(scene, np.array([0.0, 0.1]))
        assert any(event.kind == "tip" for event in found.events) is tips


@pytest.mark.parametrize(("height", "kind"), [(-0.1, "slip"), (0.0, "slip"), (0.1, "tip")])
def test_a_push_below_the_tipping_height_moves_a_block_and_one_above_it_tips_it(height: float, kind: str) -> None:
    """P (h + height) is to be below half-width times weight, and P above mu times weight."""
    tall = Brick((0.1, 0.1, 0.2))
    body = Body(1.0, principal_moments(tall, 1.0), tall)
    push = Push((0.45 * GRAVITY, 0.0, 0.0), (0.0, 0.0, height), start=0.5)
    scene = Scene(body, State((0.0, 0.0, 0.2)), GRAVITY, Plane(0.4), pushes=(push,))
    found = truth(scene, np.array([0.0, 0.5, 0.6]))
    assert [(event.kind, event.time) for event in found.events] == [(kind, 0.5)]
    assert bool(np.isnan(found.trajectory.position[2]).all()) is (kind == "tip")


def test_an_oblique_slide_tips_when_its_direction_reaches_the_narrow_side() -> None:
    """At the onset mu h |cos| is the half-width, with the direction of the velocity of the same slide of a wide block."""
    narrow, wide_one = (Brick((0.08, 0.5, 0.2)), Brick((5.0, 5.0, 0.2)))
    incline, friction, velocity = 0.3, 0.5, (0.0, 2.0, 0.0)
    made = block_on(Plane(friction, incline=incline), velocity)
    start = replace(made.initial, position=in_world(incline, (0.0, 0.0, 0.2)))
    scenes = [
        replace(made, body=Body(1.0, principal_moments(shape, 1.0), shape), initial=start) for shape in (narrow, wide_one)
    ]
    tips = truth(scenes[0], np.array([0.0, 10.0])).events
    assert [event.kind for event in tips] == ["tip"]
    u, v = along(truth(scenes[1], np.array([0.0, tips[0].time])))[1, 2:]
    assert friction * 0.2 * u / math.hypot(u, v) == pytest.approx(0.08, rel=1e-13)


def test_an_oblique_slide_reaches_an_angle_at_the_time_that_is_said() -> None:
    slide = oblique((MP.mpf(-1), MP.mpf(2)), (MP.mpf(3), MP.mpf(0)), MP.mpf(2))
    assert isinstance(slide, Oblique)
    _, (u, v) = state(slide, at_angle(slide, MP.mpf("0.4")))
    assert abs(MP.atan2(v, u) - MP.mpf("0.4")) < MP.mpf(10) ** -70
    assert EXACT.taken(0.5) == 0.5


def test_a_block_lies_on_any_face() -> None:
    times = np.linspace(0.0, 1.0, 5)
    flat = block_on(Plane(0.2, incline=SLOPE), (-1.0, 0.5, 0.0))
    quarter = math.sqrt(0.5)
    c, s = math.cos(SLOPE / 2), math.sin(SLOPE / 2)
    side = State(
        in_world(SLOPE, (0.0, 0.0, HALVES[0])),
        (c * quarter, s * quarter, s * quarter + c * quarter, 0.0),
        flat.initial.velocity,
    )
    side = replace(side, quaternion=(quarter * (c - s), 0.0, quarter * (c + s), 0.0))
    turned = truth(replace(flat, initial=side), times)
    lower = np.array(in_world(SLOPE, (0.0, 0.0, HALVES[0] - HALVES[2])))
    assert turned.trajectory.position - lower == pytest.approx(truth(flat, times).trajectory.position, abs=1e-15)


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        (block_on(Plane(0.5), (0.0, 0.0, 0.0), Push((0.0, 0.0, 30.0), start=1.0)), "nothing presses"),
        (block_on(Plane(0.5), (0.0, 0.0, 0.0), Push((3.0, 0.0, 0.0), (0.0, 0.1, 0.0))), "turns a block about the normal"),
        (block_on(Plane(0.5, incline=SLOPE), (0.0, 1.0, 0.0), Push((3.0, 0.0, 0.0), (0.0, 0.0, 0.05))), "turns a block"),
        (block_on(Plane(math.inf), (1.0, 0.0, 0.0)), "on which nothing slips"),
    ],
)
def test_what_no_closed_form_has_is_refused(scene: Scene, reason: str) -> None:
    with pytest.raises(NotModelled, match=reason):
        truth(scene, np.array([0.0, 1.0]))


def test_a_block_that_spins_on_an_incline_is_refused() -> None:
    scene = block_on(Plane(0.5, incline=SLOPE))
    spinning = replace(scene, initial=replace(scene.initial, angular_velocity=(0.0, 0.0, 1.0)))
    with pytest.raises(NotModelled, match="spins"):
        truth(spinning, np.array([0.0, 1.0]))


def test_numbers_of_any_size_have_a_motion_or_a_reason() -> None:
    """A stop whose deceleration is no double, and one whose direction hardly turns."""
    slow = block_on(Plane(1e-200), (-1e-100, 0.0, 0.0), gravity=1e-100)
    steep = block_on(Plane(math.tan(1e-100), incline=1e-100), (0.0, 1.0, 0.0), gravity=1e100)
    for scene in (slow, steep):
        try:
            found = truth(scene, np.array([0.0, 1.0]))
        except (NotModelled, OutOfReach):
            continue
        assert np.isfinite(found.trajectory.position).all()
