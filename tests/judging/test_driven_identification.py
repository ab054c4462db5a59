"""The law that the motion of a driven joint equals: motions by code of the test are named, and all others are not."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import scheduling
from bodycheck.adapters.contract import Method
from bodycheck.figures.columns import FIGURES
from bodycheck.figures.definition import Comparison
from bodycheck.judging.schemes.driven_identification import control_law, tells_laws
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.mechanisms.control import Controller, Stops
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.schemes.jointed import has_schemes
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run
from bodycheck.running.states import trajectory_of
from tests.support.driven_hinge import INERTIA, PD, Exact, fixed_steps, hinge, rows
from tests.support.jointed import on_one_joint

STEP, COUNT = 0.002, 51
TIMES = STEP * np.arange(COUNT)
SAMPLED = replace(PD, rate=500.0)
METHOD = Method.parse("exact", STEP)

#: A step of the hinge, from angle, rate and time (s): the angle and the rate after it.
Step = Callable[[float, float, float], tuple[float, float]]


def moving(seen: Array) -> Trajectory:
    """Return the trajectory of the hinge from angles and rates (n, 2)."""
    return trajectory_of(TIMES, rows(seen).swapaxes(0, 1))


def held(*controllers: Controller) -> Trajectory:
    """Return the exact motion of the hinge under efforts that are held."""
    exact = Exact()
    states = scheduling.driven(fixed_steps(exact, STEP), hinge(*controllers), METHOD).advance(np.repeat([0, 1], [1, COUNT - 1]))
    return trajectory_of(TIMES, states[0].swapaxes(0, 1))


def stepped(step: Step) -> Trajectory:
    """Return the motion of the hinge by steps."""
    seen = [(0.0, 0.0)]
    for time in TIMES[:-1].tolist():
        seen.append(step(*seen[-1], time))
    return moving(np.array(seen))


def semi_implicit(angle: float, rate: float, time: float) -> tuple[float, float]:
    rate += STEP / INERTIA * (20 * (1 - angle) - 0.4 * rate)
    return angle + STEP * rate, rate


def implicit(angle: float, rate: float, time: float) -> tuple[float, float]:
    matrix = np.eye(2) - STEP * np.array([[0.0, 1.0], [-2000.0, -40.0]])
    after = np.linalg.solve(matrix, [angle, rate + STEP * 2000])
    return float(after[0]), float(after[1])


def half_implicit(angle: float, rate: float, time: float) -> tuple[float, float]:
    """Take the damping from the end of the step and the spring from its start, as MuJoCo's implicit integrators do."""
    rate = (rate + STEP * 2000 * (1 - angle)) / (1 + STEP * 40)
    return angle + STEP * rate, rate


def continuous() -> Trajectory:
    """Return the closed form: the roots of s^2 + 40 s + 2000 are -20 +- 40 i."""
    decay, turn = np.exp(-20 * TIMES), 40 * TIMES
    angle = 1 - decay * (np.cos(turn) + np.sin(turn) / 2)
    return moving(np.column_stack([angle, decay * 50 * np.sin(turn)]))


def named(case: Controller, exact: Trajectory, motion: Trajectory, precision: str = "float64", method: Method = METHOD) -> str:
    """Return the law of a motion in a case with an exact motion."""
    truth = Truth(hinge(case), exact, Bounds(*[np.full(COUNT, 1e-15)] * len(NAMES)), "", "", "")
    run = Run("hinge", "engine", "1", method, Completed(motion, COUNT - 1, 1.0), scene=truth.scene)
    return control_law(run, truth, ROUNDOFF[precision])


MOTIONS = {
    "continuous": continuous(),
    "sampled": held(SAMPLED),
    "delayed by 1": held(replace(SAMPLED, delay=1)),
    "delayed by 2": held(replace(SAMPLED, delay=2)),
    "semi-implicit": stepped(semi_implicit),
    "implicit": stepped(implicit),
    "": stepped(half_implicit),
}


