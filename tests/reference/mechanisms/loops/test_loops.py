"""Mechanisms with loops: two ways of different equations, closed forms, singular positions, and every type of joint."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import MP, Wide
from bodycheck.reference.integration.collocation import integrate
from bodycheck.reference.mechanisms import kinematics, observables
from bodycheck.reference.mechanisms.forms import pendulum
from bodycheck.reference.mechanisms.loops import body_equations, body_space, joint_space, ways
from bodycheck.reference.mechanisms.loops.minimum_norm import solved
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.ways import apart
from tests.support.linkages import closed_spatially, four_bar, n_four_bar, slider_crank


@pytest.mark.parametrize(
    ("mechanism", "end", "limit"),
    [(slider_crank(), 0.5, 1e-14), (four_bar(), 0.6, 1e-14), (closed_spatially(), 0.1, 1e-14)],
    ids=["slider-crank", "four-bar", "all joints"],
)
def test_two_ways_agree(mechanism: Mechanism, end: float, limit: float) -> None:
    times = np.linspace(0, end, 4)
    found, witness = ways.way(mechanism, times), ways.witness(mechanism, times)
    off = apart(mechanism, found.motion, witness.motion)
    # The numbers of the file close the loops to some 1e-16, which the two ways take in different ways.
    assert max(values.max() for values in off.values()) < limit
    assert all(values[-1] > 0 for values in off.values())  # they are two ways indeed
    assert found.errors["error"].max() < 1e-13
    assert kinematics.gaps(mechanism, _narrow(found)).max() < 2e-15


def _narrow(way: ways.Way) -> kinematics.Trajectory:
    bodies = way.motion.bodies
    parts = (bodies.position, bodies.quaternion, bodies.velocity, bodies.angular_velocity)
    return kinematics.Trajectory(bodies.t, *(part.astype(float) for part in parts))


def test_energy_is_conserved() -> None:
    mechanism = four_bar()
    seen = observables.observe(mechanism, _narrow(ways.way(mechanism, np.linspace(0, 1.5, 16))))
    # Some roundings of energies of 60 J in double precision.
    assert np.ptp(seen.total_energy) < 1e-12
    assert np.ptp(seen.kinetic_energy) > 1


def test_a_four_bar_steps_over_its_singular_position() -> None:
    """A02 with N = 2 until 1.4 s: at 0.71 s all bars lie in a line, where the linkage could also fold."""
    mechanism, times = n_four_bar(2), np.array([0.5, 0.75, 1.0, 1.4])
    found = ways.way(mechanism, times)
    inertia, weight = MP.mpf(3) / 3 + 2, (MP.mpf(3) / 2 + 2) * MP.mpf(mechanism.gravity)
    single = pendulum.Pendulum(weight / inertia, -MP.pi / 2, MP.mpf(mechanism.joints[0].start[0]), MP.mpf(-1))
    expected = pendulum.follow(single, times)
    assert expected.position[0, 0] > 0 > expected.position[1, 0]
    # Rounding in 80 bits, which the singular position multiplies by some hundreds.
    assert np.abs(found.motion.position[:, :3] - expected.position).max() < 1e-15
    assert np.abs(found.motion.velocity[:, 3:] + expected.velocity).max() < 1e-14
    assert np.all(found.errors["error"] >= np.abs(found.motion.position[:, :3] - expected.position).max(axis=1))


def test_the_constraints_of_bodies_do_not_drift() -> None:
    mechanism = slider_crank()
    system, start = body_space.system(mechanism), body_space.initial(mechanism)
    end = integrate(
        lambda states: body_equations.derivatives(system, states), start, np.array([0.3]), stages=16, first=0.05, most=400
    )
    # The file closes the loop to some 1e-16, and nothing is projected.
    assert float(body_equations.gaps(system, end.states)[0]) < 1e-15


def test_redundant_constraints_have_multipliers_of_minimum_norm() -> None:
    random = np.random.default_rng(3)
    root, rows = random.normal(size=(1, 4, 4)), random.normal(size=(1, 3, 4))
    mass, doubled = (
        root @ np.swapaxes(root, 1, 2) + np.eye(4),
        np.concatenate([rows[:, :2], rows[:, :1] * 0, rows[:, :2]], axis=1),
    )
    force, target = random.normal(size=(1, 4)), np.array([[0.3, -0.2, 0.0, 0.3, -0.2]])
    accelerations, multipliers = (part[0] for part in solved(*(each.astype(Wide) for each in (mass, doubled, force, target))))
    inverse = np.linalg.inv(mass[0])
    expected = np.linalg.pinv(doubled[0] @ inverse @ doubled[0].T) @ (doubled[0] @ inverse @ force[0] - target[0])
    # Rounding in doubles, divided by the proximal number 1e-11, is left in the directions in which multipliers have no effect.
    assert multipliers.astype(float) == pytest.approx(expected, abs=1e-3)
    # The residuals are those of the wide type.
    assert np.abs(mass[0] @ accelerations + doubled[0].T @ multipliers - force[0]).max() < 1e-17
    assert np.abs(doubled[0] @ accelerations - target[0]).max() < 1e-17


def test_collocation_is_exact_to_rounding() -> None:
    times = np.linspace(0, 5, 11)
    found = integrate(
        lambda y: np.stack([y[:, 1], -9 * np.sin(y[:, 0])], axis=1),
        np.array([2, 0], dtype=Wide),
        times,
        stages=20,
        first=0.1,
        most=1000,
    )
    single = pendulum.Pendulum(MP.mpf(9), MP.mpf(0), MP.mpf(2), MP.mpf(0))
    off = np.abs(found.states[:, 0] - pendulum.follow(single, times).position[:, 0])
    # An error grows by no more than some ten times over three swings.
    assert np.all(off <= 10 * found.errors + 1e-19)
    assert off.max() < 1e-16


def test_what_cannot_be_followed_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    made = slider_crank()
    rubbing = replace(made, joints=(replace(made.joints[0], friction=0.1), *made.joints[1:]))
    for way in (ways.way, ways.witness):
        with pytest.raises(NotModelled, match="dry friction in a mechanism with loops"):
            way(rubbing, np.array([0.1]))
    monkeypatch.setattr(ways, "MOST_SECONDS", 0.3)
    with pytest.raises(OutOfReach, match="evaluations of its equations"):
        ways.way(made, np.array([0.1, 1e5]))


def test_the_start_is_read_twice_alike() -> None:
    """The two borders agree on the poses of every body to the wide type."""
    mechanism = closed_spatially()
    tree, system = joint_space.tree(mechanism), body_space.system(mechanism)
    one = joint_space.bodies(tree, joint_space.initial(mechanism)[None])
    other = body_equations.unpacked(system, body_space.initial(mechanism)[None])
    assert np.abs(one[0][:, 0] - other.position[0]).max() < 1e-18
    assert np.abs(one[2][:, 0] - other.velocity[0]).max() < 1e-18
