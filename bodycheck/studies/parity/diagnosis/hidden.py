"""Masses, centres of mass, inertias and armatures that an engine does not report, found in its mass matrix and gravity forces.

Only a few sets of faults are tried: armatures, one body, one body with armatures, and two bodies. A fault is named only if its
numbers, put into the model of the file, explain all of the difference, and if it is of a kind that readers make. Faults
without free numbers are tried first: a dropped inertia or a mistaken weld hardly explains everything by chance.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from bodycheck.adapters.robot_numbers import components
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.comparing import Comparison
from bodycheck.studies.parity.diagnosis.bodies import attributes, inertia_cause, inertial, parts
from bodycheck.studies.parity.diagnosis.fault import Fault
from bodycheck.studies.parity.diagnosis.inertias import Inertial, joined_wrongly, size_of
from bodycheck.studies.parity.diagnosis.regression import Regression, parameters, regression
from bodycheck.studies.parity.numbers import scalar, tensor, vector
from bodycheck.studies.parity.quantities import Cause, Quantity
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.stacks import Stack

#: The part of a difference that counts as rounding.
LEFT = 1e-7

#: The largest count of free numbers in the changes of all bodies together.
MOST = 12

#: The most steps of Newton's method, which is needed because inertias are quadratic in the centre of mass.
STEPS = 12


@dataclass(frozen=True, eq=False)
class _Kind:
    """A kind of change to a body: `body` returns the changed body for `count` free numbers. Zeros change nothing."""

    count: int
    body: Callable[[Inertial, Array], Inertial]


def _with_tensor(body: Inertial, numbers: Array) -> Inertial:
    return Inertial(body.mass, body.centre, body.tensor + tensor(numbers))


#: The kinds of changes, with the fewest free numbers first.
KINDS = (
    _Kind(0, lambda body, numbers: Inertial(body.mass, body.centre, np.zeros((3, 3)))),
    _Kind(0, lambda body, numbers: Inertial(body.mass, body.centre, np.diag(np.diag(body.tensor)))),
    _Kind(0, lambda body, numbers: Inertial(0.0, body.centre, np.zeros((3, 3)))),
    _Kind(1, lambda body, numbers: Inertial(body.mass + numbers[0], body.centre, body.tensor)),
    _Kind(3, lambda body, numbers: Inertial(body.mass, body.centre + numbers, body.tensor)),
    _Kind(6, _with_tensor),
)


def faults(comparison: Comparison, terms: Stack, model: RobotModel) -> Iterator[Fault]:
    """Yield the faults that explain how the mass matrix and gravity forces of an engine differ from those of a model.

    Parameters
    ----------
    comparison
        The comparison, at few states.
    terms
        The terms of the model at these states.
    model
        The model of the engine's bodies with all faults that are known.
    """
    named = {body.name for body in comparison.reading.bodies if body.inertia is not None}
    hidden = {
        link.name: inertial(link) for link in model.links if link.name not in named and (link.mass or np.any(link.inertia))
    }
    linear = None
    if not comparison.match.reduced:
        linear = regression(comparison.engine, terms, list(hidden), comparison.asked.gravity)
    if linear is None or not np.max(np.abs(linear.left), initial=0.0):
        return
    free = [index for index, (name, _) in enumerate(comparison.match.labels) if comparison.match.joints[name].armature is None]
    kinds = {name: (*_welds(comparison, name), *KINDS) for name in linear.bodies}
    for chosen in _sets(list(linear.bodies), bool(free)):
        solved = _solve(
            comparison, linear, {name: hidden[name] for name in chosen.bodies}, free if chosen.armatures else [], kinds, chosen
        )
        if solved is not None:
            yield from _armatures(comparison, free if chosen.armatures else [], solved[1])
            yield from (fault for name, body in solved[0].items() for fault in _of_body(comparison, name, hidden[name], body))
            return


@dataclass(frozen=True)
class _Set:
    """The numbers that may differ: at most `numbers` numbers of the bodies in all, and the armatures if `armatures` is true."""

    bodies: tuple[str, ...]
    armatures: bool
    numbers: int


def _sets(bodies: Sequence[str], armatures: bool) -> Iterator[_Set]:
    """Yield the sets of numbers that may differ, the simplest set first."""
    single, pairs = [(name,) for name in bodies], list(combinations(bodies, 2))
    yield from (_Set(names, False, 0) for names in single)
    if armatures:
        yield _Set((), True, 0)
    yield from (_Set(names, False, MOST) for names in single)
    for numbers in (0, MOST):
        if armatures:
            yield from (_Set(names, True, numbers) for names in single)
        yield from (_Set(names, False, numbers) for names in pairs)


def _solve(
    comparison: Comparison,
    linear: Regression,
    bodies: dict[str, Inertial],
    free: list[int],
    known: dict[str, tuple[_Kind, ...]],
    chosen: _Set,
) -> tuple[dict[str, Inertial], Array] | None:
    """Return the changed bodies and the additions to armatures that explain all differences, if they are of a known kind."""
    least = LEFT * float(np.max(np.abs(linear.left)))
    armatures = linear.armatures[:, free]
    everything = np.concatenate([armatures, *(linear.bodies[name] for name in bodies)], axis=1)
    scale = np.maximum(np.linalg.norm(everything, axis=0), 1e-300)
    best = np.linalg.lstsq(everything / scale, linear.left, rcond=1e-12)[0]
    if np.max(np.abs(everything / scale @ best - linear.left)) > least:
        return None
    every = sorted(product(*(known[name] for name in bodies)), key=lambda kinds: sum(kind.count for kind in kinds))
    for kinds in every:
        if sum(kind.count for kind in kinds) > chosen.numbers:
            return None
        solved = _newton(linear, bodies, kinds, armatures, least)
        if solved is not None and _is_known(bodies, solved[0], kinds) and _are_possible(comparison, free, solved[1]):
            return solved
    return None


def _welds(comparison: Comparison, name: str) -> Iterator[_Kind]:
    """Yield the changes of a body by which its links are joined with a usual mistake."""
    joined = parts(comparison.match.model, name, {link.name for link in comparison.match.bodies.links})
    if len(joined) > 1:
        for wrong in joined_wrongly(joined):
            yield _Kind(0, lambda _, numbers, wrong=wrong: wrong)  # type: ignore[misc]


def _are_possible(comparison: Comparison, free: list[int], more: Array) -> bool:
    """Return whether no armature is negative, beyond rounding, after `more` is added to it."""
    least = -LEFT * float(np.max(np.abs(more), initial=0.0))
    return bool(np.all(comparison.match.numbers("armature")[free] + more >= least))


def _newton(
    linear: Regression, bodies: dict[str, Inertial], kinds: Sequence[_Kind], armatures: Array, least: float
) -> tuple[dict[str, Inertial], Array] | None:
    """Return the bodies, changed by given kinds, and the additions to armatures that explain everything; None if none do."""
    sizes = [kind.count for kind in kinds]
    numbers = np.zeros(sum(sizes) + armatures.shape[1])

    def changed(values: Array) -> dict[str, Inertial]:
        parts = np.split(values[: sum(sizes)], np.cumsum(sizes)[:-1]) if kinds else []
        return {name: kind.body(body, part) for (name, body), kind, part in zip(bodies.items(), kinds, parts, strict=True)}

    def made(values: Array) -> Array:
        total = armatures @ values[sum(sizes) :]
        for name, body in changed(values).items():
            total = total + linear.bodies[name] @ (parameters(body) - parameters(bodies[name]))
        return np.asarray(total)

    for _ in range(STEPS):
        left = linear.left - made(numbers)
        if np.max(np.abs(left)) <= least:
            return changed(numbers), numbers[sum(sizes) :]
        if not len(numbers):
            return None
        steps = np.eye(len(numbers))
        # The parameters are polynomials of degree two, so that central differences are exact up to rounding.
        slope = np.stack([(made(numbers + step) - made(numbers - step)) / 2 for step in steps], axis=1)
        scale = np.maximum(np.linalg.norm(slope, axis=0), 1e-300)
        numbers = numbers + np.linalg.lstsq(slope / scale, left, rcond=1e-12)[0] / scale
    return None


def _is_known(bodies: dict[str, Inertial], changed: dict[str, Inertial], kinds: Sequence[_Kind]) -> bool:
    """Return whether changes of inertias are of a kind that readers make, and masses and centres of mass are possible."""
    for (name, body), kind in zip(changed.items(), kinds, strict=True):
        if kind.count == 6 and inertia_cause(body, bodies[name], False, False) == "unexplained":
            return False
        if body.mass < 0:
            return False
    return True


def _of_body(comparison: Comparison, name: str, truth: Inertial, engine: Inertial) -> Iterator[Fault]:
    """Yield the fault of a body whose numbers were found; if its links are joined wrongly, a fault for each wrong number."""
    joined, values = (
        parts(comparison.match.model, name, {link.name for link in comparison.match.bodies.links}),
        attributes(engine),
    )
    size = size_of(engine.tensor, truth.tensor)
    rows: dict[Quantity, Compared] = {
        "mass": scalar("mass", name, engine.mass, truth.mass, comparison.tolerance),
        "center_of_mass": vector(
            "center_of_mass", name, engine.centre, np.asarray(truth.centre), comparison.sizes.length, comparison.tolerance
        ),
        "inertia": vector("inertia", name, components(engine.tensor), components(truth.tensor), size, comparison.tolerance),
    }
    if len(joined) > 1 and any(np.array_equal(wrong.tensor, engine.tensor) for wrong in joined_wrongly(joined)):
        for quantity, row in rows.items():
            if row.status == "differs":
                yield Fault("inertia-fused", quantity, name, {quantity: values[quantity]}, row=row)
        return
    if not engine.mass and truth.mass:
        without = {"mass": 0.0, "inertia": np.zeros((3, 3), np.longdouble)}
        yield Fault("inertia-dropped", "mass", name, without, row=rows["mass"])
        return
    quantity, cause = _changed(truth, engine)
    yield Fault(cause, quantity, name, {quantity: values[quantity]}, row=rows[quantity])


def _changed(truth: Inertial, engine: Inertial) -> tuple[Quantity, Cause]:
    """Return the quantity of a body that differs, and the cause."""
    if engine.mass != truth.mass:
        return "mass", "mass"
    if np.any(engine.centre != truth.centre):
        return "center_of_mass", "center-of-mass"
    return "inertia", inertia_cause(engine, truth, False, False)


def _armatures(comparison: Comparison, free: list[int], more: Array) -> Iterator[Fault]:
    """Yield the faults of armatures that were found."""
    armatures = comparison.match.numbers("armature")
    least = LEFT * float(np.max(np.abs(more), initial=0.0))
    for index, number in zip(free, more, strict=True):
        name, component = comparison.match.labels[index]
        if abs(number) > least and component == 0:
            truth = float(armatures[index])
            row = scalar("armature", name, truth + float(number), truth, comparison.tolerance)
            yield Fault("armature", "armature", name, joint={"armature": truth + float(number)}, row=row)
