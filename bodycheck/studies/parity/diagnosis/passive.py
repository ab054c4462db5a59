"""Springs, damping and friction in the forces that an engine computes, which may not be those that it reports of its joints."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.robots.model import RobotJoint
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.comparing import Comparison
from bodycheck.studies.parity.diagnosis.fault import Fault
from bodycheck.studies.parity.diagnosis.joints import number_cause
from bodycheck.studies.parity.numbers import text
from bodycheck.studies.parity.quantities import Quantity
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.stacks import Stack, times, values

#: The rest of a force, relative to the largest of the forces in its sum, below which numbers of a joint explain the force.
SAME = 1e-7

#: The numbers of a joint that make passive forces.
NUMBERS: tuple[Quantity, ...] = ("damping", "friction", "stiffness")


@dataclass(frozen=True)
class _Made:
    """The damping, friction and stiffness that make the passive force of a joint."""

    damping: float
    friction: float
    stiffness: float


def faults(comparison: Comparison, quantity: Quantity) -> Iterator[Fault]:
    """Yield a fault for each damping, friction or stiffness that an engine's forces show to differ from the file.

    Yield nothing if some force follows from no damping, friction and stiffness of its joint. quantity: the term whose forces
    are examined, "passive_force" or "forward_dynamics".
    """
    force = comparison.engine.passive_force if quantity == "passive_force" else passive_part(comparison)
    if force is None or not force.size:
        return
    joints = {joint.name: joint for joint in comparison.match.model.joints}
    scale = _same(comparison) * _scale(comparison.engine, force, quantity)
    all_faults: list[Fault] = []
    for index, (name, component) in enumerate(comparison.match.labels):
        numbers = _made(comparison, joints[name], component, force[:, index], scale[index])
        if numbers is None:
            return
        if component == 0:
            all_faults += _of_joint(comparison, joints[name], numbers, quantity)
    yield from all_faults


def is_friction_of_a_constraint(comparison: Comparison, quantity: Quantity, without: Stack) -> bool:
    """Return whether passive forces differ from the file only by dry friction that the engine treats as a constraint.

    Such friction may have any size up to the friction in the file, in either direction. without: the terms of the file at the
    same states without dry friction.
    """
    force = comparison.engine.passive_force if quantity == "passive_force" else passive_part(comparison)
    expected = without.passive_force
    if force is None or expected is None or not force.size:
        return False
    most = comparison.match.numbers("friction")
    gap = np.abs(force - expected)
    return bool(np.any(most > 0) and np.all(gap <= most + _same(comparison) * _scale(comparison.engine, force, quantity)))


def implicit_step(comparison: Comparison) -> float | None:
    """Return the time step h (s) of an engine that adds h times the damping to the diagonal of its mass matrix.

    Such an engine takes damping forces at the velocities after the step, so that its accelerations are those of the mass matrix
    M + h D. Return None if no step explains its accelerations.
    """
    passive, expected = passive_part(comparison), comparison.truth.passive_force
    forward = comparison.engine.forward_dynamics
    if passive is None or expected is None or forward is None or not forward.size:
        return None
    left, along = passive - expected, -comparison.match.numbers("damping") * forward
    if not np.any(along):
        return None
    step = float(np.sum(left * along) / np.sum(along * along))
    fits = np.all(np.abs(left - step * along) <= _same(comparison) * _scale(comparison.engine, passive, "forward_dynamics"))
    return step if fits and step > 0 else None


def implicit(comparison: Comparison, step: float) -> Iterator[Fault]:
    """Yield a fault for each damped joint of an engine that takes damping forces at the end of a time step (s)."""
    for joint in comparison.match.model.joints:
        if joint.damping and joint.name in comparison.match.joints:
            sides = f"{joint.damping!r} at the end of a step of {step:.3g} s", text([joint.damping])
            row = Compared("differs", "forward_dynamics", joint.name, *sides)
            yield Fault("representation", "damping", joint.name, row=row)


def constraints(comparison: Comparison, quantity: Quantity) -> Iterator[Fault]:
    """Yield a fault for each joint whose dry friction an engine treats as a constraint."""
    for joint in comparison.match.model.joints:
        if joint.friction:
            sides = f"a constraint of up to {joint.friction!r}", text([joint.friction])
            yield Fault("representation", "friction", joint.name, row=Compared("differs", quantity, joint.name, *sides))


def passive_part(comparison: Comparison) -> Array | None:
    """Return the passive forces (s, n) that follow from an engine's accelerations and other terms; None if one is missing."""
    terms = comparison.engine
    known = (terms.mass_matrix, terms.coriolis_force, terms.gravity_force, terms.forward_dynamics)
    if any(part is None for part in known):
        return None
    mass, coriolis, gravity, forward = (np.asarray(part) for part in known)
    return np.asarray(times(mass, forward) + coriolis + gravity - comparison.motion.efforts)


