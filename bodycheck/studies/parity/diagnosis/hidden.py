"""Masses, centres of mass, inertias and armatures that an engine does not tell, found in its mass matrix and gravity forces.

Few faults are looked for: armatures, one body, a body with armatures, and two bodies. A fault is named only if its numbers, put
into the model of the file, leave nothing of the difference, and if they are of a kind that readers make. What has no free
number comes first: that a dropped inertia or a mistaken weld explains everything by chance is not to be expected.
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

#: The part of a difference that is rounding.
LEFT = 1e-7

#: Most free numbers that the changes of bodies have together.
MOST = 12

#: Steps of Newton's method for a centre of mass, on which inertias depend by squares.
STEPS = 12


@dataclass(frozen=True, eq=False)
class _Kind:
    """A kind of change of a body: the body with some numbers, of which there are `count`, and zeros for no change."""

    count: int
    body: Callable[[Inertial, Array], Inertial]


def _with_tensor(own: Inertial, numbers: Array) -> Inertial:
    return Inertial(own.mass, own.centre, own.tensor + tensor(numbers))


#: The kinds of changes, those with fewest numbers first.
KINDS = (
    _Kind(0, lambda own, numbers: Inertial(own.mass, own.centre, np.zeros((3, 3)))),
    _Kind(0, lambda own, numbers: Inertial(own.mass, own.centre, np.diag(np.diag(own.tensor)))),
    _Kind(0, lambda own, numbers: Inertial(0.0, own.centre, np.zeros((3, 3)))),
    _Kind(1, lambda own, numbers: Inertial(own.mass + numbers[0], own.centre, own.tensor)),
    _Kind(3, lambda own, numbers: Inertial(own.mass, own.centre + numbers, own.tensor)),
    _Kind(6, _with_tensor),
)


def faults(own: Comparison, terms: Stack, model: RobotModel) -> Iterator[Fault]:
    """Yield the faults that make the mass matrix and gravity forces of an engine from those of a model.

    Parameters
    ----------
    own
        The comparison, at few states.
    terms
        The terms of the model at these states.
    model
        The model of the engine's bodies with all faults that are known.
    """
    told = {body.name for body in own.reading.bodies if body.inertia is not None}
    hidden = {
        link.name: inertial(link) for link in model.links if link.name not in told and (link.mass or np.any(link.inertia))
    }
    found = None
    if not own.found.reduced:
        found = regression(own.engine, terms, list(hidden), own.asked.gravity)
    if found is None or not np.max(np.abs(found.left), initial=0.0):
        return
    free = [place for place, (name, _) in enumerate(own.found.labels) if not _tells_armature(own, name)]
    kinds = {name: (*_welds(own, name), *KINDS) for name in found.bodies}
    for chosen in _sets(list(found.bodies), bool(free)):
        solved = _solve(
            own, found, {name: hidden[name] for name in chosen.bodies}, free if chosen.armatures else [], kinds, chosen
        )
        if solved is not None:
            yield from _armatures(own, free if chosen.armatures else [], solved[1])
            yield from (fault for name, body in solved[0].items() for fault in _of_body(own, name, hidden[name], body))
            return


@dataclass(frozen=True)
class _Set:
    """The numbers that may differ: those of bodies, with a limit of how many in all, and armatures."""

    bodies: tuple[str, ...]
    armatures: bool
    numbers: int


def _sets(bodies: Sequence[str], armatures: bool) -> Iterator[_Set]:
    """Yield what may differ, the simplest first."""
    single, pairs = [(name,) for name in bodies], list(combinations(bodies, 2))
    yield from (_Set(own, False, 0) for own in single)
    if armatures:
        yield _Set((), True, 0)
    yield from (_Set(own, False, MOST) for own in single)
    for numbers in (0, MOST):
        if armatures:
            yield from (_Set(own, True, numbers) for own in single)
        yield from (_Set(own, False, numbers) for own in pairs)


def _solve(
    own: Comparison,
    found: Regression,
    bodies: dict[str, Inertial],
    free: list[int],
    known: dict[str, tuple[_Kind, ...]],
    chosen: _Set,
) -> tuple[dict[str, Inertial], Array] | None:
    """Return the changed bodies and armatures that explain all differences; None if no changes of a known kind do."""
    least = LEFT * float(np.max(np.abs(found.left)))
    armatures = found.armatures[:, free]
    everything = np.concatenate([armatures, *(found.bodies[name] for name in bodies)], axis=1)
    scale = np.maximum(np.linalg.norm(everything, axis=0), 1e-300)
    best = np.linalg.lstsq(everything / scale, found.left, rcond=1e-12)[0]
    if np.max(np.abs(everything / scale @ best - found.left)) > least:
        return None
    every = sorted(product(*(known[name] for name in bodies)), key=lambda kinds: sum(kind.count for kind in kinds))
    for kinds in every:
        if sum(kind.count for kind in kinds) > chosen.numbers:
            return None
        solved = _newton(found, bodies, kinds, armatures, least)
        if solved is not None and _is_known(bodies, solved[0], kinds) and _are_possible(own, free, solved[1]):
            return solved
    return None


def _welds(own: Comparison, name: str) -> Iterator[_Kind]:
    """Yield the changes of a body whose links are joined with a usual mistake."""
    joined = parts(own.found.model, name, {link.name for link in own.found.bodies.links})
    if len(joined) > 1:
        for wrong in joined_wrongly(joined):
            yield _Kind(0, lambda _, numbers, wrong=wrong: wrong)  # type: ignore[misc]


def _are_possible(own: Comparison, free: list[int], more: Array) -> bool:
    """Return whether no armature is negative, beyond rounding."""
    least = -LEFT * float(np.max(np.abs(more), initial=0.0))
    return bool(np.all(own.found.numbers("armature")[free] + more >= least))


def _newton(
    found: Regression, bodies: dict[str, Inertial], kinds: Sequence[_Kind], armatures: Array, least: float
) -> tuple[dict[str, Inertial], Array] | None:
    """Return the bodies with numbers of certain kinds, and the armatures, that explain everything; None if there are none."""
    sizes = [kind.count for kind in kinds]
    numbers = np.zeros(sum(sizes) + armatures.shape[1])

    def changed(values: Array) -> dict[str, Inertial]:
        parts = np.split(values[: sum(sizes)], np.cumsum(sizes)[:-1]) if kinds else []
        return {name: kind.body(own, part) for (name, own), kind, part in zip(bodies.items(), kinds, parts, strict=True)}

    def made(values: Array) -> Array:
        total = armatures @ values[sum(sizes) :]
        for name, own in changed(values).items():
            total = total + found.bodies[name] @ (parameters(own) - parameters(bodies[name]))
        return np.asarray(total)

    for _ in range(STEPS):
        left = found.left - made(numbers)
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
    for (name, own), kind in zip(changed.items(), kinds, strict=True):
        if kind.count == 6 and inertia_cause(own, bodies[name], False, False) == "unexplained":
            return False
        if own.mass < 0:
            return False
    return True


def _of_body(own: Comparison, name: str, truth: Inertial, engine: Inertial) -> Iterator[Fault]:
    """Yield the faults of a body whose numbers were found: of one whose links are joined wrongly, of each that differs."""
    joined, values = parts(own.found.model, name, {link.name for link in own.found.bodies.links}), attributes(engine)
    size = size_of(engine.tensor, truth.tensor)
    rows: dict[Quantity, Compared] = {
        "mass": scalar("mass", name, engine.mass, truth.mass, own.tolerance),
        "center_of_mass": vector(
            "center_of_mass", name, engine.centre, np.asarray(truth.centre), own.sizes.length, own.tolerance
        ),
        "inertia": vector("inertia", name, components(engine.tensor), components(truth.tensor), size, own.tolerance),
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
    """Return which number of a body of one link is another one, and why."""
    if engine.mass != truth.mass:
        return "mass", "mass"
    if np.any(engine.centre != truth.centre):
        return "center_of_mass", "center-of-mass"
    return "inertia", inertia_cause(engine, truth, False, False)


def _armatures(own: Comparison, free: list[int], more: Array) -> Iterator[Fault]:
    """Yield the faults of armatures that were found."""
    armatures = own.found.numbers("armature")
    least = LEFT * float(np.max(np.abs(more), initial=0.0))
    for place, number in zip(free, more, strict=True):
        name, component = own.found.labels[place]
        if abs(number) > least and component == 0:
            truth = float(armatures[place])
            row = scalar("armature", name, truth + float(number), truth, own.tolerance)
            yield Fault("armature", "armature", name, joint={"armature": truth + float(number)}, row=row)


def _tells_armature(own: Comparison, name: str) -> bool:
    return own.found.joints[name].armature is not None
