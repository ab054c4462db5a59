"""Expressions on a tape, and their derivatives in forward and reverse mode, as further expressions on the tape.

A tape is a list of operations, each of which refers to earlier operations by their indices. Equal operations are written once,
and sums and products with 0 and 1 are not written, so that terms that are absent in a mechanism cost nothing. A gradient in
reverse mode costs a few times as much as the expression, whatever the number of variables; a derivative in forward mode is for
one direction.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

#: The index of an operation on a tape.
Node = int

#: The kind of an operation, and its arguments: the indices of other operations, or a number or an index of a leaf.
Operation = tuple[str, Any, Any]

#: The value of a node: a number of any arithmetic, or an expression of any package.
Value = Any


class Tape:
    """A list of operations. The methods append an operation, if it is new, and return its index."""

    def __init__(self) -> None:
        self.operations: list[Operation] = []
        self._places: dict[Operation, Node] = {}
        self.zero = self.number(0.0)
        self.one = self.number(1.0)
        self.minus_one = self.number(-1.0)

    def number(self, value: float) -> Node:
        """The node of a number, which must be exact in every floating-point type."""
        return self._place("number", value)

    def parameter(self, index: int) -> Node:
        """The node of a parameter of the equations."""
        return self._place("parameter", index)

    def variable(self, index: int) -> Node:
        """The node of a variable of the state."""
        return self._place("variable", index)

    def sine(self, a: Node) -> Node:
        """The node of sin a."""
        return self._place("sin", a)

    def cosine(self, a: Node) -> Node:
        """The node of cos a."""
        return self._place("cos", a)

    def add(self, a: Node, b: Node) -> Node:
        """The node of a + b."""
        if a == self.zero:
            return b
        if b == self.zero:
            return a
        if (negated := self._negated(b)) is not None:
            return self.subtract(a, negated)
        if (negated := self._negated(a)) is not None:
            return self.subtract(b, negated)
        return self._place("+", min(a, b), max(a, b))

    def subtract(self, a: Node, b: Node) -> Node:
        """The node of a - b; an existing node where a or b is zero or both are equal."""
        if b == self.zero:
            return a
        if a == self.zero:
            return self.negate(b)
        if a == b:
            return self.zero
        if (negated := self._negated(b)) is not None:
            return self.add(a, negated)
        return self._place("-", a, b)

    def multiply(self, a: Node, b: Node) -> Node:
        """The node of a b."""
        if self.zero in (a, b):
            return self.zero
        if a in (self.one, self.minus_one):
            return b if a == self.one else self.negate(b)
        if b in (self.one, self.minus_one):
            return a if b == self.one else self.negate(a)
        signs = self._negated(a), self._negated(b)
        first, second = (sign if sign is not None else node for sign, node in zip(signs, (a, b), strict=True))
        product = self._place("*", min(first, second), max(first, second))
        return self.negate(product) if (signs[0] is None) != (signs[1] is None) else product

    def divide(self, a: Node, b: Node) -> Node:
        """The node of a / b, which cannot be differentiated."""
        return self.zero if a == self.zero else self._place("/", a, b)

    def negate(self, a: Node) -> Node:
        """The node of -a."""
        if a == self.zero:
            return a
        negated = self._negated(a)
        return self._place("negated", a) if negated is None else negated

    def total(self, terms: Iterable[Node]) -> Node:
        """The node of the sum of several nodes, added in their order."""
        result = self.zero
        for term in terms:
            result = self.add(result, term)
        return result

    def dot(self, one: Sequence[Node], other: Sequence[Node]) -> Node:
        """The node of the scalar product of two vectors."""
        return self.total(self.multiply(a, b) for a, b in zip(one, other, strict=True))

    def _negated(self, a: Node) -> Node | None:
        """The node b if a is the negation of b, else None."""
        kind, b, _ = self.operations[a]
        if kind == "negated":
            return int(b)
        return self.number(-b) if kind == "number" and b < 0 else None

    def _place(self, kind: str, a: Any, b: Any = None) -> Node:
        operation = (kind, a, b)
        if (existing := self._places.get(operation)) is not None:
            return existing
        self.operations.append(operation)
        self._places[operation] = len(self.operations) - 1
        return len(self.operations) - 1


def along(tape: Tape, direction: Mapping[Node, Node], outputs: Sequence[Node]) -> list[Node]:
    """The derivatives of outputs in a direction, in forward mode.

    direction: the derivatives of the variables, without those that are zero. Raises `ValueError` for a quotient.
    """
    tangents: dict[Node, Node] = dict(direction)
    for node in sorted(needed(tape, outputs)):
        if node not in tangents and (tangent := _tangent(tape, node, tangents)) != tape.zero:
            tangents[node] = tangent
    return [tangents.get(node, tape.zero) for node in outputs]


def _tangent(tape: Tape, node: Node, tangents: Mapping[Node, Node]) -> Node:
    kind, a, b = tape.operations[node]
    if kind in ("number", "parameter", "variable"):
        return tape.zero
    of_a = tangents.get(a, tape.zero)
    match kind:
        case "sin":
            return tape.multiply(tape.cosine(a), of_a)
        case "cos":
            return tape.negate(tape.multiply(tape.sine(a), of_a))
        case "negated":
            return tape.negate(of_a)
    of_b = tangents.get(b, tape.zero)
    match kind:
        case "+":
            return tape.add(of_a, of_b)
        case "-":
            return tape.subtract(of_a, of_b)
        case "*":
            return tape.add(tape.multiply(of_a, b), tape.multiply(a, of_b))
    raise ValueError(f"an operation that is not differentiated: {kind}")


def gradient(tape: Tape, output: Node, variables: Sequence[Node]) -> list[Node]:
    """The derivatives of an output with respect to some variables, in reverse mode."""
    adjoints: dict[Node, Node] = {output: tape.one}

    def carry(node: Node, amount: Node) -> None:
        adjoints[node] = tape.add(adjoints.get(node, tape.zero), amount)

    for node in sorted(needed(tape, [output]), reverse=True):
        adjoint = adjoints.get(node, tape.zero)
        if adjoint == tape.zero:
            continue
        kind, a, b = tape.operations[node]
        match kind:
            case "sin":
                carry(a, tape.multiply(adjoint, tape.cosine(a)))
            case "cos":
                carry(a, tape.negate(tape.multiply(adjoint, tape.sine(a))))
            case "negated":
                carry(a, tape.negate(adjoint))
            case "+":
                carry(a, adjoint)
                carry(b, adjoint)
            case "-":
                carry(a, adjoint)
                carry(b, tape.negate(adjoint))
            case "*":
                carry(a, tape.multiply(adjoint, b))
                carry(b, tape.multiply(adjoint, a))
            case "/":
                raise ValueError("a quotient is not differentiated")
    return [adjoints.get(variable, tape.zero) for variable in variables]


def made(
    tape: Tape,
    outputs: Sequence[Node],
    leaf: Callable[[str, Any], Value],
    sine: Callable[[Value], Value],
    cosine: Callable[[Value], Value],
) -> list[Value]:
    """The values of outputs, as numbers or as expressions of any package.

    leaf: returns the value of a number, a parameter or a variable from its kind ("number", "parameter" or "variable") and its
    number or index. sine, cosine: the functions of the arithmetic.
    """
    values: dict[Node, Value] = {}
    for node in sorted(needed(tape, outputs)):
        kind, a, b = tape.operations[node]
        match kind:
            case "sin":
                values[node] = sine(values[a])
            case "cos":
                values[node] = cosine(values[a])
            case "negated":
                values[node] = -values[a]
            case "+":
                values[node] = values[a] + values[b]
            case "-":
                values[node] = values[a] - values[b]
            case "*":
                values[node] = values[a] * values[b]
            case "/":
                values[node] = values[a] / values[b]
            case _:
                values[node] = leaf(kind, a)
    return [values[node] for node in outputs]


def needed(tape: Tape, outputs: Sequence[Node]) -> set[Node]:
    """The indices of all operations on which some outputs depend, including the outputs."""
    nodes: set[Node] = set()
    waiting = list(outputs)
    while waiting:
        node = waiting.pop()
        if node in nodes:
            continue
        nodes.add(node)
        kind, a, b = tape.operations[node]
        if kind not in ("number", "parameter", "variable"):
            waiting += [a] if b is None else [a, b]
    return nodes


def plus(tape: Tape, one: list[Node], other: list[Node]) -> list[Node]:
    """The sum of two vectors."""
    return [tape.add(a, b) for a, b in zip(one, other, strict=True)]


def cross(tape: Tape, one: list[Node], other: list[Node]) -> list[Node]:
    """The vector product of two vectors."""

    def component(i: int, j: int) -> Node:
        return tape.subtract(tape.multiply(one[i], other[j]), tape.multiply(one[j], other[i]))

    return [component(1, 2), component(2, 0), component(0, 1)]
