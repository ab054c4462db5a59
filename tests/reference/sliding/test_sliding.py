"""The slide of a flat body: closed forms, the stop, what mechanics demands, and the error that it states of itself."""

import math
import warnings
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bodycheck.reference.errors import NotFlat, NotModelled, OutOfReach, WouldTip
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.integration import dop853 as integration
from bodycheck.reference.kinematics import geodesic_angle, quaternion_from_euler
from bodycheck.reference.planar import planar_state
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Scene, Sphere, State
from bodycheck.reference.sliding import coupled_motion
from bodycheck.reference.sliding.coupled_motion import Flat, Motion, in_log_time, in_plain_time
from bodycheck.reference.sliding.footprint import Disk, Footprint, Points, nearness, rectangle
from bodycheck.reference.sliding.friction import friction, uniform_friction
from bodycheck.reference.sliding.motion import Slide, slide
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth

BRICK = Brick((0.1, 0.2, 0.05))
DISK = Cylinder(0.1, 0.02)
TIMES = np.linspace(0, 1.5, 301)
#: Relative, of stop time, way and yaw.
GOAL = 1e-12


def lying(
    shape: Brick | Cylinder,
    velocity: tuple[float, float],
    spin: float,
    plane: Plane,
    gravity: float = 9.81,
    yaw: float = 0.0,
) -> Scene:
    height = shape.semi_axes[2] if isinstance(shape, Brick) else shape.half_length
    state = State((0.3, -0.2, height), (math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)), (*velocity, 0), (0, 0, spin))
    return Scene(Body(2.0, principal_moments(shape, 2.0), shape), state, gravity, plane)


@cache
def slid(scene: Scene) -> Slide:
    """The slide at `TIMES`, computed once for all tests of a scene."""
    return slide(scene, TIMES)


def stopping(scene: Scene) -> tuple[float, float, float, float]:
    """Time, way along x and y, and turn until the stop."""
    stop = slid(scene).stop
    assert stop is not None
    x, y, yaw, *_ = planar_state(scene)
    return stop.time, stop.position[0] - float(x), stop.position[1] - float(y), stop.yaw - float(yaw)


def planar_energy(scene: Scene, result: Slide) -> Array:
    v, w = result.trajectory.velocity, result.trajectory.angular_velocity[:, 2]
    return np.asarray(scene.body.mass * (v * v).sum(axis=1) / 2 + scene.body.moments[2] * w * w / 2)


@pytest.mark.parametrize("plane", [Plane(0.5), Plane(0.5, "corners"), Plane(0.5, "decoupled"), Plane(0.5, "area", "balanced")])
def test_a_straight_slide_stops_where_the_closed_form_says(plane: Plane) -> None:
    """v0/(mu g) and v0^2/(2 mu g): the chapter's 4 mu g is a misprint."""
    scene = lying(BRICK, (1.2, -1.6), 0.0, plane)
    time, x, y, turn = stopping(scene)
    assert time == pytest.approx(0.40775, abs=5e-6)
    assert (time, math.hypot(x, y)) == pytest.approx((2 / (0.5 * 9.81), 4 / (2 * 0.5 * 9.81)), rel=1e-15, abs=0)
    assert turn == 0
    trajectory = slid(scene).trajectory
    at = np.minimum(TIMES, time)
    np.testing.assert_allclose(trajectory.velocity[:, 0], 1.2 - 0.6 * 0.5 * 9.81 * at, atol=1e-15)
    np.testing.assert_allclose(trajectory.position[:, 0], 0.3 + 1.2 * at - 0.6 * 0.5 * 9.81 * at**2 / 2, atol=1e-15)
    assert (trajectory.position[:, 2] == 0.05).all()


@pytest.mark.parametrize(
    ("plane", "printed"), [(Plane(0.5), 0.286), (Plane(0.5, "corners"), 0.152), (Plane(0.5, "corners", "balanced"), 0.152)]
)
def test_a_pure_spin_stops_evenly(plane: Plane, printed: float) -> None:
    scene = lying(BRICK, (0.0, 0.0), -10.0, plane)
    time, x, y, turn = stopping(scene)
    # Printed with three decimals. The rest is a closed form: some roundings.
    assert time == pytest.approx(printed, abs=5e-4)
    torque = friction(scene.body, plane, 9.81)(0.0, 0.0, -10.0)[2]
    assert time == pytest.approx(10 / (torque / scene.body.moments[2]), rel=1e-15, abs=0)
    assert turn == pytest.approx(-10 * time / 2, rel=1e-15, abs=0)
    assert (x, y) == (0, 0)


