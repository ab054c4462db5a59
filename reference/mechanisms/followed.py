"""The motion of a mechanism with bounds of its errors: by a closed form, by multipliers, or by the recursion.

A closed form has bounds of its errors. The recursion is integrated in the widest type of NumPy (heyoka), or in double precision
(SciPy). With heyoka the error is measured: the recursion is integrated in double precision too, and its distance from the wide
motion, divided by the growth of an error (`growth`) times one rounding, is the number of roundings. The integration in the wide
type makes the same number of roundings, and they grow by the same factor.
"""

import contextlib
import functools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.bounds import STATES
from bodycheck.reference.errors import NotModelled, OutOfReach, Stopped
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.mechanisms import recursion
from bodycheck.reference.mechanisms.articulation.nudges import growth_of_trees
from bodycheck.reference.mechanisms.forms.choice import form_of
from bodycheck.reference.mechanisms.forms.ground import carried
from bodycheck.reference.mechanisms.forms.motion import Form
from bodycheck.reference.mechanisms.friction.effects import add_doubts, errors_of_links, length_of
from bodycheck.reference.mechanisms.friction.sticking import Doubt, cancellations, doubts
from bodycheck.reference.mechanisms.growth import (
    CAUTION,
    STORED_ROUNDINGS,
    Growth,
    growth,
    of_roundings,
    rounding_errors,
    roundings,
    so_far,
)
from bodycheck.reference.mechanisms.hybrid.deciding import add_criticals
from bodycheck.reference.mechanisms.lagrangian import solution
from bodycheck.reference.mechanisms.lagrangian.poses import WideMotion
from bodycheck.reference.mechanisms.loops import ways as loops
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.modelled import require_drivable, require_independent, require_modelled, sudden
from bodycheck.reference.mechanisms.poses import bodies_of
from bodycheck.reference.mechanisms.recursion import JointStates
from bodycheck.reference.mechanisms.ways import Motion, Way, sizes
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import CLOSED_FORM_BACKEND
from bodycheck.reference.witness import DOUBLE_DIGITS
from bodycheck.reference.witnesses import DOP853_NAME, DOP853_ROUNDINGS, EXTENDED_DIGITS

#: Instants, evenly spaced, at which the growth of an error is measured.
GROWTH_INSTANTS = 129

#: The name of the recursion in results.
RECURSION = "articulated-body recursion"


@dataclass(frozen=True, eq=False)
class Measured:
    """A motion by the recursion in double precision, and the growth of an error along it, at the `growth_instants`."""

    base: Motion
    growth: Growth


@dataclass(frozen=True, eq=False)
class Followed:
    """A motion with the bounds and the growth of its errors.

    Attributes
    ----------
    way
        The motion before it is rounded to doubles, with bounds of its errors.
    model, reason, backend
        As in `Truth`.
    growth
        The growth of an error at the same instants; None if it is not known.
    form
        Whether the way is a closed form.
    measured
        The measurement from which the growth comes; None for loops, and if the recursion cannot follow the motion.
    """

    way: Way
    model: str
    reason: str
    backend: str
    growth: Growth | None
    form: bool = False
    measured: Measured | None = None


def followed(mechanism: Mechanism, times: Array) -> Followed:
    """The motion of a mechanism at ascending times (n,), s, by its closed form, or otherwise by multipliers or the recursion.

    Raises `NotModelled` if the reference has no model of the mechanism, and `OutOfReach` if it cannot follow the motion.
    """
    require_independent(mechanism)
    form = form_of(mechanism)
    if form is not None:
        return _by_form(mechanism, form, times)
    require_drivable(mechanism)
    return by_loops(mechanism, times) if mechanism.loops else by_recursion(mechanism, times)


