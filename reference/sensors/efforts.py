"""The efforts of controllers at the instants of a truth, from the states of the truth.

A controller with a rate computes its law from the truth at its instants. A continuous law follows from the state at each
instant and from the integral of its error, which is computed by Gauss-Legendre quadrature of the truth; the difference of two
rules with different numbers of panels bounds the error of the quadrature.
"""

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Wide, real, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.mechanisms.control import Controller, Samples, Signal
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.hybrid.sampled import Memory, computed, signals_at
from bodycheck.reference.mechanisms.hybrid.signals import value
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.sensors.equations import Equations
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import at
from bodycheck.reference.truths import Truth

#: The largest number of instants of controllers, for whose states the truth is computed again.
MOST_INSTANTS = 100_000

#: The part of a period by which an instant may be earlier than the end of the period without belonging to it.
SLACK = Fraction(1, 10**9)

#: The nodes of a panel of the quadrature, and the numbers of panels between two instants in the coarse and the fine rule.
NODES, PANELS = 10, (8, 16)


@dataclass(frozen=True, eq=False)
class Acting:
    """The efforts of the d joints in `Mechanism.driven` at n instants, as far as they do not follow from the states there.

    Attributes
    ----------
    held, held_error
        (n, d) efforts of controllers with a rate (N m or N), and bounds of their errors.
    signals
        For each driven joint the target, its velocity and the effort (n, 3) of a continuous law; zero for any other joint.
    integral, integral_error
        (n, d) integrals of the errors of continuous laws, and bounds of their errors.
    """

    held: WideArray
    held_error: Array
    signals: tuple[WideArray, ...]
    integral: WideArray
    integral_error: Array


def efforts(written: Equations, states: WideArray, acting: Acting) -> WideArray:
    """The efforts (n, d) of controllers at states (n, c + u)."""
    mechanism, exerted = written.mechanism, acting.held.copy()
    for column, controller in enumerate(_controllers(mechanism)):
        if controller is None or controller.rate is not None:
            continue
        held, moving = written.single[controller.joint]
        q, v = states[:, held], states[:, written.linkage.coordinates + moving]
        target, target_velocity, effort = acting.signals[column].T
        wanted = controller.kp * (target - q) + controller.kd * (target_velocity - v) + effort
        exerted[:, column] = _saturated(controller, wanted + controller.ki * acting.integral[:, column], v)
    return exerted


def nudged(acting: Acting) -> list[Acting]:
    """The efforts changed by the bounds of their errors, in either direction, one quantity of one joint after another."""
    changed = []
    for name in ("held", "integral"):
        values, errors = getattr(acting, name), getattr(acting, f"{name}_error")
        for column in np.flatnonzero(errors.any(axis=0)):
            for sign in (1, -1):
                moved = values.copy()
                moved[:, column] += sign * errors[:, column]
                changed.append(replace(acting, **{name: moved}))
    return changed


def acting_at(truth: Truth) -> Acting:
    """The efforts of controllers at the instants of the truth of a mechanism.

    Raises `NotModelled` for too many instants of controllers, and as `truth.truth` does.
    """
    mechanism = truth.scene
    assert isinstance(mechanism, Mechanism)
    count = len(truth.trajectory)
    none = [np.zeros((count, len(mechanism.driven)), dtype=Wide) for _ in range(2)]
    bounds = [np.zeros((count, len(mechanism.driven))) for _ in range(2)]
    signals = [np.zeros((count, 3), dtype=Wide) for _ in mechanism.driven]
    for column, controller in enumerate(_controllers(mechanism)):
        if controller is None:
            continue
        if controller.rate is not None:
            none[0][:, column], bounds[0][:, column] = _held(truth, controller)
            continue
        given = (controller.target, controller.target_velocity, controller.effort)
        signals[column] = np.stack([_signal(signal, truth.trajectory.t) for signal in given], axis=1)
        if controller.ki:
            none[1][:, column], bounds[1][:, column] = _integral(truth, controller)
    return Acting(none[0], bounds[0], tuple(signals), none[1], bounds[1])


def _controllers(mechanism: Mechanism) -> list[Controller | None]:
    """The controller of each joint in `Mechanism.driven`; None if it has none."""
    of_joint = {controller.joint: controller for controller in mechanism.controllers}
    return [of_joint.get(index) for index in mechanism.driven]


def _saturated(controller: Controller, effort: WideArray, v: WideArray) -> WideArray:
    """Efforts (n,) within what a controller can exert at velocities (n,) of its joint."""
    if controller.effort_limit is None:
        return effort
    most = Wide(controller.effort_limit)
    slowed = most * np.ones_like(v)
    if controller.no_load_speed is not None:
        slowed = most * np.maximum(0, 1 - np.abs(v) / controller.no_load_speed)
    limited: WideArray = np.clip(effort, np.where(v < 0, -slowed, -most), np.where(v > 0, slowed, most))
    return limited


