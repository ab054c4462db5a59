"""The solution of the Lagrangian's equations by DOP853, for use without heyoka."""

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration import dop853
from bodycheck.reference.mechanisms.lagrangian.differentiation import Node, made
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.structure import Structure
from bodycheck.reference.trajectory import Array

#: The largest number of operations, some 30 ns each, for which an integration is begun.
MAX_OPERATIONS = 3e8

#: The number of evaluations of the equations per unit of time, in which the motion turns by about a radian.
EVALUATIONS = 500

#: The number of parts of a step in which guards are searched for roots, and of corrections of a root from the dense output.
SCANNED, REFINEMENTS = 8, 2

#: The right-hand side of the equations: a function that returns the rates from the state and the parameters.
Rates = Callable[[Sequence[float], Sequence[float]], list[float]]


@functools.lru_cache(maxsize=8)
def right_hand_side(structure: Structure) -> tuple[Rates, int]:
    """The equations of a structure as a Python function, and the number of its operations."""
    return _function(structure, derived(structure).rates)


@functools.lru_cache(maxsize=8)
def _guards(structure: Structure) -> Rates:
    """The guards of a structure as a Python function."""
    return _function(structure, [guard.node for guard in derived(structure).guards])[0]


def _function(structure: Structure, nodes: Sequence[Node]) -> tuple[Rates, int]:
    """A Python function for nodes of a structure's tape, and the number of its operations.

    The function has a line of generated code for each operation, which is ten times as fast as a loop over the operations.
    """
    lines: list[str] = []

    def kept(text: str) -> "_Text":
        lines.append(f"v{len(lines)} = {text}")
        return _Text(f"v{len(lines) - 1}", kept)

    def leaf(kind: str, value: float) -> "_Text":
        return _Text({"number": f"({value!r})", "parameter": f"p[{value}]", "variable": f"s[{value}]"}[kind], kept)

    tape = derived(structure).tape
    results = made(tape, nodes, leaf, lambda a: kept(f"sin({a.text})"), lambda a: kept(f"cos({a.text})"))
    body = [*lines, f"return [{', '.join(result.text for result in results)}]"]
    scope: dict[str, object] = {"sin": math.sin, "cos": math.cos}
    exec("def rates(s, p):\n" + "\n".join(f"    {line}" for line in body), scope)
    made_function: Rates = scope["rates"]  # type: ignore[assignment]
    return made_function, len(lines)


class _Text:
    """An operation, represented by the name of the variable that holds its value in the generated code."""

    def __init__(self, text: str, kept: Callable[[str], "_Text"]) -> None:
        self.text, self._kept = text, kept

    def __add__(self, other: "_Text") -> "_Text":
        return self._kept(f"{self.text} + {other.text}")

    def __sub__(self, other: "_Text") -> "_Text":
        return self._kept(f"{self.text} - {other.text}")

    def __mul__(self, other: "_Text") -> "_Text":
        return self._kept(f"{self.text} * {other.text}")

    def __truediv__(self, other: "_Text") -> "_Text":
        return self._kept(f"{self.text} / {other.text}")

    def __neg__(self) -> "_Text":
        return self._kept(f"-{self.text}")


def solve(structure: Structure, start: Array, parameters: Array, times: Array) -> Array:
    """The states (n, k) at ascending times (n,) >= 0, in the unit of time of the equations.

    Raises `OutOfReach` if the integration fails or takes too long.
    """
    rates = _bounded(structure, float(times[-1]) if len(times) else 0.0)
    values = parameters.tolist()

    def derivative(_: float, state: Array) -> Array:
        return np.array(rates(state.tolist(), values))

    return dop853.solve(derivative, start, times, np.ones(len(start)))


def _bounded(structure: Structure, end: float) -> Rates:
    """The equations of a structure. Raises `OutOfReach` if an integration until a time, in their unit, takes too long."""
    rates, operations = right_hand_side(structure)
    if operations * EVALUATIONS * max(end, 1.0) > MAX_OPERATIONS:
        raise OutOfReach("without heyoka the equations of so large a mechanism take too long")
    return rates


def stepper(structure: Structure, end: float) -> "Stepper":
    """DOP853 for the equations of a structure and its guards, until a time in units of the equations."""
    return Stepper(_bounded(structure, end), _guards(structure), len(derived(structure).guards))


class Stepper:
    """DOP853 in single steps, with the roots of guards.

    A root is located in the dense output of a step, and then by steps that end there, since these are of a higher order.
    """

    most = dop853.MAX_STEPS

    def __init__(self, rates: Rates, guards: Rates, count: int) -> None:
        self._rates, self._guards, self._count = rates, guards, count
        self.time, self.state = 0.0, np.empty(0)
        self._begin, self._parameters = (0.0, self.state), list[float]()

    def begin(self, time: float, state: Array, parameters: Array) -> None:
        """Begin at a time and a state, with all parameters of the structure."""
        self.time, self.state, self._parameters, self._stride = float(time), state, parameters.tolist(), None

    def _derivative(self, _: float, state: Array) -> Array:
        return np.array(self._rates(state.tolist(), self._parameters))

    def _solver(self, time: float, state: Array, until: float) -> Any:
        stride = None if self._stride is None else min(self._stride, until - time)
        return dop853.dop853(self._derivative, time, state, until, np.ones(len(state)), first_step=stride)

    def step(self, until: float) -> list[tuple[float, int]]:
        """Take a step, at most to a time, and return the times and guards of its roots. Raises `OutOfReach` if it fails."""
        self._begin = self.time, self.state
        solver = self._solver(self.time, self.state, float(until))
        dop853.advance(solver, 0, self.time, float(until))
        self.time, self.state, self._stride = float(solver.t), solver.y, solver.h_abs
        return self._roots(solver.dense_output()) if self._count else []

    def at(self, time: float) -> Array:
        """The state at a time in the last step."""
        since, state = self._begin
        if time >= self.time or time <= since:
            return self.state.copy() if time >= self.time else state.copy()
        solver = self._solver(since, state, float(time))
        while solver.status == "running":
            dop853.advance(solver, 0, since, float(time))
        return np.asarray(solver.y)

    def _roots(self, dense: Any) -> list[tuple[float, int]]:
        instants = np.linspace(self._begin[0], self.time, SCANNED + 1)
        values = np.array([self._values(dense(time)) for time in instants])
        values[0], values[-1] = self._values(self._begin[1]), self._values(self.state)
        roots = []
        for row, guard in np.argwhere(np.sign(values[:-1]) * np.sign(values[1:]) < 0):
            roots.append((self._refined(dense, float(instants[row]), float(instants[row + 1]), int(guard)), int(guard)))
        return sorted(roots)

    def _values(self, state: Array) -> list[float]:
        return self._guards(state.tolist(), self._parameters)

    def _refined(self, dense: Any, low: float, high: float, guard: int) -> float:
        """The root of a guard between two times in the last step."""
        from scipy.optimize import brentq

        def along(time: float) -> float:
            return self._values(dense(time))[guard]

        if along(low) * along(high) >= 0:
            return high
        root = float(brentq(along, low, high, xtol=1e-15 * max(1.0, abs(high)), rtol=8.9e-16))
        nudge = max((high - low) * 1e-4, 1e-12)
        slope = (along(min(root + nudge, high)) - along(max(root - nudge, low))) / (
            min(root + nudge, high) - max(root - nudge, low)
        )
        for _ in range(REFINEMENTS):
            value = self._values(self.at(root))[guard]
            root = min(max(root - value / slope, low), high) if slope else root
        return root
