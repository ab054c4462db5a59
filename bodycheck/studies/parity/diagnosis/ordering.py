"""Velocities of an engine that are in another order than it says."""

from dataclasses import replace

import numpy as np

from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.aligning import selected
from bodycheck.studies.parity.comparing import Comparison, with_engine
from bodycheck.studies.parity.quantities import MODEL
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.sizes import apart

#: Difference of entries of mass matrices, relative to the roots of their diagonal, below which they are the same.
SAME = 1e-7


def reordered(own: Comparison) -> tuple[Comparison, Compared] | None:
    """Return a comparison with the velocities in the order that they really have, and the row that says so.

    None if the order is right, or if no other order makes the mass matrix that of the file, or its diagonal where other
    numbers of it differ too.
    """
    mass, truth = own.engine.mass_matrix, own.truth.mass_matrix
    gap = apart("mass_matrix", own.engine, own.truth, own.sizes)
    if mass is None or truth is None or gap is None or gap.relative <= own.tolerance or len(own.found.labels) < 2:
        return None
    ours, theirs = (np.diagonal(matrix, axis1=1, axis2=2) for matrix in (truth, mass))
    order = _order(theirs, ours, max(SAME, own.tolerance))
    if order is None:
        return None
    moved = with_engine(own, selected(own.engine, order))
    better = apart("mass_matrix", moved.engine, own.truth, own.sizes)
    if better is None or better.relative >= max(SAME, own.tolerance, gap.relative / 2):
        return None
    names = [own.found.labels[place][0] for place in order]
    row = Compared(
        *("differs", "order", MODEL, " ".join(dict.fromkeys(names)), " ".join(name for name, _ in own.found.labels)),
        cause="coordinate-order",
    )
    rows = tuple(one for one in moved.rows if not (one.quantity == "order" and one.subject == MODEL))
    return replace(moved, rows=(row, *rows)), row


def _order(engine: Array, truth: Array, alike: float) -> list[int] | None:
    """Return the place in the engine of each velocity of the file, by the diagonals (s, n) of the mass matrices.

    Velocities whose diagonal is that of none, because other numbers differ too, keep their order among what is left. None if
    every velocity that has a place is where it should be, or fewer than two are elsewhere.
    """
    n = truth.shape[1]
    size = np.max(np.abs(truth), axis=0)
    same = np.array([[bool(np.all(np.abs(engine[:, i] - truth[:, j]) <= alike * size[j])) for i in range(n)] for j in range(n)])
    found: dict[int, int] = {j: j for j in range(n) if same[j, j]}
    for j in range(n):
        free = [i for i in range(n) if same[j, i] and i not in found.values()]
        if j not in found and free:
            found[j] = free[0]
    if sum(i != j for j, i in found.items()) < 2:
        return None
    left = [i for i in range(n) if i not in found.values()]
    for j in range(n):
        if j not in found:
            found[j] = j if j in left else left[0]
            left.remove(found[j])
    return [found[j] for j in range(n)]
