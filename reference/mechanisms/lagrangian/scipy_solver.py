"""The solution of the Lagrangian's equations by DOP853, for use without heyoka."""

import functools
import math
from collections.abc import Callable, Sequence

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration import dop853
from bodycheck.reference.mechanisms.lagrangian.differentiation import made
from bodycheck.reference.mechanisms.lagrangian.equations import derived
from bodycheck.reference.mechanisms.lagrangian.structure import Structure
from bodycheck.reference.trajectory import Array

#: The largest number of operations, some 30 ns each, for which an integration is begun.
MAX_OPERATIONS = 3e8

#: The number of evaluations of the equations per unit of time, in which the motion turns by about a radian.
EVALUATIONS = 500

#: The right-hand side of the equations: a function that returns the rates from the state and the parameters.
Rates = Callable[[Sequence[float], Sequence[float]], list[float]]


@functools.lru_cache(maxsize=8)
def right_hand_side(structure: Structure) -> tuple[Rates, int]:
    """The equations of a structure as a Python function, and the number of its operations.

    The function has a line of generated code for each operation, which is ten times as fast as a loop over the operations.
    """
    equations = derived(structure)
    lines: list[str] = []

    def kept(text: str) -> "_Text":
        lines.append(f"v{len(lines)} = {text}")
        return _Text(f"v{len(lines) - 1}", kept)

    def leaf(kind: str, value: float) -> "_Text":
        return _Text({"number": f"({value!r})", "parameter": f"p[{value}]", "variable": f"s[{value}]"}[kind], kept)

    rates = made(equations.tape, equations.rates, leaf, lambda a: kept(f"sin({a.text})"), lambda a: kept(f"cos({a.text})"))
    body = [*lines, f"return [{', '.join(rate.text for rate in rates)}]"]
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
    rates, operations = right_hand_side(structure)
    end = float(times[-1]) if len(times) else 0.0
    if operations * EVALUATIONS * max(end, 1.0) > MAX_OPERATIONS:
        raise OutOfReach("without heyoka the equations of so large a mechanism take too long")
    values = parameters.tolist()

    def derivative(_: float, state: Array) -> Array:
        return np.array(rates(state.tolist(), values))

    return dop853.solve(derivative, start, times, np.ones(len(start)))