def _same(comparison: Comparison) -> float:
    """Return the relative difference below which a force is explained, which is larger for an engine in single precision."""
    return max(SAME, comparison.tolerance)


def _scale(terms: Stack, force: Array, quantity: Quantity) -> Array:
    """Return for each velocity (n,) the largest force whose rounding error enters the passive force."""
    parts = [part for part in (force, terms.gravity_force, terms.coriolis_force) if part is not None]
    if quantity == "forward_dynamics" and terms.mass_matrix is not None and terms.forward_dynamics is not None:
        parts.append(times(np.abs(terms.mass_matrix), np.abs(terms.forward_dynamics)))
    return np.asarray(np.max([np.max(np.abs(part), axis=0) for part in parts], axis=0))


def _made(comparison: Comparison, joint: RobotJoint, component: int, force: Array, limit: float) -> _Made | None:
    """Return the numbers of a joint that make a force (s,) on a velocity, up to a limit (N m or N); None if none do."""
    label = [(joint.name, component)]
    velocity = values(comparison.motion.states, label, lambda state: state.velocities)[:, 0]
    columns = [-velocity, -np.sign(velocity)]
    if joint.type in ("revolute", "prismatic"):
        columns.append(float(joint.rest) - values(comparison.motion.states, label, lambda state: state.positions)[:, 0])
    matrix = np.stack(columns, axis=1)
    if len(force) < matrix.shape[1] or not np.all(np.isfinite(force)):
        return None
    numbers = np.linalg.lstsq(matrix, force, rcond=None)[0]
    if np.max(np.abs(matrix @ numbers - force)) > limit:
        return None
    numbers = np.where(np.abs(numbers) * np.max(np.abs(matrix), axis=0) > limit, numbers, 0.0)
    return _Made(float(numbers[0]), float(numbers[1]), float(numbers[2]) if len(numbers) > 2 else 0.0)


def _of_joint(comparison: Comparison, joint: RobotJoint, numbers: _Made, term: Quantity) -> Iterator[Fault]:
    """Yield the faults of a joint. If a row compares the number that the engine reports, the fault's row is about `term`."""
    compared = {row.quantity for row in comparison.rows if row.subject == joint.name and row.status in ("agrees", "differs")}
    for quantity in NUMBERS:
        engine, truth = float(getattr(numbers, quantity)), float(getattr(joint, quantity))
        if abs(engine - truth) <= max(1e-6, 1e2 * comparison.tolerance) * max(abs(engine), abs(truth)):
            continue
        cause = number_cause(quantity, engine, truth)
        gap = abs(engine - truth)
        subject = term if quantity in compared else quantity
        values = text([engine]), text([truth]), gap, gap / max(abs(engine), abs(truth))
        row = Compared("differs", subject, joint.name, *values, cause=cause)
        yield Fault(cause, quantity, joint.name, joint={quantity: engine}, row=row)
