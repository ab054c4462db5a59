"""Identify the law of a controller that produces the motion of a single driven joint.

The motion is compared with those of candidates with the same controller, at the steps of the engine:

- continuous, sampled, delayed by N: the exact motion under efforts that follow the law at each time, or that are computed at
  the instants of the controller, or of a continuous one at each step, and that act N periods later until the next result acts.
- semi-implicit: steps of semi-implicit Euler with efforts from the state at the start of the step, or from the last instant.
- implicit: steps of implicit Euler with efforts from the state at the end of the step.

Without gravity, springs and damping, the motion under an effort that is held is a parabola, and all candidates are exact up to
rounding. The law of the case itself has its motion from the truth. The continuous law of a case with a rate is no candidate.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np

from bodycheck.adapters.control_laws import value_of
from bodycheck.adapters.driving import Controls
from bodycheck.judging.schemes.identified import START_ROUNDINGS
from bodycheck.judging.schemes.scheme_rounding import STEP_ROUNDINGS
from bodycheck.judging.schemes.scheme_runs import steps
from bodycheck.reference.mechanisms import kinematics, start
from bodycheck.reference.mechanisms.control import Controller
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run

#: The number of steps over which motions are compared, and the least number of samples in them.
MOST, LEAST = 400, 5

#: The largest delay, in periods, of a candidate.
LONGEST_DELAY = 3

#: The step of a motion, from the coordinate and the velocity, the acceleration, and the step (s).
Move = Callable[[float, float, float, float], tuple[float, float]]

#: The coordinates (n,) of a candidate after n numbers of steps.
Motion = Callable[[Sequence[int]], Array]


def tells_laws(scene: AnyScene) -> bool:
    """Return whether a scene can distinguish laws: one joint on which nothing acts but a constant effort and a controller."""
    if not isinstance(scene, Mechanism) or len(scene.bodies) != 1 or len(scene.joints) != 1 or len(scene.controllers) != 1:
        return False
    joint, controller = scene.joints[0], scene.controllers[0]
    acting = scene.gravity or scene.plane or scene.pushes or scene.loops or joint.damping or joint.stiffness or joint.friction
    return not acting and bool(controller.kp or controller.kd or controller.ki)


def control_law(run: Run, truth: Truth, roundoff: float) -> str:
    """Return the name of the law that the motion of a run equals, up to rounding; empty if it is none or more than one.

    Parameters
    ----------
    run
        A completed run of a scene that `tells_laws`.
    truth
        The truth of the scene.
    roundoff
        The unit roundoff of the engine's arithmetic, one of `scheme_rounding.ROUNDOFF`.
    """
    scene = truth.scene
    assert isinstance(scene, Mechanism)
    assert isinstance(run.outcome, Completed)
    trajectory, timestep = run.outcome.trajectory, run.method.timestep
    taken = steps(trajectory, timestep)
    count = int(np.searchsorted(taken, MOST, side="right"))
    if run.method.accuracy is not None or count < LEAST:
        return ""
    seen, there = (_coordinate(scene, motion)[:count] for motion in (trajectory, truth.trajectory))
    if _reaches_a_stop(scene, seen) or _reaches_a_stop(scene, there):
        return ""
    ends, size = taken[:count], max(1.0, float(np.abs(there).max()))
    rounding = (START_ROUNDINGS + STEP_ROUNDINGS * ends) * roundoff * size
    known = rounding + np.maximum(truth.bounds.error, truth.bounds.position_error)[:count]
    fitting = [_name(scene.controllers[0])] if (np.abs(seen - there) <= known).all() else []
    motions = {name: motion(ends.tolist()) for name, motion in _candidates(scene, timestep).items()}
    fitting += [name for name, motion in motions.items() if (np.abs(seen - motion) <= rounding).all()]
    return fitting[0] if len(fitting) == 1 else ""


def _coordinate(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """Return the coordinate (n,) of the only joint."""
    return kinematics.joints(mechanism, trajectory).position[:, 0]


def _reaches_a_stop(mechanism: Mechanism, coordinate: Array) -> bool:
    """Return whether a coordinate (n,) of the only joint is at a stop or beyond it."""
    stops = mechanism.joints[0].stops
    lower, upper = (None, None) if stops is None else (stops.lower, stops.upper)
    return (lower is not None and bool((coordinate <= lower).any())) or (
        upper is not None and bool((coordinate >= upper).any())
    )


def _name(controller: Controller) -> str:
    """Return the name of the law of a controller."""
    if controller.rate is None:
        return "continuous"
    return f"delayed by {controller.delay}" if controller.delay else "sampled"


def _candidates(mechanism: Mechanism, timestep: float) -> dict[str, Motion]:
    """Return the candidates by name, without the law of the case itself. timestep: in s."""
    controller, (inertia,) = mechanism.controllers[0], np.asarray(start.mass_matrix(mechanism)[1], dtype=np.float64).ravel()
    joint = mechanism.joints[0]
    begin = joint.start[0], joint.start_velocity[0]
    # A continuous controller computes at each step, and so does one with a rate of one instant a step.
    sampled = controller if controller.rate is not None else replace(controller, rate=1 / timestep)

    def held(law: Controller, move: Move) -> Motion:
        return lambda ends: _held(law, move, begin, joint.effort, float(inertia), timestep, ends)

    laws = [replace(sampled, delay=delay) for delay in range(LONGEST_DELAY + 1)]
    candidates = {_name(law): held(law, _parabola) for law in laws if law != controller}
    candidates["semi-implicit"] = held(sampled, _semi_implicit)
    if controller.effort_limit is None and not controller.ki:
        candidates["implicit"] = lambda ends: _implicit(controller, begin, joint.effort, float(inertia), timestep, ends)
    return candidates


def _parabola(position: float, velocity: float, acceleration: float, h: float) -> tuple[float, float]:
    return position + h * velocity + h * h * acceleration / 2, velocity + h * acceleration


def _semi_implicit(position: float, velocity: float, acceleration: float, h: float) -> tuple[float, float]:
    velocity += h * acceleration
    return position + h * velocity, velocity


def _held(
    law: Controller, move: Move, begin: tuple[float, float], load: float, inertia: float, h: float, ends: Sequence[int]
) -> Array:
    """Return the coordinates (n,) after n numbers of steps (s) under efforts that a controller with a rate holds.

    begin: the coordinate and the velocity at the start. load: the constant effort. inertia: of the joint.
    """
    controls, (position, velocity), step = Controls(1, [(0, law)], [], staged=False), begin, 0
    coordinates = []
    for end in ends:
        for number in range(step, end):
            state = np.array([position]), np.array([velocity])
            controls.exert(number * Fraction(h), partial(_same, state), _nothing)
            position, velocity = move(position, velocity, (controls.samplers[0].effort + load) / inertia, h)
        step = end
        coordinates.append(position)
    return np.array(coordinates)


def _same(state: tuple[Array, Array]) -> tuple[Array, Array]:
    return state


def _nothing(efforts: Array) -> None:
    """Do nothing with efforts, which `Controls` keeps."""


def _implicit(law: Controller, begin: tuple[float, float], load: float, inertia: float, h: float, ends: Sequence[int]) -> Array:
    """Return the coordinates (n,) after n numbers of steps (s) of implicit Euler with a linear law, as `_held` does."""
    (position, velocity), step = begin, 0
    coordinates = []
    for end in ends:
        for number in range(step + 1, end + 1):
            time = number * h
            effort = load + value_of(law.effort, time) + law.kp * (value_of(law.target, time) - position)
            effort += law.kd * value_of(law.target_velocity, time)
            velocity = (velocity + h / inertia * effort) / (1 + h / inertia * (h * law.kp + law.kd))
            position += h * velocity
        step = end
        coordinates.append(position)
    return np.array(coordinates)
