"""Give each difference its cause.

First come the faults in the numbers that an engine reports. They are put into the model of the file. Where a term of this
model is that of the engine, the faults explain the difference of the term, and its row gets the cause that makes the largest
part of the difference. The causes of other differences are looked for in the terms that the engine computes. Differences
without a cause are unexplained.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.aligning import model_terms, selected
from bodycheck.studies.parity.comparing import Comparison, at, with_engine
from bodycheck.studies.parity.diagnosis import bodies, frames, hidden, joints, passive
from bodycheck.studies.parity.diagnosis.fault import Fault, changed
from bodycheck.studies.parity.quantities import MODEL, TERMS, Cause, Quantity
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.sizes import Apart, apart
from bodycheck.studies.parity.stacks import Stack

#: The number of states at which faults are recomputed.
STATES = 8

#: The part of a difference that recomputed faults may leave.
LEFT = 1e-7

#: The difference of entries of mass matrices, relative to the roots of the diagonal, below which the entries are the same.
SAME = 1e-7


@dataclass(frozen=True, eq=False)
class _Case:
    """A comparison at all states and at a few of them, and the faults found so far."""

    whole: Comparison
    few: Comparison
    faults: tuple[Fault, ...]

    def terms(self, faults: Sequence[Fault]) -> Stack:
        """Return the terms of the file's model with faults in it, at the few states."""
        model = changed(self.few.match.bodies, faults)
        return model_terms(model, self.few.match, self.few.motion, self.few.asked.gravity)

    def gap(self, quantity: Quantity, terms: Stack) -> Apart | None:
        """Return the largest difference of the engine from `terms` at the few states; None if either lacks the quantity."""
        return apart(quantity, self.few.engine, terms, self.few.sizes)


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """The causes of an engine's differences from a file.

    Attributes
    ----------
    rows
        The rows with their causes, and further rows for faults of bodies and joints that no other row names.
    model
        The model of the file with the engine's bodies and with the faults that were found; None if no fault changes it.
    """

    rows: tuple[Compared, ...]
    model: RobotModel | None


def diagnosed(comparison: Comparison) -> Diagnosis:
    """Return the causes of the differences in a comparison."""
    in_true_order = reordered(comparison)
    if in_true_order is not None:
        comparison = in_true_order
    if not any(row.status == "differs" for row in comparison.rows):
        return Diagnosis(comparison.rows, None)
    numbers_told = (*bodies.faults(comparison), *joints.faults(comparison), *frames.faults(comparison))
    case = _Case(comparison, at(comparison, _places(comparison)), numbers_told)
    causes: dict[Quantity, Cause] = {}
    different = [row.quantity for row in comparison.rows if row.quantity in TERMS and row.status == "differs"]
    if different:
        ordered = [quantity for quantity in TERMS if quantity in different]
        case, causes = _explained(case, ordered, in_true_order is not None)
    rows = [_with_cause(row, case.faults, causes) for row in comparison.rows]
    changing = [fault for fault in case.faults if fault.link or fault.joint]
    model = changed(comparison.match.bodies, changing) if changing else None
    return Diagnosis((*rows, *_rows_of_faults(case.faults, rows)), model)


def _places(comparison: Comparison) -> list[int]:
    """Return the indices of a few states: those with the largest difference of each quantity, and then the first states."""
    gaps = [apart(quantity, comparison.engine, comparison.truth, comparison.sizes) for quantity in TERMS]
    worst = dict.fromkeys(gap.state for gap in gaps if gap is not None and gap.relative > comparison.tolerance)
    return list(dict.fromkeys([*worst, *range(len(comparison.motion.states))]))[: max(STATES, len(worst))]


def _explained(case: _Case, different: Sequence[Quantity], is_reordered: bool) -> tuple[_Case, dict[Quantity, Cause]]:
    """Return a case with all faults that were found, and the causes of the terms that differ."""
    case, terms = _used(case, different)
    if "mass_matrix" in different and not _made(case, "mass_matrix", terms):
        more = tuple(hidden.faults(case.few, terms, changed(case.whole.match.bodies, case.faults)))
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
    if is_reordered:
        causes = {name: "coordinate-order" if cause == "unexplained" else cause for name, cause in causes.items()}
    return case, causes