def test_the_decoupled_law_brakes_each_for_itself() -> None:
    """The book's own motion, corrected."""
    together = stopping(lying(BRICK, (2.0, 0.0), 10.0, Plane(0.5, "decoupled")))
    straight = stopping(lying(BRICK, (2.0, 0.0), 0.0, Plane(0.5)))
    spin = stopping(lying(BRICK, (0.0, 0.0), 10.0, Plane(0.5)))
    assert together == (max(straight[0], spin[0]), straight[1], 0, spin[3])


@pytest.mark.parametrize("law", ["area", "corners", "decoupled"])
def test_at_rest_stays_at_rest(law: str) -> None:
    scene = lying(BRICK, (0.0, 0.0), 0.0, Plane(0.5, law), yaw=0.3)  # type: ignore[arg-type]
    result = slid(scene)
    assert stopping(scene) == (0, 0, 0, 0)
    for name in ("position", "velocity", "angular_velocity"):
        assert (getattr(result.trajectory, name) == getattr(scene.initial, name)).all()


@pytest.mark.parametrize(("friction", "gravity"), [(0.0, 9.81), (0.5, 0.0)])
def test_nothing_brakes_without_friction_or_load(friction: float, gravity: float) -> None:
    scene = lying(BRICK, (1.0, 2.0), 3.0, Plane(friction), gravity)
    result = slid(scene)
    assert result.stop is None
    np.testing.assert_array_equal(result.trajectory.velocity, np.tile([1, 2, 0], (len(TIMES), 1)))
    # The same sums and angles: some roundings.
    np.testing.assert_allclose(result.trajectory.position[:, 1], -0.2 + 2 * TIMES, rtol=1e-15)
    q = result.trajectory.quaternion
    turned = np.stack([np.cos(1.5 * TIMES), 0 * TIMES, 0 * TIMES, np.sin(1.5 * TIMES)], axis=-1)
    np.testing.assert_allclose(geodesic_angle(q, turned), 0, atol=1e-15)


CURLING = {
    "area": lying(BRICK, (2.0, 0.3), 10.0, Plane(0.5), yaw=0.4),
    "area, balanced": lying(BRICK, (2.0, 0.3), 10.0, Plane(0.5, "area", "balanced")),
    "corners": lying(BRICK, (2.0, 0.3), 10.0, Plane(0.5, "corners")),
    "corners, balanced": lying(BRICK, (2.0, 0.3), -10.0, Plane(0.5, "corners", "balanced")),
    "disk": lying(DISK, (2.0, 0.3), 10.0, Plane(0.5)),
    "disk, balanced": lying(DISK, (1.0, 0.3), 20.0, Plane(0.3, "area", "balanced")),
    "slow spin": lying(BRICK, (2.0, 0.3), 1e-6, Plane(0.5)),
    "slow slide": lying(DISK, (1e-6, 0.0), 10.0, Plane(0.5)),
}


@pytest.mark.parametrize("name", CURLING)
def test_a_coupled_slide(name: str) -> None:
    """Two formulations agree to the goal; energy only falls; speed and spin end at the same instant, and rest follows."""
    scene = CURLING[name]
    result = slid(scene)
    time, x, y, turn = stopping(scene)
    assert result.error[-1] < GOAL * max(1, abs(turn))
    assert result.position_error[-1] < GOAL * max(1, math.hypot(x, y))
    assert (np.diff(result.error) >= 0).all()
    assert (np.diff(result.position_error) >= 0).all()
    assert result.error[0] < 1e-14
    energy = planar_energy(scene, result)
    moving = time > TIMES
    assert (np.diff(energy[moving]) < 0).all()
    assert (energy[~moving] == 0).all()
    assert (result.trajectory.position[~moving] == result.trajectory.position[-1]).all()
    before = slide(scene, np.array([0.0, time * (1 - 1e-6)])).trajectory
    assert 0 < np.hypot(*before.velocity[-1, :2]) < 3e-5
    assert 0 < abs(before.angular_velocity[-1, 2]) < 1e-3
    assert slide(scene, TIMES[moving]).stop is None


