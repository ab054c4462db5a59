"""The structure of a mechanism and its numbers: equations are derived for a structure, and numbers are their parameters.

The structure contains which numbers are zero, and which entries of rotations are 1 or -1.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.reference.independent.border import MP, Matrix, Number, Triple
from bodycheck.reference.mechanisms.lagrangian.border import NONE, SIZES, Border, Carried, Element, Kind
from bodycheck.reference.mechanisms.lagrangian.laws import Law, Scales, constants, law_of, places

#: The value of a number that is known when the equations are derived: 0, 1 or -1, and None for a parameter.
Mark = int | None


@dataclass(frozen=True)
class Structure:
    """The properties of a mechanism on which its equations depend, except for the values of parameters.

    Attributes
    ----------
    kinds, parents
        The kinds of the elements, and the indices of their parents.
    falls
        Whether each element is described in a falling frame.
    laws
        The law of each element; None for an element without controller, stops and dry friction.
    marks
        The marks of the numbers, in the order of `numbers`.
    loops
        The indices of the elements that carry the two ends of each loop.
    rows
        The indices of the components of the loops' gaps (three for each loop) that are constraints.
    follows
        The index of the element whose coordinate determines that of each element; None for an element that moves by itself.
    """

    kinds: tuple[Kind, ...]
    parents: tuple[int | None, ...]
    falls: tuple[bool, ...]
    laws: tuple[Law | None, ...]
    marks: tuple[Mark, ...]
    loops: tuple[tuple[int | None, int | None], ...] = ()
    rows: tuple[int, ...] = ()
    follows: tuple[int | None, ...] = ()

    @property
    def places(self) -> list[tuple[slice, slice]]:
        """The slices of the coordinates and velocities of each element in the state: empty for those that follow others."""
        return _slices(
            [SIZES[kind] if leader is None else (0, 0) for kind, leader in zip(self.kinds, self.follows, strict=True)]
        )

    @property
    def all_places(self) -> list[tuple[slice, slice]]:
        """The slices of the coordinates and velocities of each element among those of all elements."""
        return _slices([SIZES[kind] for kind in self.kinds])

    @property
    def holding(self) -> list[int]:
        """The indices of the elements that dry friction or a rigid stop can hold at rest."""
        return [index for index, law in enumerate(self.laws) if law is not None and law.holds]

    @property
    def further(self) -> int:
        """The number of variables of the state after the coordinates and velocities: see `equations.Parts`."""
        laws = [law for law in self.laws if law is not None]
        return sum(law.integrates for law in laws) + any(law.timed for law in laws)

    @property
    def law_places(self) -> list[dict[str, int]]:
        """The indices of the parameters of the laws, by their names, for each element. They come after all others."""
        return places(self.laws, sum(mark is None for mark in self.marks))


def _slices(sizes: Sequence[tuple[int, int]]) -> list[tuple[slice, slice]]:
    slices, first, second = [], 0, 0
    for held, moving in sizes:
        slices.append((slice(first, first + held), slice(second, second + moving)))
        first, second = first + held, second + moving
    return slices


@dataclass(frozen=True)
class Units:
    """The units of length (m), mass (kg) and time (s) of the equations: powers of two, so that conversions do not round."""

    length: float
    mass: float
    time: float


def numbers(border: Border, units: Units) -> tuple[Structure, list[Number]]:
    """The structure of a mechanism, and the numbers that the structure does not fix, in the given units.

    The last two numbers of an element are the force of its dry friction, initially 0, and whether it moves (1, the initial
    value) or is held (0). After all elements come the points of loops, the factors and terms of elements that follow others,
    and the parameters of laws. In this structure all components of the gaps of loops are constraints.
    """
    length, mass, time = MP.mpf(units.length), MP.mpf(units.mass), MP.mpf(units.time)
    values: list[Number] = [MP.mpf(border.gravity) * time**2 / length]
    turns, kept = set(), set()
    laws = tuple(law_of(element) for element in border.elements)
    for element, law in zip(border.elements, laws, strict=True):
        turns |= set(range(len(values), len(values) + 9))
        values += [entry for row in element.turned for entry in row]
        values += [entry / length for entry in element.origin]
        whole, centre, tensor = together(element.carried)
        values += [whole / mass, *(entry / length for entry in centre)]
        values += [tensor[i][j] / (mass * length**2) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        size, inertia = (scale := scales(element, units)).size, scale.inertia
        if element.controller is not None and element.controller.rate is not None:
            kept.add(len(values) + 4)
        values += [
            element.armature / inertia,
            element.damping * time / inertia,
            element.stiffness * time**2 / inertia,
            element.rest / size,
            element.effort * time**2 / (inertia * size),
        ]
        if law is not None and law.holds:
            kept |= {len(values), len(values) + 1}
        turns.add(len(values) + 1)
        values += [MP.mpf(0), MP.mpf(1)]
    values += [entry / length for ends in border.loops for _, point in ends for entry in point]
    elements = border.elements
    index_of = {element.joint: index for index, element in enumerate(elements)}
    sizes = [length if element.kind == "slide" else MP.mpf(1) for element in elements]
    follows = [None if element.rule is None else index_of[element.rule[0]] for element in elements]
    for element, leader, size in zip(elements, follows, sizes, strict=True):
        if element.rule is not None and leader is not None:
            turns.add(len(values))
            values += [element.rule[1] * sizes[leader] / size, element.rule[2] / size]
    marks = tuple(None if index in kept else _mark(value, index in turns) for index, value in enumerate(values))
    structure = Structure(
        tuple(element.kind for element in elements),
        tuple(element.parent for element in elements),
        tuple(element.falls for element in elements),
        laws,
        marks,
        tuple((one[0], other[0]) for one, other in border.loops),
        tuple(range(3 * len(border.loops))),
        tuple(follows),
    )
    free = [value for value, mark in zip(values, marks, strict=True) if mark is None]
    for element, law in zip(elements, laws, strict=True):
        if law is not None:
            stated = constants(element, law, scales(element, units))
            free += [stated.get(name, MP.zero) for name in law.names]
    return structure, free


def scales(element: Element, units: Units) -> Scales:
    """The units of an element with one coordinate."""
    length, mass, time = MP.mpf(units.length), MP.mpf(units.mass), MP.mpf(units.time)
    slides = element.kind == "slide"
    return Scales(length if slides else MP.one, mass if slides else mass * length**2, time)


def together(carried: Sequence[Carried]) -> tuple[Number, Triple, Matrix]:
    """The total mass (kg) of bodies that move as one, their centre of mass (m), and the inertia tensor about it (kg m^2).

    All components are in the frame of the element that carries the bodies.
    """
    mass = sum((body.mass for body in carried), MP.mpf(0))
    if not mass:
        return mass, NONE, [NONE, NONE, NONE]
    centre = [sum(body.mass * body.centre[axis] for body in carried) / mass for axis in range(3)]
    tensor = [[sum(body.tensor[i][j] for body in carried) for j in range(3)] for i in range(3)]
    for body in carried:
        arm = [a - b for a, b in zip(body.centre, centre, strict=True)]
        square = sum(value * value for value in arm)
        tensor = [
            [tensor[i][j] + body.mass * ((square if i == j else 0) - arm[i] * arm[j]) for j in range(3)] for i in range(3)
        ]
    return mass, centre, tensor


def _mark(value: Number, turn: bool) -> Mark:
    return int(value) if value == 0 or (turn and abs(value) == 1) else None


#: How many numbers each element has, and how many the whole mechanism has before them: see `numbers`.
_OF_ELEMENT, _BEFORE = 29, 1


def friction_parameters(structure: Structure, index: int) -> tuple[int, int]:
    """Return the indices of two parameters of an element that can be held: the force of friction, and whether it moves."""
    first = _parameter(structure, index, -2)
    return first, first + 1


def effort_parameter(structure: Structure, index: int) -> int:
    """Return the index of the constant effort of an element, which is a parameter if it has a controller with a rate."""
    return _parameter(structure, index, -3)


def _parameter(structure: Structure, index: int, from_end: int) -> int:
    """The index among the parameters of a number of an element, which is counted from the last number of the element."""
    last = _BEFORE + _OF_ELEMENT * (index + 1) + from_end
    return sum(mark is None for mark in structure.marks[:last])
