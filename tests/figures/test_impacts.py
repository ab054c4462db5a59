"""Figures of what bodies exchange in impacts, of planted motions whose figures are known by hand."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters.method import Method
from bodycheck.judging.discrepancy import compare
from bodycheck.reference.mechanisms.mechanism import Mechanism, PairContact
from bodycheck.reference.scene import Plane, State
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truth import truth
from bodycheck.results.outcome import Completed, Run
from tests.support.round_bodies import ball_on
from tests.support.spheres import moved, pair, sphere

#: A sphere of 1 kg that hits one of 3 kg head-on, and one that hits another one beside the centre.
HEAD_ON = pair(sphere("first", (-0.5, 0.0, 0.0), (1.0, 0.0, 0.0)), sphere("second", (0.3, 0.0, 0.0), mass=3.0), 0.5, 0.5)
OBLIQUE = pair(sphere("first", (-0.5, 0.06, 0.0), (1.0, 0.0, 0.0)), sphere("second", (0.3, 0.0, 0.0)), 0.5, 0.8)

#: A few roundings, relative.
ROUNDED = 1e-12


def figures(scene: Mechanism, motion: Trajectory) -> dict[str, float]:
    """The figures of a run with this motion."""
    outcome = Completed(motion, len(motion), 1.0)
    return compare(truth(scene, motion.t), Run("planted", "engine", "1", Method("step", 1e-3), outcome)).maxima()


def with_law(scene: Mechanism, friction: float, restitution: float) -> Mechanism:
    return replace(scene, contacts=(PairContact((0, 1), friction, restitution),))


@pytest.mark.parametrize("scene", [HEAD_ON, OBLIQUE, replace(OBLIQUE, gravity=9.81)])
@pytest.mark.parametrize("samples", [7, 151])
def test_a_truth_measured_as_a_run_has_no_errors(scene: Mechanism, samples: int) -> None:
    measured = figures(scene, moved(scene, samples=samples))
    for name in ("impact_energy_error", "impact_momentum_error", "velocity_error"):
        assert measured[name] == 0
    assert measured["energy_gain"] < ROUNDED
    # The instant is that at which straight lines meet, of states that are rounded to doubles.
    assert measured["impact_time_error"] < ROUNDED


def test_another_restitution_is_measured() -> None:
    """The impact takes (1 - e^2) m2/(m1 + m2) of the energy, with an impulse of (1 + e) m2/(m1 + m2) of the momentum."""
    measured = figures(HEAD_ON, moved(with_law(HEAD_ON, 0.5, 0.4)))
    assert measured["impact_energy_error"] == pytest.approx((0.25 - 0.16) * 0.75, rel=ROUNDED)
    assert measured["impact_momentum_error"] == pytest.approx(0.1 * 0.75, rel=ROUNDED)


def test_friction_in_the_wrong_direction_is_measured() -> None:
    right = moved(OBLIQUE)
    first, second = truth(OBLIQUE, right.t).events
    normal = (np.array(second.position) - first.position) / 0.2
    across = right.velocity[1, -1] - (right.velocity[1, -1] @ normal) * normal
    wrong = right.velocity.copy()
    later = right.t > first.time
    wrong[1, later] -= 2 * across
    wrong[0, later] += 2 * across
    measured = figures(OBLIQUE, replace(right, velocity=wrong))
    # The impulse across the line of centres is 1/7 of the slip, 0.3 m/s, of a momentum of 1 kg m/s.
    assert measured["impact_momentum_error"] == pytest.approx(2 * 0.3 / 7, rel=1e-9)
    assert measured["impact_energy_error"] > 0.01


def test_a_run_without_the_impact_exchanges_nothing() -> None:
    t = np.linspace(0.0, 1.5, 151)
    through = moved(HEAD_ON, samples=151)
    position = through.position.copy()
    position[0, :, 0], position[1, :, 0] = -0.5 + t, 0.3
    velocity = np.zeros_like(through.velocity)
    velocity[0, :, 0] = 1.0
    measured = figures(HEAD_ON, replace(through, position=position, velocity=velocity))
    assert measured["impact_energy_error"] == pytest.approx(0.75 * 0.75, rel=ROUNDED)
    assert measured["impact_momentum_error"] == pytest.approx(1.5 * 0.75, rel=ROUNDED)


def test_velocities_are_not_compared_while_spheres_are_in_a_soft_contact() -> None:
    """A contact that lasts 0.04 s, in which the velocities change uniformly."""
    exact = moved(HEAD_ON, samples=151)
    (event, _) = truth(HEAD_ON, exact.t).events
    share = np.clip((exact.t - event.time + 0.02) / 0.04, 0.0, 1.0)[None, :, None]
    velocity = exact.velocity[:, :1] * (1 - share) + exact.velocity[:, -1:] * share
    measured = figures(HEAD_ON, replace(exact, velocity=velocity))
    assert measured["velocity_error"] < ROUNDED
    assert measured["impact_energy_error"] < ROUNDED


@pytest.mark.parametrize(("restitution", "planted"), [(0.6, 0.61), (0.6, 0.3)])
def test_impacts_on_the_plane_are_measured(restitution: float, planted: float) -> None:
    """Of its energy a ball keeps e^2, with an impulse of 1 + e of its momentum."""
    start, t = State((0.0, 0.0, 1.1)), np.linspace(0.0, 1.0, 201)
    scene, wrong = (ball_on(Plane(0.5, restitution=e), start) for e in (restitution, planted))
    measured = compare(
        truth(scene, t), Run("planted", "engine", "1", Method("step", 1e-3), Completed(truth(wrong, t).trajectory, len(t), 1.0))
    ).maxima()
    assert measured["impact_energy_error"] == pytest.approx(abs(restitution**2 - planted**2), rel=1e-9)
    assert measured["impact_momentum_error"] == pytest.approx(abs(restitution - planted), rel=1e-9)


def test_spheres_on_a_plane_have_figures_of_their_impact_alone() -> None:
    first = sphere("first", (-0.5, 0.0, 0.1), (1.0, 0.0, 0.0), (0.0, 10.0, 0.0))
    scene = pair(first, sphere("second", (0.3, 0.0, 0.1)), 0.0, 1.0, 9.81, Plane(0.2))
    exact = moved(scene, samples=151)
    measured = figures(scene, exact)
    assert measured["impact_energy_error"] == measured["impact_momentum_error"] == 0
    assert "bounce_ratio_error" not in measured
    wrong = figures(scene, moved(with_law(scene, 0.0, 0.9), samples=151))
    assert wrong["impact_momentum_error"] == pytest.approx(0.05, abs=1e-9)
