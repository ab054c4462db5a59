"""What is made of a run's states, its engine's words and the truth: synthetic motions, each wrong in one way."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import NoTruth
from bodycheck.results.outcome import Completed, Diverged, Unsupported
from bodycheck.studies.extremes.diagnosis import Diagnosis, diagnose, growth
from bodycheck.studies.extremes.study import follow
from bodycheck.studies.extremes.symptoms import flips, gyration
from tests.support.cases import shortened
from tests.support.driven_hinge import PD, hinge
from tests.support.wording import facts

CASE = shortened(load("intermediate-axis-flip"), 4.0, 401)
SCENE = CASE.scene
T = CASE.instants
TRUTH = follow(SCENE, T)
MOTION = TRUTH.trajectory


def diagnosis(motion: Trajectory) -> Diagnosis:
    return diagnose(SCENE, Completed(motion, len(T) - 1, 1.0), TRUTH)


def turned(angle: Array) -> Array:
    """Attitudes off by a turn about x."""
    return multiply(np.column_stack([np.cos(angle / 2), np.sin(angle / 2), 0 * angle, 0 * angle]), MOTION.quaternion)


def after(t: float, changed: Array, unchanged: Array) -> Array:
    return np.where(T[:, None] > t, changed, unchanged)


WRONG: dict[str, tuple[Callable[[], Trajectory], str, str]] = {
    "the truth itself": (lambda: MOTION, "ok", "e-16 rad, centre of mass by 0 m"),
    "an attitude that wanders by 0.9 rad": (lambda: replace(MOTION, quaternion=turned(0.9 * T / 4)), "ok", "0.9 rad"),
    "an attitude that wanders by 1.1 rad": (
        lambda: replace(MOTION, quaternion=turned(1.1 * T / 4)),
        "inaccurate",
        "attitude lost at t = 3.64 s",
    ),
    "a centre of mass that is off by 2 % of its way": (
        lambda: replace(MOTION, position=1.02 * MOTION.position),
        "inaccurate",
        "centre of mass 1.",
    ),
    "a spin that grows by 1 % in all": (
        lambda: replace(MOTION, angular_velocity=MOTION.angular_velocity * (1 + 0.01 * T[:, None] / 4)),
        "energy-gain",
        "energy of rotation 1.02 times",
    ),
    "a spin that is lost by half": (
        lambda: replace(MOTION, angular_velocity=MOTION.angular_velocity * (1 - T[:, None] / 8)),
        "energy-loss",
        "energy of rotation 0.25 times",
    ),
    "an energy that swings by 4 %": (
        lambda: replace(MOTION, angular_velocity=MOTION.angular_velocity * (1 + 0.02 * np.sin(4 * T[:, None]))),
        "inaccurate",
        "energy of rotation from 0.96 to 1.04 times",
    ),
    "a motion that begins again": (
        lambda: replace(
            MOTION, **{part: np.roll(getattr(MOTION, part), 200, axis=0) for part in ("position", "quaternion", "velocity")}
        ),
        "diverged",
        "has jumped",
    ),
    "a body whose spin is gone at once": (
        lambda: replace(MOTION, angular_velocity=after(2.0, 0 * MOTION.angular_velocity, MOTION.angular_velocity)),
        "diverged",
        "the angular momentum is gone by t = 2.01 s",
    ),
    "a position that stands still": (
        lambda: replace(MOTION, position=after(1.0, MOTION.position[100], MOTION.position)),
        "frozen",
        "x stands still where it should go 2 m",
    ),
    "an attitude that stands still": (
        lambda: replace(MOTION, quaternion=after(1.0, MOTION.quaternion[100], MOTION.quaternion)),
        "frozen",
        "the attitude stands still",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_motion_that_its_engine_calls_healthy(name: str) -> None:
    make, status, words = WRONG[name]
    found = diagnosis(make())
    assert (found.status, found.engine_said) == (status, "healthy")
    assert words in found.detail


def test_a_position_is_measured_against_the_way_travelled() -> None:
    """The same 10 m are nothing on a way of thousands, and far too much on one of tens."""
    beside = replace(MOTION, position=MOTION.position + np.array([10.0, 0.0, 0.0]) * T[:, None] / 4)
    assert diagnosis(beside).status == "inaccurate"
    fast = shortened(load("intermediate-axis-flip"), 4.0, 401)
    fast = replace(fast, scene=replace(fast.scene, initial=replace(fast.scene.initial, velocity=(1000.0, 0.0, 0.0))))
    truth = follow(fast.scene, T)
    moved = replace(truth.trajectory, position=truth.trajectory.position + np.array([10.0, 0.0, 0.0]) * T[:, None] / 4)
    assert diagnose(fast.scene, Completed(moved, 400, 1.0), truth).status == "ok"


def reset(signal: str, motion: Trajectory) -> Diagnosis:
    return diagnose(SCENE, Diverged("the engine's words", signal, motion), NoTruth("it did not end"))


def head(motion: Trajectory, rows: int) -> Trajectory:
    return Trajectory(*(getattr(motion, name)[:rows] for name in vars(motion)))


def test_a_reset_takes_both_the_signal_and_the_states() -> None:
    sound = head(MOTION, 201)
    again = Trajectory(
        *(
            np.vstack([part, first[None]]) if part.ndim > 1 else T[:202]
            for part, first in ((getattr(sound, name), getattr(sound, name)[0]) for name in vars(sound))
        )
    )
    found = reset("reset", again)
    assert (found.status, found.engine_said) == ("reset", "the engine's words")
    assert "has jumped" in found.detail
    only_said = reset("reset", sound)
    assert (only_said.status, only_said.detail) == ("diverged", "its states show no break")
    gave_up = reset("gave up", sound)
    assert (gave_up.status, gave_up.engine_said) == ("diverged", "the engine's words")
    # The same states without a word are a motion that broke, not a reset.
    silent = diagnose(SCENE, Completed(again, 201, 1.0), follow(SCENE, again.t))
    assert (silent.status, silent.engine_said) == ("diverged", "healthy")
    assert "of which the engine says nothing" in silent.detail


def test_what_ended_a_run_is_told_with_what_went_before() -> None:
    growing = replace(MOTION, angular_velocity=MOTION.angular_velocity * np.exp(T[:, None]))
    broken = replace(growing, position=after(3.0, np.nan * MOTION.position, MOTION.position))
    found = diagnose(SCENE, Diverged("not a number at t = 3.01 s", trajectory=broken), NoTruth("it did not end"))
    assert (found.status, found.engine_said) == ("diverged", "healthy")
    # exp(2 * 3 s): the last sound state.
    names = ("not a number", "energy of rotation")
    assert facts(found.detail, *names)[:4] == ["not a number", "3.01", "energy of rotation", "403"]


def test_what_has_no_states() -> None:
    nothing = NoTruth("it did not end")
    assert diagnose(SCENE, TimedOut(5.0), nothing) == Diagnosis("timeout", "nothing", "stopped after 5 s")
    assert diagnose(SCENE, Unsupported("too light"), nothing) == Diagnosis("unsupported", "nothing", "too light")
    assert diagnose(SCENE, Crashed("ValueError: no"), nothing).status == "crashed"
    assert diagnose(SCENE, Diverged("no solution", "gave up"), nothing).detail == "there are no states to look at"


def test_without_a_truth_a_run_is_judged_by_what_is_conserved_and_says_so() -> None:
    why = NoTruth("the reference does not model that")
    lost = replace(MOTION, quaternion=turned(3 * T / 4))
    found = diagnose(SCENE, Completed(lost, 400, 1.0), why)
    judged = ("conserved", "the reference does not model that")
    assert (found.status, found.engine_said) == ("ok", "healthy")
    assert facts(found.detail, *judged) == list(judged)
    gaining = replace(MOTION, angular_velocity=MOTION.angular_velocity * (1 + T[:, None]))
    found = diagnose(SCENE, Completed(gaining, 400, 1.0), why)
    assert found.status == "energy-gain"
    assert facts(found.detail, *judged)[-2:] == list(judged)


def test_one_sample_is_enough() -> None:
    assert diagnose(SCENE, Completed(head(MOTION, 1), 0, 1.0), follow(SCENE, T[:1])).status == "ok"


def test_a_brick_that_sinks_in_is_not_right() -> None:
    case = load("resting-brick")
    truth = follow(case.scene, case.instants)
    assert diagnose(case.scene, Completed(truth.trajectory, 1, 1.0), truth).status == "ok"
    sunk = replace(truth.trajectory, position=truth.trajectory.position - np.array([0.0, 0.0, 0.02]))
    found = diagnose(case.scene, Completed(sunk, 1, 1.0), truth)
    assert (found.status, found.detail) == ("inaccurate", "sinks 0.02 m into the plane")


def test_flips_are_counted() -> None:
    # Half a period is 1.7 s here, and the first flip comes after a quarter.
    assert flips(SCENE.body, MOTION) == int((np.diff(np.sign(MOTION.angular_velocity[:, 2])) != 0).sum()) > 0
    spin = load("free-brick")
    assert flips(spin.scene.body, follow(spin.scene, spin.instants).trajectory) == 0


def test_the_radius_of_gyration_of_a_sphere() -> None:
    # m r^2 over a homogeneous ball of radius R is 3/5 m R^2.
    assert gyration(load("projectile").scene.body) == pytest.approx(0.1 * np.sqrt(3 / 5), rel=1e-14, abs=0)


N = np.arange(1001.0)


@pytest.mark.parametrize(
    ("drift", "law"),
    [
        (1e-9 * N, "growing linearly"),
        (1e-9 * np.sqrt(N), "growing as the square root of the steps"),
        (1e-12 * N**2, "growing quadratically"),
        (1e-3 * np.abs(np.sin(N / 30)), "bounded"),
        (1 - np.exp(-N / 100), "bounded"),
        (np.expm1(N / 100), "growing exponentially"),
        (1e-16 * np.expm1(N / 40), "growing exponentially"),
        (1 / (1 - N / 1001) ** 2 - 1, "growing faster than exponentially"),
        (np.zeros(1001), ""),
        (np.arange(5.0), ""),
    ],
)
def test_laws_of_growth(drift: Array, law: str) -> None:
    assert growth(drift).law == law


def test_a_random_walk_grows_as_the_square_root() -> None:
    """Rounding errors in three directions: eight of ten walks are told for what they are, none as faster than linear."""
    random = np.random.default_rng(1)
    walks = np.cumsum(random.normal(size=(200, 1001, 3)), axis=1) * 1e-16
    laws = [growth(np.linalg.norm(walk - walk[0], axis=1)).law for walk in walks]
    assert laws.count("growing as the square root of the steps") >= 160
    assert set(laws) <= {"bounded", "growing as the square root of the steps", "growing linearly"}


def test_a_mechanism_at_rest_has_a_size() -> None:
    resting = truth(hinge(), np.linspace(0, 1, 11))
    beside = replace(resting.trajectory, position=resting.trajectory.position + 1e-17)
    assert diagnose(hinge(), Completed(beside, 10, 1.0), resting).status == "ok"


def test_a_driven_mechanism_without_a_truth_is_judged_by_its_joints() -> None:
    told = diagnose(hinge(PD), Completed(kinematics.initial(hinge()), 0, 1.0), NoTruth("the reference does not model that"))
    assert told.detail == "judged by its joints alone: the reference does not model that"