@pytest.mark.parametrize("name", ["area", "corners, balanced", "disk"])
def test_the_energy_lost_is_the_work_of_friction(name: str) -> None:
    scene = CURLING[name]
    assert scene.plane is not None
    end = stopping(scene)[0] / 2
    nodes, weights = np.polynomial.legendre.leggauss(60)
    # Composite, because the power is not smooth where the instantaneous centre crosses an edge: 60 points in 40 parts
    # leave (1/2400)^3.
    parts = np.linspace(0, end, 41)
    times = (parts[:-1, None] + np.diff(parts)[:, None] * (1 + nodes) / 2).ravel()
    result = slide(scene, np.concatenate([[0.0], times, [end]]))
    law = friction(scene.body, scene.plane, scene.gravity)
    q, v, w = result.trajectory.quaternion, result.trajectory.velocity, result.trajectory.angular_velocity[:, 2]
    yaw = 2 * np.arctan2(q[:, 3], q[:, 0])
    body = np.cos(yaw) * v[:, 0] + np.sin(yaw) * v[:, 1], np.cos(yaw) * v[:, 1] - np.sin(yaw) * v[:, 0], w
    power = np.array([np.dot(law(*state), state) for state in np.column_stack(body).tolist()])[1:-1]
    work = float((power.reshape(40, 60) @ weights * np.diff(parts) / 2).sum())
    energy = planar_energy(scene, result)
    assert work == pytest.approx(energy[-1] - energy[0], rel=1e-10)


def ratios(footprint: Footprint, gyration: float, velocity: tuple[float, float], spin: float) -> list[float]:
    """v/(R w) of a body on a footprint of radius R = 1, where 1e-4, 1e-8, ... of the time to its stop are left.

    Friction depends on the direction of the motion alone, so that each part can begin from the last one's end, 1e4 times as
    fast, and no digits are lost.
    """
    flat = Flat(1.0, gyration, 0.5, uniform_friction(footprint, 0.5, 1.0), nearness(footprint))
    start, found = np.array([0, 0, 0, *velocity, spin]), []
    for _ in range(4):
        stop = in_log_time(flat, start, np.array([100.0]), unwatched).stop
        assert stop is not None
        row = in_log_time(flat, start, np.array([stop[0] * (1 - 1e-4)]), unwatched).rows[0]
        found.append(math.hypot(row[3], row[4]) / row[5])
        start = np.array([0, 0, row[2], *(1e4 * row[3:])])
    return found


def unwatched(_t: float, _v1: float, _v2: float, _w: float) -> None:
    """Every step is welcome."""


@pytest.mark.parametrize(("speed", "spin"), [(2.0, 1.0), (0.3, 3.0), (0.025, 1.0), (5.0, 0.4)])
def test_every_slide_of_a_disk_ends_alike(speed: float, spin: float) -> None:
    """v/(R w) = 0.653 [Farkas et al. 2003]; another distribution of mass on the same face has a ratio of its own."""
    assert ratios(Disk(1.0), math.sqrt(0.5), (speed, 0.0), spin)[-1] == pytest.approx(0.6530, abs=5e-5)
    assert ratios(Disk(1.0), math.sqrt(0.4), (speed, 0.0), spin)[-1] == pytest.approx(0.8535, abs=5e-5)


@pytest.mark.slow
def test_a_load_on_a_ring_or_on_corners_ends_otherwise() -> None:
    """They brake a slow spin more than the disk does: it dies out as v^(s/k^2), s being the mean square of the lever arms.

    Of four corners of a square at R = 1, s is 1/2 and k^2 of a homogeneous brick 1/3: the ratio v/(R w) grows without end, by
    (1e4)^(1/2) from one to the next. Of a ring with the inertia of the disk s = k^2 = 1/2: it grows more slowly than any power.
    """
    around = 2 * np.pi * np.arange(60) / 60
    ring = Points(np.column_stack([np.cos(around), np.sin(around)]))
    square = Points(rectangle(math.sqrt(0.5), math.sqrt(0.5)))
    for velocity, spin in (((2.0, 0.3), 1.0), ((0.5, 0.0), 1.0), ((0.3, 0.0), 3.0)):
        on_corners = ratios(square, math.sqrt(1 / 3), velocity, spin)
        assert on_corners[-1] / on_corners[-2] == pytest.approx(100, rel=1e-3)
        on_ring = ratios(ring, math.sqrt(0.5), velocity, spin)
        assert on_ring[-1] > on_ring[-2] > 3
        assert on_ring[-1] / on_ring[-2] < 1.3