def _signal(signal: Signal, times: Array) -> WideArray:
    """The values (n,) of a signal at times (n,), s; at a time of a table, the value from then on."""
    if not isinstance(signal, Samples):
        return np.array([wide(MP.mpf(value(signal, real(float(time))))) for time in times], dtype=Wide)
    steps = np.array(signal.times)
    after = np.minimum(np.searchsorted(steps, times * (1 + 4 * EPS), side="right"), len(steps)) - 1
    exactly = [
        steps[index] if index >= 0 and abs(time - steps[index]) <= 4 * EPS * time else time
        for index, time in zip(after, times, strict=True)
    ]
    return np.array([wide(MP.mpf(value(signal, real(float(time))))) for time in exactly], dtype=Wide)


def _motion_of(truth: Truth, joint: int, times: Array) -> tuple[Array, Array, Array, Array]:
    """The coordinate and velocity (m,) of a joint with one coordinate at times (m,), s, and the bounds (m,) of their errors."""
    mechanism = truth.scene
    assert isinstance(mechanism, Mechanism)
    there = at(truth, times)
    assert there.joints is not None  # the truth of a mechanism
    held, moving = places(mechanism)[joint]
    turns = mechanism.joints[joint].type == "revolute"
    bounds = there.bounds
    return (
        there.joints.position[:, held.start],
        there.joints.velocity[:, moving.start],
        bounds.error if turns else bounds.position_error,
        bounds.angular_velocity_error if turns else bounds.velocity_error,
    )


def _held(truth: Truth, controller: Controller) -> tuple[WideArray, Array]:
    """The efforts (n,) of a controller with a rate at the instants of a truth, and bounds of their errors."""
    assert controller.rate is not None
    rate, times = Fraction(controller.rate), truth.trajectory.t
    periods = [int((Fraction(float(time)) * rate + SLACK) // 1) for time in times]
    count = max(periods, default=-1) + 1
    if count > MOST_INSTANTS:
        raise NotModelled(f"sensors at more than {MOST_INSTANTS} instants of a controller")
    instants = [index / rate for index in range(count)]
    q, v, q_error, v_error = _motion_of(truth, controller.joint, np.array([float(instant) for instant in instants]))
    memory, total = Memory(), 0.0
    acted, errors, waiting = [], [], [0.0] * controller.delay
    for index, instant in enumerate(instants):
        given = [wide(MP.mpf(each)) for each in signals_at(controller, real(instant))]
        memory = computed(controller, memory, (given[0], given[1], given[2]), Wide(q[index]), Wide(v[index]))
        acted.append(Wide(memory.acting))
        # The instant is rounded to a double, in which the coordinate moves.
        shift = q_error[index] + abs(v[index]) * EPS * float(instant)
        total += shift
        slope = (
            controller.effort_limit / controller.no_load_speed if controller.no_load_speed and controller.effort_limit else 0
        )
        waiting.append(
            abs(controller.kp) * shift
            + (abs(controller.kd) + slope) * v_error[index]
            + abs(controller.ki) * total / controller.rate
            + EPS * abs(float(memory.acting))
        )
        errors.append(waiting[index])
    return np.array(acted, dtype=Wide)[periods], np.array(errors)[periods]


def _integral(truth: Truth, controller: Controller) -> tuple[WideArray, Array]:
    """The integrals (n,) of the error of a continuous law from 0 to the instants of a truth, and bounds of their errors."""
    times = truth.trajectory.t
    breaks = controller.target.times if isinstance(controller.target, Samples) else ()
    ends = np.union1d(np.union1d(times, 0.0), [time for time in breaks if 0 < time < times[-1]])
    pieces = [_pieces(ends, panels) for panels in PANELS]
    nodes = np.unique(np.concatenate([piece[0].ravel() for piece in pieces]))
    if not len(nodes):
        return np.zeros(len(times), dtype=Wide), np.zeros(len(times))
    q, _, q_error, _ = _motion_of(truth, controller.joint, nodes)
    target = _signal(controller.target, nodes)
    sums, errors = [], np.zeros(len(ends))
    for places_of_nodes, weights in pieces:
        rows = np.searchsorted(nodes, places_of_nodes)
        parts = ((target - q)[rows] * weights).sum(axis=1)
        sums.append(np.concatenate([[Wide(0)], np.cumsum(parts)]))
        errors = np.concatenate([[0.0], np.cumsum((q_error[rows] * weights).sum(axis=1))])
    apart = np.maximum.accumulate(np.abs(sums[1] - sums[0]).astype(float))
    rows = np.searchsorted(ends, times)
    return sums[1][rows], (errors + apart)[rows]


def _pieces(ends: Array, panels: int) -> tuple[Array, Array]:
    """Nodes and weights (k, m), s, of the quadrature from each of k + 1 times (s) to the next, each in a number of panels."""
    nodes_of_panel, weight = np.polynomial.legendre.leggauss(NODES)
    begins, lengths = ends[:-1, None], np.diff(ends)[:, None] / panels
    starts = begins + lengths * np.arange(panels)
    nodes = starts[:, :, None] + lengths[:, :, None] * (nodes_of_panel + 1) / 2
    weights = np.broadcast_to(lengths[:, :, None] * weight / 2, nodes.shape)
    return nodes.reshape(len(lengths), -1), weights.reshape(len(lengths), -1)