@pytest.mark.parametrize("law", [name for name in MOTIONS if name != "continuous"])
def test_the_motions_of_a_sampled_case_are_named(law: str) -> None:
    assert named(SAMPLED, MOTIONS["sampled"], MOTIONS[law]) == law
    # The semi-implicit candidate of a case with a delay has this delay.
    late = named(replace(SAMPLED, delay=1), MOTIONS["delayed by 1"], MOTIONS[law])
    assert late == ("" if law == "semi-implicit" else law)


@pytest.mark.parametrize("law", MOTIONS)
def test_the_motions_of_a_continuous_case_are_named(law: str) -> None:
    assert named(PD, MOTIONS["continuous"], MOTIONS[law]) == law


def test_a_motion_that_is_off_by_more_than_rounding_is_not_named() -> None:
    exact = MOTIONS["sampled"]
    angle = 2 * np.arctan2(exact.quaternion[0, :, 2], exact.quaternion[0, :, 0])
    off = moving(np.column_stack([angle + 1e-9 * TIMES, exact.angular_velocity[0, :, 1]]))
    assert named(SAMPLED, exact, off) == ""
    assert named(SAMPLED, exact, off, "float32") == "sampled"


def test_a_scene_that_does_not_distinguish_laws_has_no_name() -> None:
    constant = Controller(0, law="effort", effort=0.3, rate=500.0)
    assert not tells_laws(hinge(constant))
    assert not tells_laws(hinge())
    assert tells_laws(hinge(PD))
    assert not tells_laws(replace(hinge(PD), gravity=9.81))
    damped = on_one_joint("revolute", 0.0, 0.0, damping=0.1)
    assert not tells_laws(replace(damped, controllers=(PD,)))
    # At the target and at rest, all laws exert nothing.
    still = moving(np.zeros((COUNT, 2)))
    assert named(replace(PD, target=0.0), still, still) == ""
    adaptive = Method.parse("exact:accuracy=0.1", STEP)
    assert named(SAMPLED, MOTIONS["sampled"], MOTIONS["sampled"], method=adaptive) == ""


def test_no_law_is_named_for_a_motion_that_reaches_a_stop() -> None:
    stopped = replace(hinge(SAMPLED), joints=(replace(hinge().joints[0], stops=Stops(-1.0, 1.0)),))
    truth = Truth(stopped, MOTIONS["sampled"], Bounds(*[np.full(COUNT, 1e-15)] * len(NAMES)), "", "", "")
    run = Run("hinge", "engine", "1", METHOD, Completed(MOTIONS["sampled"], COUNT - 1, 1.0))
    assert control_law(run, truth, ROUNDOFF["float64"]) == ""
    free = replace(truth, scene=replace(stopped, joints=(replace(stopped.joints[0], stops=Stops(-1.0, 2.0)),)))
    assert control_law(run, free, ROUNDOFF["float64"]) == "sampled"


def violation(mechanism: Mechanism) -> Array | float | None:
    """Return the limit violation of the sampled motion, whose largest angle is above 1 rad."""
    truth = Truth(mechanism, MOTIONS["sampled"], Bounds(*[np.full(COUNT, 1e-15)] * len(NAMES)), "", "", "")
    return FIGURES["limit_violation"].compute(Comparison(truth, MOTIONS["sampled"]))


def test_the_limit_violation_is_the_distance_beyond_either_stop() -> None:
    turned = 2 * np.arctan2(*(MOTIONS["sampled"].quaternion[0, :, part] for part in (2, 0)))
    assert violation(hinge(SAMPLED)) is None
    assert violation(hinge(SAMPLED, stops=Stops(None, 0.9))) == pytest.approx(np.maximum(turned - 0.9, 0), abs=1e-15)
    assert violation(hinge(SAMPLED, stops=Stops(0.2, None))) == pytest.approx(np.maximum(0.2 - turned, 0), abs=1e-15)


def test_driven_mechanisms_have_no_textbook_schemes() -> None:
    assert has_schemes(hinge())
    assert not has_schemes(hinge(PD))
    assert not has_schemes(hinge(stops=Stops(-1.0, 1.0)))
