"""Loops in the Lagrangian: the accelerations that keep the ends of loops together, with multipliers.

The gap g of a loop is the vector from its first end to its second end, along the axes of the element that carries the first
end. Along these axes, a loop in a plane has a component that is identically zero, even if the plane turns. Only independent
components of gaps are constraints: see `independent`. With X_i the derivative in the direction of the velocity u_i (see
`equations`),

    J_i = X_i g,    J du/dt = -(dg'/dq) dq/dt,    M du/dt = f + J^T l,

where g' = J u. The multipliers l follow from J M^-1 J^T, which is factored without pivots, as it is positive definite if the
constraints are independent. The state is not projected onto the constraints, so that the drift of the gaps shows the error.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, Tape, along, made, plus
from bodycheck.reference.mechanisms.lagrangian.mass_matrix import Solid
from bodycheck.reference.trajectory import Array

#: The size, relative to the largest row, of a row's component perpendicular to other rows, up to which it depends on them.
DEPENDENT = 1e-7

#: The two ends of a loop: the index of the element that carries the end (None for the world), and the point in its frame.
Ends = tuple[tuple[int | None, list[Node]], tuple[int | None, list[Node]]]


def gap(tape: Tape, parents: Sequence[int | None], solids: Sequence[Solid], ends: Ends) -> list[Node]:
    """Return the vector from the first end of a loop to the second end, along the axes of the first end's element."""
    (one, first), (other, point) = ends
    down = list(_upwards(parents, one))
    common = next((index for index in _upwards(parents, other) if index in down), None)
    for index in _upwards(parents, other):
        if index == common:
            break
        frame = solids[index].frame
        for rows, origin in ((frame.axes, frame.slid), (frame.turned, frame.origin)):
            columns = zip(*rows, strict=True)
            point = plus(tape, origin, [tape.dot(column, point) for column in columns])
    until = down.index(common) if common is not None else len(down)
    for index in reversed(down[:until]):
        frame = solids[index].frame
        for rows, origin in ((frame.turned, frame.origin), (frame.axes, frame.slid)):
            from_origin = [tape.subtract(a, b) for a, b in zip(point, origin, strict=True)]
            point = [tape.dot(row, from_origin) for row in rows]
    return [tape.subtract(a, b) for a, b in zip(point, first, strict=True)]


def _upwards(parents: Sequence[int | None], index: int | None) -> Iterator[int]:
    """The indices of an element and of all elements on its way to the root."""
    while index is not None:
        yield index
        index = parents[index]


def closed(
    tape: Tape,
    rows: Sequence[list[Node]],
    velocities: Sequence[Node],
    rates: Mapping[Node, Node],
    force: Sequence[Node],
    solve: Callable[[list[Node]], list[Node]],
) -> list[Node]:
    """The accelerations that keep gaps closed.

    Parameters
    ----------
    tape
        The tape on which the equations are written.
    rows
        The rows of J.
    velocities, rates
        The velocities u, and the time derivatives of the coordinates.
    force
        The forces f.
    solve
        The function that returns the solution x of M x = b for b.
    """
    free = solve(list(force))
    responses = [solve(row) for row in rows]
    opening = along(tape, rates, [tape.dot(row, velocities) for row in rows])
    needed = [tape.negate(tape.add(rate, tape.dot(row, free))) for rate, row in zip(opening, rows, strict=True)]
    matrix = [[tape.dot(row, response) for response in responses] for row in rows]
    multipliers = _eliminated(tape, matrix, needed)
    accelerations = free
    for multiplier, response in zip(multipliers, responses, strict=True):
        accelerations = plus(tape, accelerations, [tape.multiply(multiplier, part) for part in response])
    return accelerations


def _eliminated(tape: Tape, matrix: list[list[Node]], right: list[Node]) -> list[Node]:
    """The solution of equations with a symmetric positive definite matrix, by Gauss's elimination without pivots."""
    size, x = len(right), list(right)
    for k in range(size):
        for i in range(k + 1, size):
            ratio = tape.divide(matrix[k][i], matrix[k][k])
            for j in range(i, size):
                matrix[i][j] = tape.subtract(matrix[i][j], tape.multiply(ratio, matrix[k][j]))
            x[i] = tape.subtract(x[i], tape.multiply(ratio, x[k]))
    for k in reversed(range(size)):
        rest = tape.subtract(x[k], tape.dot(matrix[k][k + 1 :], x[k + 1 :]))
        x[k] = tape.divide(rest, matrix[k][k])
    return x


def independent(tape: Tape, rows: Sequence[list[Node]], state: Sequence[float], parameters: Sequence[float]) -> tuple[int, ...]:
    """The indices, in ascending order, of rows that are independent in a state.

    The rows are chosen one after another: the next row has the largest component perpendicular to the rows chosen before.
    """
    leaves: dict[str, Callable[[float], float]] = {
        "number": float,
        "parameter": lambda index: parameters[int(index)],
        "variable": lambda index: state[int(index)],
    }
    nodes = [node for row in rows for node in row]
    values = made(tape, nodes, lambda kind, value: leaves[kind](value), np.sin, np.cos)
    left: Array = np.array(values, dtype=float).reshape(len(rows), -1)
    largest = np.linalg.norm(left, axis=1).max(initial=0.0)
    chosen: list[int] = []
    for _ in range(min(left.shape)):
        sizes = np.linalg.norm(left, axis=1)
        best = int(np.argmax(sizes))
        if sizes[best] <= DEPENDENT * largest:
            break
        chosen.append(best)
        unit = left[best] / sizes[best]
        left = left - np.outer(left @ unit, unit)
    return tuple(sorted(chosen))