def by_recursion(mechanism: Mechanism, times: Array, measured: Measured | None = None) -> Followed:
    """The motion of a mechanism at ascending times (n,), s, by the recursion, with bounds of its errors.

    measured: the measurement at the `growth_instants` of the times, if it was made before.
    """
    require_modelled(mechanism)
    dtype, name, digits = arithmetic()
    with stops_explained(mechanism):
        measured = measured or measurement(mechanism, times)
        grown = measured.growth
        instants = np.union1d(times, grown.t)
        states = recursion.follow(mechanism, instants, dtype)
    recursion.require_regular(mechanism, float(grown.t[-1]))
    wide = _motion_in_joints(states)
    count, growing = DOP853_ROUNDINGS, grown
    if dtype is not np.float64:
        there = wide.part(np.searchsorted(instants, grown.t))
        count = roundings(mechanism, measured.base, there, grown)
        if not sudden(mechanism) and not any(joint.friction for joint in mechanism.joints):
            growing = of_roundings(mechanism, measured.base, there, grown, count)
    errors = with_doubts(mechanism, states, growing, count, float(np.finfo(dtype).eps))
    rows = np.searchsorted(instants, times)
    way = Way(f"{RECURSION}, {name}", wide.part(rows), {name: values[rows] for name, values in errors.items()}, digits)
    return Followed(way, RECURSION, "rigid bodies on joints", name, grown.until(times), measured=measured)


@contextlib.contextmanager
def stops_explained(mechanism: Mechanism) -> Iterator[None]:
    """Say of an integration that stops whether the mass matrix becomes singular there."""
    try:
        yield
    except Stopped as stopped:
        recursion.require_regular(mechanism, stopped.time, recursion.SMALL)
        raise


def with_doubts(mechanism: Mechanism, states: JointStates, grown: Growth, count: float, eps: float) -> dict[str, Array]:
    """Bounds (n,) of the errors of an integration that makes `count` roundings of size eps, at all its instants.

    If these errors leave undecided whether a joint with dry friction sticks, the bounds grow from then on by what the other
    decision would change; and likewise by the rounding of forces that cancel where a joint begins to slip.

    Raises `OutOfReach` if these errors leave undecided which events controllers and stops cause, and in which order.
    """
    times, here = states.bodies.t, grown.until(states.bodies.t)
    errors = rounding_errors(mechanism, _motion_in_joints(states), here, count, eps)
    doubtful: list[Doubt] = []
    for decision in states.decisions:
        row = min(int(np.searchsorted(times, decision.time)), len(times) - 1)
        relative = eps * CAUTION * count * float(here.of_any[row])
        doubtful += doubts(decision, relative, errors_of_links(decision, {name: float(errors[name][row]) for name in STATES}))
        doubtful += cancellations(decision, eps, CAUTION * count)
    add_doubts(mechanism, here, doubtful, errors)
    add_criticals(mechanism, times, states.criticals, eps * CAUTION * count * here.of_any, length_of(mechanism), errors)
    return errors


def by_loops(mechanism: Mechanism, times: Array) -> Followed:
    """The motion of a mechanism with loops by multipliers, with the growth of an error; only a witness shows errors' sizes."""
    require_drivable(mechanism)
    way = loops.way(mechanism, times)
    return Followed(way, loops.NAME, "closed loops", loops.SOLVER, growth_with_loops(mechanism, times))


def growth_with_loops(mechanism: Mechanism, times: Array) -> Growth | None:
    """The growth of an error of a mechanism with loops; None without heyoka, or if the Lagrangian cannot follow the motion."""
    if arithmetic()[0] is np.float64 or any(joint is None for joint in mechanism.joint_of):
        return None
    measured = growth_instants(times)

    def follow(nudged: Mechanism, parts: Sequence[Array]) -> Iterator[Motion]:
        closed = loops.closed_start(nudged)
        return _in_parts(lambda times: motion_of(solution.follow(closed, times, np.float64), times), parts)

    try:
        (base,) = follow(mechanism, [measured])
        return growth(mechanism, follow, base, measured).until(times)
    except (NotModelled, OutOfReach):
        return None


