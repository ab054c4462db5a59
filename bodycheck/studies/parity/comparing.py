"""Compare the reading and the terms of an engine with the model of the file, as rows without causes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.adapters.robot_reading import RobotReading
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity import numbers, tree
from bodycheck.studies.parity.aligning import Motion, accelerations, aligned, convention_of, motion, reduced, selected, truth_of
from bodycheck.studies.parity.conventions import PROBES, Convention
from bodycheck.studies.parity.matching import Match, match
from bodycheck.studies.parity.quantities import MODEL, TERMS, Quantity, Status
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.sizes import Apart, Sizes, apart, sizes
from bodycheck.studies.parity.stacks import Stack, stacked

#: The part of the largest dry friction above which a change of its size from state to state is more than rounding.
LEAST_CHANGE = 1e-3


@dataclass(frozen=True, eq=False)
class Asked:
    """The questions to engines about a model.

    Attributes
    ----------
    model
        The model of the file.
    states, gravity
        The states and the gravitational acceleration (m/s^2) at which terms are compared.
    probes
        Further states, at which the conventions of an engine are decided.
    truth
        The terms of the model at the states and then at the probes, for all of its velocities.
    gravity_stated
        Whether the file states the gravity.
    """

    model: RobotModel
    states: tuple[RobotState, ...]
    probes: tuple[RobotState, ...]
    gravity: Vector
    truth: Stack
    gravity_stated: bool


@dataclass(frozen=True, eq=False)
class Comparison:
    """The comparison of an engine's reading with the model of the file.

    Attributes
    ----------
    asked, reading, tolerance
        The questions, the engine's reading, and the largest relative difference that counts as agreement.
    match
        The pairing of the engine's joints and bodies with those of the file.
    motion
        The compared velocities at the states, with accelerations and efforts.
    truth, engine
        The terms for these velocities, in the conventions of the file.
    convention
        The conventions of the engine.
    sizes
        The sizes of terms.
    rows
        The rows, without causes.
    """

    asked: Asked
    reading: RobotReading
    tolerance: float
    match: Match
    motion: Motion
    truth: Stack
    engine: Stack
    convention: Convention
    sizes: Sizes
    rows: tuple[Compared, ...]


def asked(model: RobotModel, states: Sequence[RobotState], gravity: Vector, gravity_stated: bool) -> Asked:
    """Return the questions to engines about a model, with the truth, which is computed once for all engines.

    states: the compared states, followed by `PROBES` states at which conventions are decided.
    """
    compared, probes = tuple(states[:-PROBES]), tuple(states[-PROBES:])
    return Asked(model, compared, probes, gravity, truth_of(model, states, gravity), gravity_stated)


def compare(given: Asked, reading: RobotReading, tolerance: float) -> Comparison:
    """Compare an engine's reading with the model of a file.

    Parameters
    ----------
    given
        The questions to the engine.
    reading
        The reading of the engine.
    tolerance
        The largest relative difference that counts as agreement.
    """
    pairing = match(given.model, reading)
    states = (*given.states, *given.probes)
    judged, probes = range(len(given.states)), range(len(given.states), len(states))
    moved = motion(pairing, states)
    whole = truth_of(pairing.model, states, given.gravity) if pairing.lacking else given.truth
    truth = reduced(whole, pairing, moved)
    terms_read = Stack() if pairing.otherwise else selected(stacked(reading.terms), pairing.columns.tolist())
    if pairing.extra:  # a free base accelerates too, which changes the accelerations
        terms_read = replace(terms_read, forward_dynamics=None)
    convention = convention_of(terms_read.at(probes), truth.at(probes), pairing, moved.at(probes))
    mass = float(np.sum([float(link.mass) for link in given.model.links]))

    def at_states(chosen: Sequence[int]) -> Comparison:
        exact, motion_chosen = truth.at(chosen), moved.at(chosen)
        engine = aligned(terms_read.at(chosen), exact, pairing, motion_chosen, convention)
        scale = sizes(exact, pairing.labels, motion_chosen.velocities, mass, float(np.linalg.norm(given.gravity)))
        return Comparison(given, reading, tolerance, pairing, motion_chosen, exact, engine, convention, scale, ())

    comparison = at_states(judged)
    if _followers_have_no_efforts(at_states(probes)):
        convention = replace(convention, followers_have_efforts=False)
        comparison = replace(_without_efforts_of_followers(comparison), convention=convention)
    comparison = _with_constraints(comparison)
    return replace(comparison, rows=tuple(_rows(comparison)))


def at(comparison: Comparison, states: Sequence[int]) -> Comparison:
    """Return a comparison of some of the states, by their indices, whose rows are still those of all states."""
    return replace(
        comparison,
        motion=comparison.motion.at(states),
        truth=comparison.truth.at(states),
        engine=comparison.engine.at(states),
        sizes=comparison.sizes.at(states),
    )


def with_engine(comparison: Comparison, engine: Stack) -> Comparison:
    """Return a comparison with other terms of the engine, and with the rows of these terms."""
    kept = tuple(row for row in comparison.rows if row.quantity not in TERMS)
    changed = replace(comparison, engine=engine)
    return replace(changed, rows=(*kept, *terms(changed)))


def _with_constraints(comparison: Comparison) -> Comparison:
    """Return a comparison whose truth has the engine's dry friction, up to that of the file, where it acts as a constraint.

    MJCF calls dry friction a constraint, and URDF states only the largest static friction. Both leave open how large the force
    is below this limit, and whether it opposes the present velocity of a joint or the velocity that the joint is about to have.
    """
    passive, velocities = comparison.engine.passive_force, comparison.motion.velocities
    most = comparison.match.numbers("friction")
    if passive is None or comparison.truth.passive_force is None or comparison.match.reduced or not np.any(most > 0):
        return comparison
    without = comparison.truth.passive_force + most * np.sign(velocities)
    friction_of_engine = np.clip(passive - without, -most, most)
    friction = np.where(_is_constraint(friction_of_engine, most), friction_of_engine, -most * np.sign(velocities))
    truth = replace(comparison.truth, passive_force=without + friction)
    return replace(comparison, truth=replace(truth, forward_dynamics=accelerations(truth, comparison.motion.efforts)))


def _is_constraint(friction: Array, most: Array) -> Array:
    """Return for each velocity (n,) whether a friction (s, n) varies in size, or has its full size at half of the states.

    A friction of constant size below that of the file (n,), such as none at all, is a different friction, not a constraint.
    """
    size = np.abs(friction)
    full = np.mean(size > 0.99 * most, axis=0) >= 0.5
    return np.asarray(full | (np.ptp(size, axis=0) > LEAST_CHANGE * most))


def _followers_have_no_efforts(probes: Comparison) -> bool:
    """Return whether an engine applies no efforts to joints that follow others, decided at states that are not compared.

    An engine that makes a joint follow another one by a constraint may apply no efforts to it.
    """
    gap = apart("forward_dynamics", probes.engine, probes.truth, probes.sizes)
    if not np.any(_followers(probes)) or gap is None or gap.relative <= probes.tolerance:
        return False
    without = _without_efforts_of_followers(probes)
    better = apart("forward_dynamics", without.engine, without.truth, without.sizes)
    return better is not None and better.relative < gap.relative / 2


def _without_efforts_of_followers(comparison: Comparison) -> Comparison:
    """Return a comparison whose joints that follow others in the engine have no efforts."""
    efforts = np.where(_followers(comparison), 0.0, comparison.motion.efforts)
    truth = replace(comparison.truth, forward_dynamics=accelerations(comparison.truth, efforts))
    return replace(comparison, truth=truth, motion=replace(comparison.motion, efforts=efforts))


def _followers(comparison: Comparison) -> Array:
    """Return for each velocity (n,) whether its joint follows another one in the engine."""
    return np.array([comparison.match.joints[name].mimic is not None for name, _ in comparison.match.labels], np.bool_)


def _rows(comparison: Comparison) -> Iterator[Compared]:
    asked, reading, match = comparison.asked, comparison.reading, comparison.match
    yield from tree.order(match, asked.model, reading)
    yield from tree.parents(match, reading)
    yield from tree.joint_types(match, asked.model, reading, comparison.tolerance)
    yield from tree.gravity(asked.model, reading, asked.gravity_stated, comparison.tolerance)
    yield from numbers.total_mass(match, reading, comparison.tolerance)
    yield from numbers.bodies(match, reading, comparison.sizes.length, comparison.tolerance)
    yield from numbers.joints(match, asked.model, comparison.tolerance)
    yield from terms(comparison)


def terms(comparison: Comparison) -> Iterator[Compared]:
    """Yield a row for each quantity that is compared at states, except quantities that the truth lacks."""
    for quantity in TERMS:
        gap = apart(quantity, comparison.engine, comparison.truth, comparison.sizes)
        if gap is not None:
            yield replace(term(quantity, gap, comparison.tolerance), convention=comparison.convention.of(quantity))
        elif not _has(comparison.engine, quantity) and _has(comparison.truth, quantity):
            yield Compared("not-modelled", quantity, MODEL)


def term(quantity: Quantity, gap: Apart, tolerance: float) -> Compared:
    """Return the row of a quantity that is compared at states."""
    status: Status = "agrees" if gap.relative <= tolerance else "differs"
    return Compared(status, quantity, MODEL, gap.engine, gap.truth, gap.difference, gap.relative)


def _has(stack: Stack, quantity: Quantity) -> bool:
    by_body = {"pose": stack.poses, "jacobian": stack.jacobians}.get(quantity)
    if by_body is not None:
        return bool(by_body)
    array = getattr(stack, quantity)
    return array is not None and array.size > 0 and bool(np.isfinite(array).any())