def test_a_mirrored_slide_ends_in_the_mirror_and_a_turned_one_turned() -> None:
    scene = CURLING["area, balanced"]
    time, x, y, turn = stopping(scene)
    mirrored = lying(BRICK, (2.0, -0.3), -10.0, Plane(0.5, "area", "balanced"))
    assert stopping(mirrored) == pytest.approx((time, x, -y, -turn), rel=GOAL)
    c, s = math.cos(0.4), math.sin(0.4)
    vx, vy, _ = scene.initial.velocity
    turned = lying(BRICK, (c * vx - s * vy, s * vx + c * vy), 10.0, Plane(0.5, "area", "balanced"), yaw=0.4)
    assert stopping(turned) == pytest.approx((time, c * x - s * y, s * x + c * y, turn), rel=GOAL)


def test_a_slide_scales_with_its_length() -> None:
    """Lengths times 4, times and rates times 2 and 1/2: the same motion under the same gravity."""
    small = stopping(lying(BRICK, (2.0, 0.3), 10.0, Plane(0.5)))
    large = stopping(lying(Brick((0.4, 0.8, 0.2)), (4.0, 0.6), 5.0, Plane(0.5)))
    assert large == pytest.approx((2 * small[0], 4 * small[1], 4 * small[2], small[3]), rel=GOAL)


def test_what_the_samples_are_changes_nothing() -> None:
    scene = CURLING["corners"]
    every, some = slid(scene), slide(scene, TIMES[[0, 50, 51, 300]])
    # The steps of the integration are the same; its states are read out between them with some roundings.
    np.testing.assert_allclose(some.trajectory.position, every.trajectory.position[[0, 50, 51, 300]], atol=1e-15)
    assert every.stop == some.stop
    assert len(slide(scene, np.empty(0)).trajectory) == 0
    first = slide(scene, np.array([0.0])).trajectory
    np.testing.assert_allclose(first.velocity[0], scene.initial.velocity, rtol=1e-15)