def _by_form(mechanism: Mechanism, form: Form, times: Array) -> Followed:
    """The motion of a mechanism by its closed form. The parent of every joint that moves is at rest."""
    joints = form.follow(times)
    motion = Motion(joints.position, joints.velocity, bodies_of(mechanism, times, joints.position, joints.velocity))
    largest = sizes(mechanism, motion)
    slides = np.array([joint.type == "prismatic" for joint in mechanism.joints])
    angle, slide, spin, slip = (
        values[:, chosen].max(axis=1, initial=0.0)
        for values in (joints.error, joints.velocity_error)
        for chosen in (~slides, slides)
    )
    origins = [np.linalg.norm([float(value) for value in held.origin]) for held in carried(mechanism) or ()]
    arm = largest["position_error"] + max(origins, default=0.0)
    rate = largest["angular_velocity_error"]
    stored = STORED_ROUNDINGS * float(np.finfo(Wide).eps)
    errors = {
        "error": angle + stored,
        "position_error": slide + arm * (angle + stored),
        "velocity_error": slip + arm * (spin + rate * (angle + stored)) + stored * largest["velocity_error"],
        "angular_velocity_error": spin + rate * (angle + stored),
    }
    way = Way(
        f"closed form, {CLOSED_FORM_BACKEND}",
        motion,
        {name: so_far(values) for name, values in errors.items()},
        EXTENDED_DIGITS,
    )
    measured: Measured | None = None
    with contextlib.suppress(NotModelled, OutOfReach):
        require_modelled(mechanism)
        measured = measurement(mechanism, times)
    grown = None if measured is None else measured.growth.until(times)
    return Followed(way, f"closed form: {form.name}", form.reason, CLOSED_FORM_BACKEND, grown, form=True, measured=measured)


def measurement(mechanism: Mechanism, times: Array) -> Measured:
    """The motion by the recursion in double precision, and the growth of an error, at the `growth_instants` of times (n,)."""
    return _measured_until(mechanism, float(times[-1]) if len(times) else 0.0)


@functools.lru_cache(maxsize=4)
def _measured_until(mechanism: Mechanism, end: float) -> Measured:
    """The measurement from 0 to `end` (s), which the search for limits of joints and the truth share."""
    t = growth_instants(np.array([end]))
    if sudden(mechanism):
        return _measured_beside(mechanism, t)
    if arithmetic()[0] is not np.float64 and not any(joint.friction for joint in mechanism.joints):
        return Measured(*growth_of_trees(mechanism, t))
    (base,) = _in_doubles(mechanism, [t])
    return Measured(base, growth(mechanism, _in_doubles, base, t))


def _measured_beside(mechanism: Mechanism, t: Array) -> Measured:
    """The same at ascending instants (m,), s, for a mechanism with controllers or stops, which only heyoka can follow."""
    if arithmetic()[0] is np.float64:
        raise OutOfReach("trees with controllers and stops are followed by heyoka, which is not installed")
    from bodycheck.reference.mechanisms.hybrid.measuring import measured_growth

    return Measured(*measured_growth(mechanism, t))


def growth_instants(times: Array) -> Array:
    """The instants (m,), s, from 0 to the last of times (n,), s, at which growth is measured."""
    end = float(times[-1]) if len(times) else 0.0
    return np.linspace(0.0, end, GROWTH_INSTANTS) if end else np.zeros(1)


def arithmetic() -> tuple[Any, str, int]:
    """The arithmetic of integrations: its floating-point type, the name of the solver in results, and its decimal digits."""
    try:
        from bodycheck.reference.integration.heyoka_solver import EXTENDED_NAME
    except ImportError:
        return np.float64, DOP853_NAME, DOUBLE_DIGITS
    return np.longdouble, EXTENDED_NAME, EXTENDED_DIGITS


def _motion_in_joints(states: JointStates) -> Motion:
    return Motion(states.position, states.velocity, states.bodies)


def _in_doubles(mechanism: Mechanism, parts: Sequence[Array]) -> Iterator[Motion]:
    """The motion in double precision: by the recursion, or by the Lagrangian, whose equations DOP853 evaluates much faster."""
    if arithmetic()[0] is np.float64:
        return _in_parts(lambda times: motion_of(solution.follow_in_doubles(mechanism, times), times), parts)
    return _in_parts(lambda times: _motion_in_joints(recursion.follow(mechanism, times, np.float64)), parts)


def _in_parts(follow: Callable[[Array], Motion], parts: Sequence[Array]) -> Iterator[Motion]:
    """Yield the motion of each part by a function that follows a motion from t = 0 to ascending times (n,), s."""
    for count, part in enumerate(parts, 1):
        yield follow(np.concatenate(parts[:count])).part(slice(-len(part), None))


def motion_of(motion: WideMotion, times: Array) -> Motion:
    bodies = Trajectory(times, motion.position, motion.quaternion, motion.velocity, motion.angular_velocity)
    return Motion(motion.joint_position, motion.joint_velocity, bodies)
