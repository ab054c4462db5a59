"""Figures of bodies that touch, of planted motions whose figures are known by hand."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters.method import Method
from bodycheck.figures.columns import FIGURES
from bodycheck.figures.definition import InterfaceLoad
from bodycheck.judging.discrepancy import compare
from bodycheck.reference.bounds import Bounds
from bodycheck.reference.contact.motion import Event, Interface
from bodycheck.reference.mechanisms.mechanism import WORLD
from bodycheck.reference.scene import Body, Brick, Plane, Push, Scene, Sphere, State, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run
from tests.support.coins import rolling

G, RADIUS = 9.81, 0.1
BALL = Body(1.0, (0.004, 0.004, 0.004), Sphere(RADIUS))
BOX = Body(2.0, (0.02, 0.02, 0.02), Brick((0.1, 0.1, 0.1)))
METHOD = Method("step", 1e-3)


def states(
    t: Array,
    position: Sequence[Array | float],
    velocity: Sequence[Array | float],
    spin: Sequence[Array | float] = (0.0, 0.0, 0.0),
    quaternion: Sequence[Array | float] = (1.0, 0.0, 0.0, 0.0),
) -> Trajectory:
    """States of a body from their components, each (n,) or the same at all instants."""
    zero = np.zeros_like(t)
    p, v, w, q = (np.stack([zero + one for one in each], axis=1) for each in (position, velocity, spin, quaternion))
    return Trajectory(t, p, q, v, w)


def made(scene: Scene, motion: Trajectory, events: tuple[Event, ...] = (), interfaces: tuple[Interface, ...] = ()) -> Truth:
    bounds = Bounds(*[np.where(np.isnan(motion.position[:, 0]), np.nan, 1e-14)] * 6)
    return Truth(scene, motion, bounds, "made up", "made up", "none", events=events, interfaces=interfaces)


def figures(truth: Truth, motion: Trajectory, interfaces: tuple[InterfaceLoad, ...] | None = None) -> dict[str, float]:
    outcome = Completed(motion, len(motion), 1.0, interfaces=interfaces)
    return compare(truth, Run("planted", "engine", "1", METHOD, outcome)).maxima()


def event(kind: str, time: float, velocity: Vector = (0.0, 0.0, 0.0), normal_speed: float = 0.0) -> Event:
    return Event(kind, time, 1e-15, 0, (0.0, 0.0, 0.0), velocity, (0.0, 0.0, 0.0), normal_speed)  # type: ignore[arg-type]


def bouncing(t: Array, height: float, ratio: float, late: float = 0.0) -> tuple[Array, Array, list[tuple[float, float]]]:
    """Height above the plane and speed of a ball that is dropped, and when and how fast it comes down.

    late: how long it is stuck at the first impact (s).
    """
    fall = math.sqrt(2 * height / G)
    hits = [(fall, G * fall)]
    z, u = height - G * t**2 / 2, -G * t
    begin, speed = fall + late, ratio * G * fall
    z, u = np.where(t >= fall, 0.0, z), np.where(t >= fall, 0.0, u)
    while speed > 1e-12 and begin < t[-1]:
        flight = 2 * speed / G
        inside = (t >= begin) & (t < begin + flight)
        since = t - begin
        z, u = np.where(inside, speed * since - G * since**2 / 2, z), np.where(inside, speed - G * since, u)
        begin += flight
        hits.append((begin, speed))
        speed *= ratio
    return z, u, hits


def dropped(height: float = 1.0, ratio: float = 0.6, samples: int = 301, last: float = 3.0) -> Truth:
    """The truth of a ball that is dropped."""
    t = np.linspace(0, last, samples)
    z, u, hits = bouncing(t, height, ratio)
    events = [event("impact", time, (0.0, 0.0, ratio * speed), speed) for time, speed in hits if time < last]
    settled = hits[0][0] * (1 + ratio) / (1 - ratio) if ratio < 1 else math.inf
    ending = (event("rest", settled),) if settled < last else ()
    scene = Scene(BALL, State((0.0, 0.0, RADIUS + height)), G, Plane(0.5, restitution=ratio))
    return made(scene, states(t, (0.0, 0.0, RADIUS + z), (0.0, 0.0, u)), (*events, *ending))


@pytest.mark.parametrize("samples", [61, 301, 3001])
@pytest.mark.parametrize("ratio", [0.3, 0.6, 0.9, 1.0])
def test_a_truth_measured_as_a_run_has_no_errors(samples: int, ratio: float) -> None:
    exact = dropped(ratio=ratio, samples=samples)
    found = figures(exact, exact.trajectory)
    # Instants are found from the arcs on either side, but for rounding, even at 20 samples a second.
    assert found["impact_time_error"] < 1e-14
    assert found.get("bounce_ratio_error", 0.0) < 1e-12
    assert found.get("impact_speed_error", 0.0) < 1e-12
    assert found.get("rest_time_error", 0.0) < 1e-12
    assert found["velocity_error"] == found["position_error"] == 0
    assert found["energy_gain"] < 1e-13
    # At 0.3 and 20 samples a second, the second bounce lasts less than two samples, but the first does not.
    assert "impact_speed_error" in found
    assert ("rest_time_error" in found) == (ratio in (0.3, 0.6))


@pytest.mark.parametrize("late", [1e-4, 0.013])
def test_a_late_impact_is_late_and_its_velocities_are_not_compared_before_it(late: float) -> None:
    """A ball that stays on the plane for a while: its arcs meet below the plane, before it leaves."""
    exact = dropped(ratio=0.6)
    t = exact.trajectory.t
    z, u, hits = bouncing(t, 1.0, 0.6, late)
    found = figures(exact, states(t, (0.0, 0.0, RADIUS + z), (0.0, 0.0, u)))
    # The arcs -v s - g s^2/2 and e v (s - late) - g (s - late)^2/2 meet at this s.
    speed = hits[0][1]
    meet = (0.6 * speed * late + G * late**2 / 2) / (1.6 * speed + G * late)
    assert found["impact_time_error"] == pytest.approx(meet, rel=1e-9)
    # Of some 4 m/s that velocities differ by between the two impacts, nothing is an error: the rest is g times the delay.
    assert found["velocity_error"] < 1.01 * G * late
    # Both bounces fall from the same height, but the second arc is later.
    assert found["position_error"] < 5 * late


def test_a_ratio_that_is_off_is_measured() -> None:
    exact = dropped(ratio=0.6)
    z, u, _ = bouncing(exact.trajectory.t, 1.0, 0.61)
    found = figures(exact, states(exact.trajectory.t, (0.0, 0.0, RADIUS + z), (0.0, 0.0, u)))
    assert found["bounce_ratio_error"] == pytest.approx(0.01, rel=1e-9)
    assert found["impact_speed_error"] == pytest.approx(0.01 * math.sqrt(2 * G), rel=1e-9)
    assert found["rest_time_error"] == pytest.approx(math.sqrt(2 / G) * (1.61 / 0.39 - 1.6 / 0.4), rel=1e-9)


def test_a_run_that_does_not_bounce_has_no_ratio_left() -> None:
    exact = dropped(ratio=0.6)
    z, u, _ = bouncing(exact.trajectory.t, 1.0, 0.0)
    found = figures(exact, states(exact.trajectory.t, (0.0, 0.0, RADIUS + z), (0.0, 0.0, u)))
    assert found["bounce_ratio_error"] == pytest.approx(0.6, rel=1e-12)
    assert found["impact_speed_error"] == pytest.approx(0.6 * math.sqrt(2 * G), rel=1e-9)
    assert found["impact_time_error"] < 1e-14
    assert found["rest_time_error"] == pytest.approx(math.sqrt(2 / G) * 3, abs=0.011)  # a sample, 0.01 s


def test_what_is_too_coarse_to_measure_is_empty() -> None:
    exact = dropped(height=0.02, ratio=0.3, samples=16, last=3.0)
    found = figures(exact, exact.trajectory)
    assert not {"bounce_ratio_error", "impact_speed_error"} & set(found)


def test_an_engine_one_step_late_without_a_bounce_is_not_wrong_by_metres_per_second() -> None:
    exact = dropped(ratio=0.0)
    t = exact.trajectory.t
    z, u, _ = bouncing(t, 1.0, 0.0)
    after = int(np.flatnonzero(t > math.sqrt(2 / G))[0])
    z[after], u[after] = 1.0 - G * t[after] ** 2 / 2, -G * t[after]
    found = figures(exact, states(t, (0.0, 0.0, RADIUS + z), (0.0, 0.0, u)))
    assert found["velocity_error"] < 1e-12
    assert found["penetration"] == pytest.approx(-z[after], rel=1e-12)


def test_energy_that_is_gained_at_a_bounce() -> None:
    """A ball that bounces with 1 % more energy than it has: the largest is that of the start, counted from the plane."""
    exact = dropped(ratio=1.0)
    z, u, _ = bouncing(exact.trajectory.t, 1.0, math.sqrt(1.01))
    motion = states(exact.trajectory.t, (0.0, 0.0, RADIUS + z), (0.0, 0.0, u))
    hits = int((np.array([e.time for e in exact.events]) < 0.8).sum())
    first = motion.part(motion.t < 1.3)
    assert hits == 1
    found = figures(made(exact.scene, exact.trajectory.part(motion.t < 1.3), exact.events[:1]), first)
    assert found["energy_gain"] == pytest.approx(0.01 * 1.0 / 1.1, rel=1e-9)


def test_a_push_gives_energy_and_the_rest_is_gained() -> None:
    t = np.linspace(0, 2, 41)
    push = Push((3.0, 0.0, 0.0), (0.0, 0.0, 0.05), 0.21, 1.33)
    scene = Scene(BOX, State((0.0, 0.0, 0.1)), G, Plane(0.0), pushes=(push,))

    def pushed(pull: float) -> Trajectory:
        during, after = np.clip(t - 0.21, 0, 1.12), np.maximum(t - 1.33, 0)
        return states(t, (pull * (during**2 / 2 + 1.12 * after), 0.0, 0.1), (pull * during, 0.0, 0.0))

    exact = made(scene, pushed(1.5))
    assert figures(exact, pushed(1.5))["energy_gain"] < 1e-13
    # By 1 % more of acceleration, the energy is 2.01 % more, and the work 1 %.
    size = 2.0 * (1.5 * 1.12) ** 2 / 2 + 2.0 * G * 0.1
    assert figures(exact, pushed(1.515))["energy_gain"] == pytest.approx(0.0101 * 2.0 * (1.5 * 1.12) ** 2 / 2 / size, rel=1e-6)


@pytest.mark.parametrize("incline", [0.0, 0.4])
def test_a_block_that_creeps_and_sinks_and_tilts(incline: float) -> None:
    t = np.linspace(0, 60, 61)
    half = incline / 2
    n, x = np.array([math.sin(incline), 0, math.cos(incline)]), np.array([math.cos(incline), 0, -math.sin(incline)])
    plane = Plane(0.5, incline=incline, restitution=0.1)

    def lying(creep: float, depth: float, angle: float) -> Trajectory:
        turn = (math.cos(half + angle / 2), 0.0, math.sin(half + angle / 2), 0.0)
        place = x * creep * t[:, None] + n * (0.1 - depth)
        return states(t, place.T, creep * x, quaternion=turn)

    scene = Scene(BOX, State((0.1 * n[0], 0.0, 0.1 * n[2]), (math.cos(half), 0.0, math.sin(half), 0.0)), G, plane)
    exact = made(replace(scene, pushes=(Push((0.0, 0.0, -1e-9)),)), lying(0, 0, 0), interfaces=(Interface((WORLD, 0), 19.0),))
    loads = (InterfaceLoad((WORLD, 0), 1.1 * 19.0, 7),)
    found = figures(exact, lying(1e-4, 1e-5, 0.0), loads)
    assert found["creep"] == pytest.approx(1e-4, rel=1e-9)
    assert found["penetration"] == pytest.approx(1e-5, rel=1e-9)
    assert found["tilt"] < 1e-15
    assert found["load_error"] == pytest.approx(0.1, rel=1e-12)
    assert found["contact_losses"] == 7
    assert figures(exact, lying(0.0, 0.0, 1e-3))["tilt"] == pytest.approx(1e-3, rel=1e-12)
    assert not {"load_error", "contact_losses"} & set(figures(exact, lying(0.0, 0.0, 0.0)))
    assert figures(exact, lying(0.0, 0.0, 0.0), ())["load_error"] == 1


def thrown(t: Array, friction: float, spin: float = 0.0) -> tuple[Trajectory, float]:
    """A ball that is thrown along x at 2 m/s with a spin about y (rad/s), slips and then rolls, and when it rolls."""
    slipping = 2.0 - RADIUS * spin
    rolls = slipping / (3.5 * friction * G)
    now = np.minimum(t, rolls)
    speed, rate = 2.0 - friction * G * now, spin + 2.5 * friction * G / RADIUS * now
    place = 2.0 * now - friction * G * now**2 / 2 + (2.0 - friction * G * rolls) * (t - now)
    return states(t, (place, 0.0, RADIUS), (speed, 0.0, 0.0), (0.0, rate, 0.0)), rolls


@pytest.mark.parametrize("spin", [0.0, -10.0])
def test_slip_turns_into_rolling(spin: float) -> None:
    t = np.linspace(0, 2, 81)
    scene = Scene(BALL, State((0.0, 0.0, RADIUS), velocity=(2.0, 0.0, 0.0), angular_velocity=(0.0, spin, 0.0)), G, Plane(0.2))
    motion, rolls = thrown(t, 0.2, spin)
    exact = made(scene, motion, (event("roll", rolls, (2.0 - 0.2 * G * rolls, 0.0, 0.0)),))
    found = figures(exact, motion)
    assert found["transition_time_error"] < 1e-13
    assert found["roll_speed_error"] < 1e-13
    assert not {"impact_time_error", "bounce_ratio_error", "tilt", "creep", "load_error"} & set(found)
    other, later = thrown(t, 0.19, spin)
    found = figures(exact, other)
    assert found["transition_time_error"] == pytest.approx(later - rolls, rel=1e-9)
    assert found["roll_speed_error"] < 1e-13  # whatever the friction, 5/7 of the speed is left of a ball without spin


def test_a_block_that_slides_to_rest() -> None:
    t = np.linspace(0, 2, 81)

    def slid(friction: float) -> tuple[Trajectory, float]:
        stop = 2.0 / (friction * G)
        now = np.minimum(t, stop)
        place, speed = 2.0 * now - friction * G * now**2 / 2, 2.0 - friction * G * now
        return states(t, (place, 0.0, 0.1), (speed, 0.0, 0.0)), stop

    scene = Scene(BOX, State((0, 0, 0.1), velocity=(2.0, 0, 0)), G, Plane(0.2, restitution=0.5), pushes=(Push((0, 0, 0)),))
    motion, stop = slid(0.2)
    exact = made(scene, motion, (event("rest", stop),))
    assert figures(exact, motion)["rest_time_error"] < 1e-13
    other, later = slid(0.21)
    found = figures(exact, other)
    assert found["rest_time_error"] == pytest.approx(stop - later, rel=1e-9)
    assert found["creep"] == 0


def test_a_brick_whose_motion_mechanics_does_not_give_is_judged_by_what_must_hold() -> None:
    t = np.linspace(0, 2, 41)
    none = np.full_like(t, np.nan)
    scene = Scene(BOX, State((0.0, 0.0, 0.3), (math.cos(0.2), 0.0, math.sin(0.2), 0.0)), G, Plane(0.5))
    exact = made(scene, states(t, (none,) * 3, (none,) * 3, (none,) * 3, (none,) * 4))
    height = np.where(t < 0.2, 0.3 - G * t**2 / 2, 0.1)
    turned = np.where(t < 0.2, 0.2, math.pi / 4 + 5e-4)
    drift = 1e-3 * t
    velocity = (1e-3, 0.0, np.where(t < 0.2, -G * t, 0.0))
    motion = states(t, (drift, 0.0, height), velocity, quaternion=(np.cos(turned), 0.0, np.sin(turned), 0.0))
    with np.errstate(all="raise"):
        found = figures(exact, motion)
    assert found["tilt"] == pytest.approx(1e-3, rel=1e-9)
    assert found["creep"] == pytest.approx(1e-3, rel=1e-9)
    assert found["energy_gain"] < 1e-13
    errors = {name for name, figure in FIGURES.items() if figure.bounded_by or figure.of_truth}
    assert not errors & set(found)


@pytest.mark.parametrize("scene", [rolling(1.5, (0.1, 0.5, -12.0)), rolling(0.8, (0.0, 0.0, 0.0))], ids=["rolls", "leans"])
def test_a_body_that_touches_before_its_face_or_side_hits_has_no_figures_of_impacts(scene: Scene) -> None:
    """Its centre of mass has no arcs whose end would be the impact. Its velocities are compared up to there."""
    exact = truth(scene, np.linspace(0.0, 0.3, 301))
    assert [event.kind for event in exact.events] == ["impact"]
    positions, attitudes, velocities, spins = (
        np.nan_to_num(getattr(exact.trajectory, name)) for name in ("position", "quaternion", "velocity", "angular_velocity")
    )
    wrong = Trajectory(exact.trajectory.t, positions, attitudes, velocities + np.array([0.25, 0.0, 0.0]), spins)
    measured = figures(exact, wrong)
    assert not {"impact_time_error", "impact_speed_error", "bounce_ratio_error"} & set(measured)
    assert measured["velocity_error"] == pytest.approx(0.25)


def test_figures_are_of_bodies_that_touch_alone() -> None:
    """A body in free flight, and one that lies flat on a level plane, have none of them."""
    t = np.linspace(0, 1, 11)
    motion = states(t, (t, 0.0, 0.1), (1.0, 0.0, 0.0))
    new = ("energy_gain", "impact_time_error", "rest_time_error", "load_error", "transition_time_error", "bounce_ratio_error")
    for scene in (Scene(BOX, State()), Scene(BOX, State((0, 0, 0.1), velocity=(1.0, 0, 0)), G, Plane(0.1))):
        assert not set(new) & set(figures(made(scene, motion), motion))