def test_the_integration_is_as_good_as_its_tolerance(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hundredfold tolerance moves the stop by less than itself, and more than it moved before: nothing else limits it."""
    scene = CURLING["disk"]
    assert scene.plane is not None
    law = friction(scene.body, scene.plane, scene.gravity)
    flat = Flat(2.0, math.sqrt(scene.body.moments[2] / 2.0), 0.5 * 9.81, law, nearness(Disk(0.1)))
    start, end = planar_state(scene), np.array([1.5])

    def stop(motion: Motion) -> Array:
        assert motion.stop is not None
        return motion.stop

    finest = stop(in_log_time(flat, start, end, unwatched))
    # In plain time the speed has six digits where the last of the way, 1e-9 of the time, is left to be extrapolated.
    np.testing.assert_allclose(stop(in_plain_time(flat, start, end)), finest, rtol=GOAL, atol=1e-14)
    monkeypatch.setattr(coupled_motion, "LONGEST_LOG_TIME_STEP", 1.0)
    errors = []
    for tolerance in (1e-11, 1e-9, 1e-7):
        monkeypatch.setattr(integration, "RELATIVE_TOLERANCE", tolerance)
        monkeypatch.setattr(integration, "ABSOLUTE_TOLERANCE", tolerance / 20)
        errors.append(float(np.abs(stop(in_log_time(flat, start, end, unwatched)) - finest).max()))
        assert errors[-1] < tolerance
    assert errors == sorted(errors)
    assert errors[0] < 1e-2 * errors[-1]


def test_a_body_that_would_tip_is_refused_with_the_instant() -> None:
    for spin in (0.0, 10.0):
        with pytest.raises(WouldTip, match="would tip"):
            slide(lying(BRICK, (2.0, 0.0), spin, Plane(0.9, "area", "balanced")), TIMES)
    # It slides along its long side first, and turns.
    late = lying(Brick((0.05, 0.4, 0.04)), (2.0, 0.0), 4.0, Plane(0.8, "area", "balanced"), yaw=math.pi / 2)
    with pytest.raises(WouldTip, match=r"at t = 0\.19[0-9]+ s .*would tip"):
        slide(late, TIMES)


def test_a_corner_that_comes_to_rest_first_is_refused_by_name() -> None:
    """The heavily loaded corner of a body on the verge of tipping holds, and the body turns about it."""
    shape = Brick((0.38502356286383727, 0.10206740428137429, 0.09753659324406595))
    scene = lying(shape, (0.7, 0.6), 33.25, Plane(0.5449677778602603, "corners", "balanced"))
    with pytest.raises(OutOfReach, match=r"one point of the body comes to rest at t = .* while others slide"):
        slide(scene, np.array([30.0]))


FLAT = lying(BRICK, (1.0, 0.0), 1.0, Plane(0.5))


@pytest.mark.parametrize(
    ("scene", "complaint"),
    [
        (replace(FLAT, plane=None), "no plane"),
        (replace(FLAT, body=Body(1.0, (1.0, 1.0, 1.0), Sphere(0.05))), "sphere has no face"),
        (replace(FLAT, body=Body(1.0, (1.0, 1.0, 1.0))), "without a shape has no face"),
        (replace(FLAT, initial=replace(FLAT.initial, position=(0, 0, 0.051))), r"0\.051 m above the plane instead of 0\.05 m"),
        (replace(FLAT, initial=replace(FLAT.initial, quaternion=(0.0, 1.0, 0.0, 0.0))), r"3\.14 rad from the vertical"),
        (replace(FLAT, initial=replace(FLAT.initial, velocity=(1.0, 0.0, -0.1))), r"moves vertically at -0\.1 m/s"),
        (replace(FLAT, initial=replace(FLAT.initial, angular_velocity=(0.3, 0.4, 1.0))), r"other axes than K at 0\.5 rad/s"),
        (lying(DISK, (1.0, 0.0), 1.0, Plane(0.5, "corners")), "a cylinder has no corners"),
    ],
)
def test_a_body_that_does_not_lie_flat_is_refused_by_name(scene: Scene, complaint: str) -> None:
    with pytest.raises(NotFlat, match=complaint):
        slide(scene, TIMES)


def test_the_truth_names_what_it_does_not_model_of_a_body_that_lies_flat() -> None:
    with pytest.raises(NotModelled, match="a cylinder has no corners"):
        truth(lying(DISK, (1.0, 0.0), 0.0, Plane(0.5, "corners")), TIMES)


def test_friction_so_strong_that_its_square_overflows_has_a_truth() -> None:
    """A wide face on a body of a small moment, whose deceleration of the spin is 1e199 rad/s^2."""
    flat = lying(Brick((1e90, 1e90, 0.05)), (1e-50, 0.0), 0.0, Plane(1e100, "decoupled"))
    scene = replace(flat, body=replace(flat.body, moments=(1e-16, 1e-16, 1e-16)))
    with warnings.catch_warnings(action="error"):
        found = truth(scene, TIMES)
    assert found.stop is not None


def test_a_balanced_load_means_nothing_to_the_decoupled_law() -> None:
    with pytest.raises(ValueError, match="balanced load has no meaning"):
        slide(replace(FLAT, plane=Plane(0.5, "decoupled", "balanced")), TIMES)


def test_the_attitude_is_the_initial_one_turned_about_the_vertical() -> None:
    """Even one that is off the vertical by the rounding of a case file, whatever its angles are called."""
    q = quaternion_from_euler(np.array(0.7), np.array(1e-13), np.array(-0.3))
    scene = replace(FLAT, initial=replace(FLAT.initial, quaternion=tuple(q.tolist())))
    result = slid(scene)
    assert result.stop is not None
    expected = quaternion_from_euler(np.array(result.stop.yaw), np.array(0.0), np.array(0.0))
    np.testing.assert_allclose(geodesic_angle(result.trajectory.quaternion[-1], expected), 0, atol=2e-13)
    np.testing.assert_allclose(result.trajectory.quaternion[0], q, atol=1e-16)
