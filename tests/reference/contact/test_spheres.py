"""Two spheres that hit each other: known closed forms, limits, what impacts conserve, and the second way."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck.reference.bounds import STATES
from bodycheck.reference.certificate import certify
from bodycheck.reference.contact.spheres import collision, course, way
from bodycheck.reference.contact.ways import finite
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.rotations import dot, minus, scaled
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import Mechanism, PairContact
from bodycheck.reference.mechanisms.observables import observe
from bodycheck.reference.scene import Plane, Tensor, Vector
from bodycheck.reference.truth import computed, truth
from bodycheck.reference.witness import as_way, contradictions, event_distances
from tests.support.spheres import moved, pair, random_pair, sphere

TIMES = np.linspace(0.0, 1.5, 16)

#: The number of random scenes in the default suite, and in all.
FEW, MANY = 6, 300

#: A few roundings of numbers of size 1, and of sums of a few of them.
ROUNDED = 1e-14

#: Two spheres that hit each other beside the centre, with spin.
OBLIQUE = pair(
    sphere("first", (-0.5, 0.06, 0.0), (1.0, 0.0, 0.0), (1.0, -3.0, 20.0)),
    sphere("second", (0.3, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 5.0, 4.0), radius=0.15, mass=2.0),
    0.2,
    0.7,
)


def after(scene: Mechanism) -> tuple[Any, Any, Any, Any]:
    """Velocities and angular velocities (world) of both spheres at the end, when they have hit each other once."""
    motion = moved(scene)
    spins = rotate(motion.quaternion, motion.angular_velocity)
    return motion.velocity[0, -1], motion.velocity[1, -1], spins[0, -1], spins[1, -1]


def head_on(restitution: float, masses: tuple[float, float] = (1.0, 3.0), friction: float = 0.5) -> Mechanism:
    first = sphere("first", (-0.5, 0.0, 0.0), (1.0, 0.0, 0.0), mass=masses[0])
    return pair(first, sphere("second", (0.3, 0.0, 0.0), mass=masses[1]), friction, restitution)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("masses", [(1.0, 1.0), (1.0, 3.0), (2.5, 0.17)])
def test_head_on_impacts_follow_the_known_velocities(restitution: float, masses: tuple[float, float]) -> None:
    one, other, *spins = after(head_on(restitution, masses))
    m, n = masses
    assert one == pytest.approx([(m - restitution * n) / (m + n), 0, 0], abs=ROUNDED)
    assert other == pytest.approx([(1 + restitution) * m / (m + n), 0, 0], abs=ROUNDED)
    assert not np.any(spins)


def test_the_impact_is_when_the_distance_is_the_sum_of_the_radii() -> None:
    events = truth(head_on(0.5), TIMES).events
    assert [(event.kind, event.body, event.other) for event in events] == [("impact", 0, 1), ("impact", 1, 0)]
    assert events[0].time == events[1].time == pytest.approx(0.6, rel=1e-15)
    assert events[0].normal_speed == 1.0
    assert not events[0].ends_flight


@pytest.mark.parametrize("offset", [0.199999999, 0.19])
def test_spheres_that_graze_each_other_hit_and_those_that_only_touch_do_not(offset: float) -> None:
    grazing = pair(sphere("first", (-0.5, offset, 0.0), (1.0, 0.0, 0.0)), sphere("second", (0.3, 0.0, 0.0)), 0.5, 0.5)
    (hit, _) = truth(grazing, TIMES).events
    # The line of centres has the sine offset / 0.2.
    assert hit.normal_speed == pytest.approx(math.sqrt(1 - (offset / 0.2) ** 2), rel=1e-6)
    touching = pair(sphere("first", (-0.5, 0.25, 0.0), (1.0, 0.0, 0.0), radius=0.125), grazing.bodies[1], 0.5, 0.5)
    touching = replace(touching, bodies=(touching.bodies[0], sphere("second", (0.3, 0.0, 0.0), radius=0.125)))
    assert truth(touching, TIMES).events == ()
    assert moved(touching).velocity[0, -1].tolist() == [1.0, 0.0, 0.0]


def test_without_friction_no_spin_changes() -> None:
    scene = replace(OBLIQUE, contacts=(PairContact((0, 1), 0.0, 0.7),))
    *_, first, second = after(scene)
    assert first == pytest.approx([1.0, -3.0, 20.0], rel=ROUNDED)
    assert second == pytest.approx([0.0, 5.0, 4.0], rel=ROUNDED, abs=ROUNDED)


def slip_of(scene: Mechanism) -> tuple[Any, Any, Any]:
    """The normal at the impact, the slip just after it, and the impulse on the second sphere over its mass (m/s)."""
    (hit, other), motion = truth(scene, TIMES).events, moved(scene)
    normal = (np.array(other.position) - hit.position) / np.linalg.norm(np.array(other.position) - hit.position)
    radii = [body.inertia.shape.radius for body in scene.bodies]  # type: ignore[union-attr]
    turning = radii[0] * np.array(hit.spin) + radii[1] * np.array(other.spin)
    relative = np.array(hit.velocity) - other.velocity + np.cross(turning, normal)
    return normal, relative - (relative @ normal) * normal, motion.velocity[1, -1] - motion.velocity[1, 0]


def test_enough_friction_ends_the_slip_and_less_exerts_its_largest_force() -> None:
    _, slip, _ = slip_of(replace(OBLIQUE, contacts=(PairContact((0, 1), 5.0, 0.7),)))
    assert np.linalg.norm(slip) < ROUNDED
    normal, slip, impulse = slip_of(OBLIQUE)
    along = float(impulse @ normal)
    across = impulse - along * normal
    assert np.linalg.norm(across) == pytest.approx(0.2 * along, rel=ROUNDED)
    assert float(across @ slip) == pytest.approx(float(np.linalg.norm(across) * np.linalg.norm(slip)), rel=ROUNDED)


def test_no_slip_is_a_friction_that_is_large_enough_and_engines_get_twice_that() -> None:
    endless = replace(OBLIQUE, contacts=(PairContact((0, 1), math.inf, 0.7),))
    assert (
        moved(endless).velocity.tolist() == moved(replace(OBLIQUE, contacts=(PairContact((0, 1), 9.0, 0.7),))).velocity.tolist()
    )
    given_friction = finite(endless, 1.5).contacts[0].friction  # type: ignore[union-attr]
    assert given_friction == pytest.approx(2 * truth(endless, TIMES).friction)
    assert np.linalg.norm(slip_of(replace(OBLIQUE, contacts=(PairContact((0, 1), given_friction / 2, 0.7),)))[1]) < ROUNDED


@given(st.integers(0, 10**6))
@settings(max_examples=8, deadline=None)
def test_impacts_in_space_keep_momenta_and_gain_no_energy(seed: int) -> None:
    scene = replace(random_pair(3 * seed), gravity=0.0)
    seen = observe(scene, moved(scene))
    size = float(np.abs(seen.kinetic_energy).max())
    for momenta in (seen.momentum, seen.angular_momentum):
        assert np.abs(momenta - momenta[0]).max() < 100 * ROUNDED * (1 + size)
    assert np.diff(seen.kinetic_energy).max() < 100 * ROUNDED * size
    elastic = replace(scene, contacts=(PairContact((0, 1), 0.0, 1.0),))
    energy = observe(elastic, moved(elastic)).kinetic_energy
    assert np.ptp(energy) < 100 * ROUNDED * size


def test_gravity_moves_both_spheres_alike() -> None:
    falling, floating = moved(replace(OBLIQUE, gravity=9.81)), moved(OBLIQUE)
    fall = np.outer(TIMES**2, [0.0, 0.0, -9.81 / 2])
    assert np.abs(falling.position - floating.position - fall).max() < 10 * ROUNDED
    assert np.abs(falling.angular_velocity - floating.angular_velocity).max() < 10 * ROUNDED


def test_the_order_of_the_spheres_does_not_matter() -> None:
    one, other = moved(OBLIQUE), moved(replace(OBLIQUE, bodies=OBLIQUE.bodies[::-1]))
    assert np.abs(one.position - other.position[::-1]).max() < ROUNDED
    assert np.abs(one.angular_velocity - other.angular_velocity[::-1]).max() < 20 * ROUNDED


def test_spheres_that_touch_at_the_start_hit_at_once_if_they_approach() -> None:
    first, second = sphere("first", (-0.1, 0.0, 0.0), (1.0, 0.0, 0.0)), sphere("second", (0.1, 0.0, 0.0))
    motion = moved(pair(first, second, 0.3, 1.0))
    assert motion.velocity[0, :2].tolist() == [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    parting = sphere("first", (-0.1, 0.0, 0.0), (-1.0, 0.0, 0.0))
    assert truth(pair(parting, second, 0.3, 1.0), TIMES).events == ()


def test_a_hollow_sphere_takes_less_spin() -> None:
    """Friction that ends the slip exerts the slip over 2 (1/m + r^2/I): 1/7 of it, or 1/5 if the spheres are hollow."""
    for factor, part in ((2 / 5, 7), (2 / 3, 5)):
        bodies = []
        for body in pair(
            sphere("first", (-0.5, 0.06, 0.0), (1.0, 0.0, 0.0)), sphere("second", (0.3, 0.0, 0.0)), 5.0, 0.7
        ).bodies:
            moment, solid = factor * 0.01, body.inertia
            rows = (moment, 0.0, 0.0), (0.0, moment, 0.0), (0.0, 0.0, moment)
            bodies.append(replace(body, inertia=Tensor(1.0, rows), shape=solid.shape))  # type: ignore[union-attr]
        scene = pair(bodies[0], bodies[1], 5.0, 0.7)
        motion = moved(scene)
        (hit, other) = truth(scene, TIMES).events
        normal = (np.array(other.position) - hit.position) / 0.2
        impulse = motion.velocity[1, -1]
        across = impulse - (impulse @ normal) * normal
        assert np.linalg.norm(across) == pytest.approx(0.3 / part, rel=1e-12)


def on_plane(spin: Vector = (0.0, 0.0, 0.0), friction: float = 0.0, radius: float = 0.1, restitution: float = 0.5) -> Mechanism:
    first = sphere("first", (-0.5, 0.0, radius), (1.0, 0.0, 0.0), spin, radius=radius)
    return pair(first, sphere("second", (0.3, 0.0, 0.1)), friction, restitution, 9.81, Plane(0.2))


def test_a_rolling_ball_that_hits_a_resting_one_follows_it() -> None:
    """With e = 1 they exchange velocities; then 2/7 of the velocity is left to the first, and 5/7 to the second."""
    motion = moved(on_plane((0.0, 10.0, 0.0), restitution=1.0), 3.0)
    assert motion.velocity[0, -1] == pytest.approx([2 / 7, 0, 0], abs=ROUNDED)
    assert motion.velocity[1, -1] == pytest.approx([5 / 7, 0, 0], abs=ROUNDED)
    kinds = [event.kind for event in truth(on_plane((0.0, 10.0, 0.0), restitution=1.0), np.array([0.0, 3.0])).events]
    assert kinds == ["impact", "impact", "slip", "slip", "roll", "roll"]


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        (on_plane((0.0, 10.0, 0.0), friction=0.3), "presses on it in an impact"),
        (on_plane(radius=0.15), "presses on it in an impact"),
        (on_plane((0.0, 10.0, 0.0), restitution=0.0), "stay in touch and press"),
        (pair(sphere("first", (0.0, 0.0, 0.0)), sphere("second", (0.1, 0.0, 0.0)), 0.3, 0.5), "overlap"),
        (replace(OBLIQUE, bodies=(*OBLIQUE.bodies, sphere("third", (5.0, 0.0, 0.0)))), "such a motion"),
    ],
)
def test_motions_that_the_laws_do_not_determine_are_refused(scene: Mechanism, reason: str) -> None:
    with pytest.raises(NotModelled, match=reason):
        truth(scene, TIMES)


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=pytest.mark.slow) if seed >= FEW else seed for seed in range(MANY)])
def test_both_ways_agree_within_their_bounds(seed: int) -> None:
    scene = random_pair(seed)
    try:
        both = computed(scene, TIMES)
    except NotModelled:  # of an impact in which the plane bears a part
        if scene.plane is None:
            raise
        return
    (second,) = both.witnesses
    first = as_way("", both.truth.trajectory, both.own_bounds, both.own_events)
    assert not any(apart.any() for apart in contradictions(first, second).values())
    assert first.events is not None
    assert second.events is not None
    assert not any(event_distances(first.events, second.events, TIMES[-1]))
    assert not any(event_distances(second.events, first.events, TIMES[-1]))
    assert all((getattr(both.truth.bounds, name) == getattr(both.own_bounds, name)).all() for name in STATES)


def friction_along_the_slip(patch: pytest.MonkeyPatch) -> None:
    right = collision._impulse

    def wrong(velocity: Any, normal: Any, *others: Any) -> Any:
        impulse = right(velocity, normal, *others)
        along = scaled(dot(impulse.on_first, normal), normal)
        return replace(impulse, on_first=minus(scaled(2, along), impulse.on_first))

    patch.setattr(collision, "_impulse", wrong)


def moment_of_a_shell(patch: pytest.MonkeyPatch) -> None:
    right = way.ball

    def hollow(scene: Mechanism, index: int) -> Any:
        solid: Any = right(scene, index)
        return replace(solid, moment=solid.moment * 5 / 3)

    patch.setattr(way, "ball", hollow)


def bouncier(patch: pytest.MonkeyPatch) -> None:
    right = collision.between
    patch.setattr(
        collision, "between", lambda both, moving, law: right(both, moving, replace(law, restitution=law.restitution + 1e-6))
    )


def late(patch: pytest.MonkeyPatch) -> None:
    right = course.next_touch
    patch.setattr(course, "next_touch", lambda *given, **how: right(*given, **how) + 1e-9)


@pytest.mark.parametrize("plant", [friction_along_the_slip, moment_of_a_shell, bouncier, late])
def test_the_bounds_grow_to_the_size_of_a_planted_fault(plant: Callable[[pytest.MonkeyPatch], None]) -> None:
    right = truth(OBLIQUE, TIMES)
    with pytest.MonkeyPatch.context() as patch:
        plant(patch)
        wrong, certificate = computed(OBLIQUE, TIMES).truth, certify(OBLIQUE, TIMES)
    largest = 0.0
    for name in ("position", "velocity", "angular_velocity"):
        off = np.linalg.norm(getattr(wrong.trajectory, name) - getattr(right.trajectory, name), axis=-1).max(axis=0)
        assert (off <= getattr(wrong.bounds, f"{name}_error") + getattr(right.bounds, f"{name}_error")).all()
        largest = max(largest, float(off.max()))
    assert largest > 1e-10
    assert certificate.faults