def _used(case: _Case, different: Sequence[Quantity]) -> tuple[_Case, Stack]:
    """Return the case unchanged, and the terms of the file's model with those of its faults that the engine's terms show.

    An engine may report a number that it does not use. If the terms with all faults do not fit, and the terms without the
    faults of one cause do, the latter are returned.
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
    """Return whether a quantity of `terms` is that of the engine, up to the tolerance or a small part of the difference."""
    now, before = case.gap(quantity, terms), case.gap(quantity, case.few.truth)
    if now is None or before is None:
        return False
    return now.relative <= max(case.whole.tolerance, LEFT * before.relative)


def _alone(case: _Case) -> dict[Cause, Stack]:
    """Return for each cause the terms of the file's model with the faults of this cause alone.

    If there is only one cause, its terms are not needed and are empty.
    """
    causes = dict.fromkeys(fault.cause for fault in case.faults if fault.link or fault.joint)
    if len(causes) == 1:
        return dict.fromkeys(causes, Stack())
    return {cause: case.terms([fault for fault in case.faults if fault.cause == cause]) for cause in causes}


def _largest(case: _Case, quantity: Quantity, alone: Mapping[Cause, Stack]) -> Cause:
    """Return the cause whose faults alone make the largest difference of a quantity from the file."""
    gaps = {cause: apart(quantity, terms, case.few.truth, case.few.sizes) for cause, terms in alone.items()}
    sizes: dict[Cause, float] = {cause: 0.0 if gap is None else gap.relative for cause, gap in gaps.items()}
    return max(sizes, key=lambda cause: sizes[cause], default="unexplained")


def _passive(case: _Case, quantity: Quantity) -> tuple[_Case, Cause]:
    """Return the case with the faults that were found in passive forces, and the cause of the difference in a quantity."""
    step = passive.implicit_step(case.whole) if quantity == "forward_dynamics" else None
    if step is not None:
        return replace(case, faults=(*case.faults, *passive.implicit(case.whole, step))), "representation"
    more = tuple(passive.faults(case.whole, quantity))
    if not more:
        frictionless = [
            Fault("representation", "friction", joint.name, joint={"friction": 0.0}) for joint in case.whole.match.model.joints
        ]
        without = case.terms([*case.faults, *frictionless])
        if not passive.is_friction_of_a_constraint(case.few, quantity, without):
            return case, "unexplained"
        return replace(case, faults=(*case.faults, *passive.constraints(case.whole, quantity))), "representation"
    everything = [*case.faults, *more]
    if not _made(case, quantity, case.terms(everything)):
        return case, "unexplained"
    causes = [fault.cause for fault in more]
    chosen = max(dict.fromkeys(causes), key=causes.count)
    return replace(case, faults=(*case.faults, *more)), chosen


def _with_cause(row: Compared, faults: Sequence[Fault], term_causes: Mapping[Quantity, Cause]) -> Compared:
    """Return a row that differs with its cause, and any other row unchanged.

    A row about a term of the whole model has the cause of that term. Any other row has the cause of the last fault with the
    same quantity and subject. If neither exists, `_of_rest` determines the cause.
    """
    if row.status != "differs" or row.cause:
        return row
    fault_causes = {(fault.quantity, fault.subject): fault.cause for fault in faults}
    cause: Cause | None = None
    if row.quantity is not None:
        cause = fault_causes.get((row.quantity, row.subject))
        if row.subject == MODEL:
            cause = term_causes.get(row.quantity, cause)
    return replace(row, cause=cause or _of_rest(row, faults))


def _rows_of_faults(faults: Sequence[Fault], rows: Sequence[Compared]) -> Iterable[Compared]:
    """Return the rows of faults whose quantity and subject no differing row has; of rows with the same cause, the first."""
    named = {(row.quantity, row.subject) for row in rows if row.status == "differs"}
    further: dict[tuple[Quantity | None, str, Cause], Compared] = {}
    for fault in faults:
        if fault.row is not None and (fault.row.quantity, fault.row.subject) not in named:
            key = (fault.row.quantity, fault.row.subject, fault.cause)
            further.setdefault(key, replace(fault.row, cause=fault.cause))
    return further.values()


def _of_rest(row: Compared, faults: Sequence[Fault]) -> Cause:
    """Return the cause of a row without a fault. The total mass has the cause of the first body whose mass is at fault."""
    if row.quantity == "total_mass":
        masses = [fault.cause for fault in faults if fault.quantity == "mass"]
        return masses[0] if masses else "unexplained"
    if row.quantity in ("parent", "joint_type", "gravity"):
        return "representation"
    return "unexplained"


def reordered(comparison: Comparison) -> Comparison | None:
    """Return the comparison with the velocities in the order that the engine really uses, and with a row that states it.

    Return None if the mass matrix agrees already, or if no other order makes it agree or at least halves its difference.
    """
    mass, truth = comparison.engine.mass_matrix, comparison.truth.mass_matrix
    gap = apart("mass_matrix", comparison.engine, comparison.truth, comparison.sizes)
    if mass is None or truth is None or gap is None or gap.relative <= comparison.tolerance or len(comparison.match.labels) < 2:
        return None
    ours, theirs = (np.diagonal(matrix, axis1=1, axis2=2) for matrix in (truth, mass))
    order = _order(theirs, ours, max(SAME, comparison.tolerance))
    if order is None:
        return None
    moved = with_engine(comparison, selected(comparison.engine, order))
    better = apart("mass_matrix", moved.engine, comparison.truth, comparison.sizes)
    if better is None or better.relative >= max(SAME, comparison.tolerance, gap.relative / 2):
        return None
    names = [comparison.match.labels[index][0] for index in order]
    row = Compared(
        *("differs", "order", MODEL, " ".join(dict.fromkeys(names)), " ".join(name for name, _ in comparison.match.labels)),
        cause="coordinate-order",
    )
    rows = tuple(other for other in moved.rows if not (other.quantity == "order" and other.subject == MODEL))
    return replace(moved, rows=(row, *rows))


def _order(engine: Array, truth: Array, alike: float) -> list[int] | None:
    """Return the engine's index of each velocity of the file, found from the diagonals (s, n) of the mass matrices.

    A velocity whose diagonal entry fits none of the engine's, because other numbers differ too, keeps its index or, if another
    velocity has that, takes the first free index. Return None if fewer than two of the fitting velocities change their index.
    alike: the relative difference up to which entries fit.
    """
    n = truth.shape[1]
    size = np.max(np.abs(truth), axis=0)
    same = np.array([[bool(np.all(np.abs(engine[:, i] - truth[:, j]) <= alike * size[j])) for i in range(n)] for j in range(n)])
    engine_index: dict[int, int] = {j: j for j in range(n) if same[j, j]}
    for j in range(n):
        free = [i for i in range(n) if same[j, i] and i not in engine_index.values()]
        if j not in engine_index and free:
            engine_index[j] = free[0]
    if sum(i != j for j, i in engine_index.items()) < 2:
        return None
    left = [i for i in range(n) if i not in engine_index.values()]
    for j in range(n):
        if j not in engine_index:
            engine_index[j] = j if j in left else left[0]
            left.remove(engine_index[j])
    return [engine_index[j] for j in range(n)]
