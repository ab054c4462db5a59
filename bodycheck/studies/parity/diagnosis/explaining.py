"""Give each difference its cause.

First come the faults in the numbers that an engine tells. The model of the file with these faults in it has terms of its own:
where they are those of the engine, the faults explain the difference of a term, and its row has the cause that makes the
largest part of it. What is left is looked for in what the engine computes. What then is left is unexplained.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from bodycheck.reference.robots.model import RobotModel
from bodycheck.studies.parity.aligning import model_terms
from bodycheck.studies.parity.comparing import Comparison, at
from bodycheck.studies.parity.diagnosis import bodies, frames, hidden, joints, ordering, passive
from bodycheck.studies.parity.diagnosis.fault import Fault, changed
from bodycheck.studies.parity.quantities import MODEL, TERMS, Cause, Quantity
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.sizes import Apart, apart
from bodycheck.studies.parity.stacks import Stack

#: States at which faults are recomputed.
STATES = 8

#: The part of a difference that recomputed faults may leave.
LEFT = 1e-7


@dataclass(frozen=True, eq=False)
class _Case:
    """A comparison at all states and at a few of them, and the faults found so far."""

    own: Comparison
    few: Comparison
    faults: tuple[Fault, ...]

    def terms(self, faults: Sequence[Fault]) -> Stack:
        """Return the terms of the file's model with faults in it, at the few states."""
        model = changed(self.few.found.bodies, faults)
        return model_terms(model, self.few.found, self.few.motion, self.few.asked.gravity)

    def gap(self, quantity: Quantity, terms: Stack) -> Apart | None:
        """Return how far the engine is from terms, at the few states."""
        return apart(quantity, self.few.engine, terms, self.few.sizes)


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """The causes of an engine's differences from a file.

    Attributes
    ----------
    rows
        The rows with their causes, and rows that name the culprits where no other row does.
    model
        The model of the file with the faults that were found in it, with the bodies of the engine; None if there are none.
    """

    rows: tuple[Compared, ...]
    model: RobotModel | None


def diagnosed(own: Comparison) -> Diagnosis:
    """Return the causes of the differences in a comparison."""
    found = ordering.reordered(own)
    if found is not None:
        own = found[0]
    if not any(row.status == "differs" for row in own.rows):
        return Diagnosis(own.rows, None)
    told = (*bodies.faults(own), *joints.faults(own), *frames.faults(own))
    case = _Case(own, at(own, _places(own)), told)
    causes: dict[Quantity, Cause] = {}
    different = [row.quantity for row in own.rows if row.quantity in TERMS and row.status == "differs"]
    if different:
        case, causes = _explained(case, [quantity for quantity in TERMS if quantity in different], found is not None)
    rows = tuple(_with_causes(own.rows, case.faults, causes))
    changing = [fault for fault in case.faults if fault.link or fault.joint]
    return Diagnosis(rows, changed(own.found.bodies, changing) if changing else None)


def _places(own: Comparison) -> list[int]:
    """Return the places of a few states: those with the largest difference of each quantity, and the first ones."""
    gaps = [apart(quantity, own.engine, own.truth, own.sizes) for quantity in TERMS]
    worst = dict.fromkeys(gap.state for gap in gaps if gap is not None and gap.relative > own.tolerance)
    return list(dict.fromkeys([*worst, *range(len(own.motion.states))]))[: max(STATES, len(worst))]


def _explained(case: _Case, different: Sequence[Quantity], reordered: bool) -> tuple[_Case, dict[Quantity, Cause]]:
    """Return a case with all faults that were found, and the causes of the terms that differ."""
    case, terms = _used(case, different)
    if "mass_matrix" in different and not _made(case, "mass_matrix", terms):
        more = tuple(hidden.faults(case.few, terms, changed(case.own.found.bodies, case.faults)))
        if more:
            case = replace(case, faults=(*case.faults, *more))
            terms = case.terms(case.faults)
    causes: dict[Quantity, Cause] = {}
    alone = _alone(case)
    for quantity in different:
        if _made(case, quantity, terms):
            causes[quantity] = _largest(case, quantity, alone)
        elif quantity in ("passive_force", "forward_dynamics"):
            case, causes[quantity] = _passive(case, quantity)
        else:
            causes[quantity] = "unexplained"
    if reordered:
        causes = {name: "coordinate-order" if cause == "unexplained" else cause for name, cause in causes.items()}
    return case, causes


def _used(case: _Case, different: Sequence[Quantity]) -> tuple[_Case, Stack]:
    """Return a case with those of its faults that the engine's terms have, and the terms of the file with them.

    An engine may tell a number that it does not use; the faults of a cause are left out where the terms fit better without.
    """
    terms = case.terms(case.faults)
    if all(_made(case, quantity, terms) for quantity in different if quantity != "forward_dynamics"):
        return case, terms
    for cause in dict.fromkeys(fault.cause for fault in case.faults):
        fewer = [fault for fault in case.faults if fault.cause != cause]
        without = case.terms(fewer)
        if all(_made(case, quantity, without) for quantity in different if quantity != "forward_dynamics"):
            return case, without
    return case, terms


def _made(case: _Case, quantity: Quantity, terms: Stack) -> bool:
    """Return whether terms are those of the engine, up to what rounding leaves of the difference from the file."""
    now, before = case.gap(quantity, terms), case.gap(quantity, case.few.truth)
    if now is None or before is None:
        return False
    return now.relative <= max(case.own.tolerance, LEFT * before.relative)


def _alone(case: _Case) -> dict[Cause, Stack]:
    """Return the terms of the file's model with the faults of each cause alone."""
    causes = dict.fromkeys(fault.cause for fault in case.faults if fault.link or fault.joint)
    if len(causes) == 1:
        return dict.fromkeys(causes, Stack())
    return {cause: case.terms([fault for fault in case.faults if fault.cause == cause]) for cause in causes}


def _largest(case: _Case, quantity: Quantity, alone: Mapping[Cause, Stack]) -> Cause:
    """Return the cause that makes the largest difference of a quantity from the file by itself."""
    gaps = {cause: apart(quantity, terms, case.few.truth, case.few.sizes) for cause, terms in alone.items()}
    sizes: dict[Cause, float] = {cause: 0.0 if gap is None else gap.relative for cause, gap in gaps.items()}
    return max(sizes, key=lambda cause: sizes[cause], default="unexplained")


def _passive(case: _Case, quantity: Quantity) -> tuple[_Case, Cause]:
    """Return a case with those passive forces in which an engine differs from the file, and the cause for a quantity."""
    step = passive.implicit_step(case.own) if quantity == "forward_dynamics" else None
    if step is not None:
        return replace(case, faults=(*case.faults, *passive.implicit(case.own, step))), "representation"
    more = tuple(passive.faults(case.own, quantity))
    if not more:
        frictionless = [
            Fault("representation", "friction", joint.name, joint={"friction": 0.0}) for joint in case.own.found.model.joints
        ]
        without = case.terms([*case.faults, *frictionless])
        if not passive.is_friction_of_a_constraint(case.few, quantity, without):
            return case, "unexplained"
        return replace(case, faults=(*case.faults, *passive.constraints(case.own, quantity))), "representation"
    everything = [*case.faults, *more]
    if not _made(case, quantity, case.terms(everything)):
        return case, "unexplained"
    causes = [fault.cause for fault in more]
    chosen = max(dict.fromkeys(causes), key=causes.count)
    return replace(case, faults=(*case.faults, *more)), chosen


def _with_causes(rows: Iterable[Compared], faults: Sequence[Fault], causes: dict[Quantity, Cause]) -> Iterable[Compared]:
    """Yield rows with their causes, and then those rows of faults whose subject no row names."""
    by_fault = {(fault.quantity, fault.subject): fault.cause for fault in faults}
    named = set()
    for row in rows:
        if row.status == "differs" and not row.cause:
            cause = by_fault.get((row.quantity, row.subject)) if row.quantity is not None else None
            if row.quantity in causes and row.subject == MODEL:
                cause = causes[row.quantity]
            row = replace(row, cause=cause or _of_rest(row, faults))
        named.add((row.quantity, row.subject, row.status))
        yield row
    more: dict[tuple[Quantity | None, str, Cause], Compared] = {}
    for fault in faults:
        if fault.row is not None and (fault.row.quantity, fault.row.subject, "differs") not in named:
            more.setdefault((fault.row.quantity, fault.row.subject, fault.cause), replace(fault.row, cause=fault.cause))
    yield from more.values()


def _of_rest(row: Compared, faults: Sequence[Fault]) -> Cause:
    """Return the cause of a row that no fault is about: the total mass follows from the masses of bodies."""
    if row.quantity == "total_mass":
        masses = [fault.cause for fault in faults if fault.quantity == "mass"]
        return masses[0] if masses else "unexplained"
    if row.quantity in ("parent", "joint_type", "gravity"):
        return "representation"
    return "unexplained"
