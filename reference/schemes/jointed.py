"""Textbook schemes in the coordinates of joints, for mechanisms whose bodies are connected to the world by joints.

The state consists of the states of the links of the mechanism's trees (`mechanisms.tree`): an angle or a displacement and its
rate for each coordinate of a revolute or prismatic joint, and the quaternion of a ball joint and its angular velocity along the
axes of the link. A ball joint is turned by the exponential map, like the body in `formulations`, and the stages of Runge-Kutta
schemes are those of Munthe-Kaas. The accelerations come from the articulated-body recursion in doubles.

A scheme that evaluates the damping of joints at the end of a step adds h d to the inertia of their coordinates. A scheme that
evaluates the springs there too also adds h^2 k to the inertia and h k v to the damping force. Here d and k are the coefficients
of damping and springs, v is the rate of the coordinate, and h is the time step.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact.numbers import FloatType
from bodycheck.reference.mechanisms import poses
from bodycheck.reference.mechanisms.articulation import articulated
from bodycheck.reference.mechanisms.articulation.articulated import Constants
from bodycheck.reference.mechanisms.link_states import SIZES, Form, in_arithmetic, split, start
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.tree import Tree, forest
from bodycheck.reference.schemes.catalogue import EXPLICIT, MUNTHE_KAAS
from bodycheck.reference.schemes.increments import inverse_dexp_so3_r3, turn
from bodycheck.reference.schemes.runge_kutta import HEUN_2, KUTTA_4, MIDPOINT_2, Tableau
from bodycheck.reference.trajectory import Array, Trajectory

#: Coordinates and rates of the links of a tree, one after another.
State = tuple[list[float], list[float]]

DOUBLES = FloatType(np.float64)


@dataclass(frozen=True, eq=False)
class Equations:
    """The equations of motion of a tree in doubles, in which some forces may be evaluated at the end of a step."""

    form: Form

    def accelerations(self, state: State) -> list[float]:
        """The derivatives with respect to time of the rates of a state."""
        links, (coordinates, rates) = list[articulated.Link](), state
        q = v = 0
        for link, constants in zip(self.form.links, self.form.constants, strict=True):
            held, moving = SIZES[link.kind]
            states = coordinates[q : q + held], rates[v : v + moving]
            links.append(articulated.Link(link.kind, link.parent, constants, *states))
            q, v = q + held, v + moving
        solution = articulated.accelerations(links, self.form.gravity, np)
        return [value for states in solution.rates for value in states]

    def displaced(self, coordinates: Sequence[float], increment: Sequence[float]) -> list[float]:
        """The coordinates after an increment, which is a rotation vector along the axes of the link for a ball joint."""
        moved, q, v = list[float](), 0, 0
        for kind in (link.kind for link in self.form.links):
            if kind == "ball":
                w, i, j, k = coordinates[q : q + 4]
                x, y, z = increment[v : v + 3]
                moved += turn((w, i, j, k), (x, y, z))
            else:
                moved.append(coordinates[q] + increment[v])
            q, v = q + SIZES[kind][0], v + SIZES[kind][1]
        return moved

    def slopes(self, increment: Sequence[float], rates: Sequence[float]) -> list[float]:
        """The rates of change of an increment, at the rates of the displaced coordinates."""
        changes, v = list[float](), 0
        for kind in (link.kind for link in self.form.links):
            if kind == "ball":
                (x, y, z), (a, b, c) = increment[v : v + 3], rates[v : v + 3]
                changes += inverse_dexp_so3_r3(((0.0, 0.0, 0.0), (x, y, z)), ((0.0, 0.0, 0.0), (a, b, c)))[1]
            else:
                changes.append(rates[v])
            v += SIZES[kind][1]
        return changes


#: A scheme: the state after a step of some length (s).
Step = Callable[[Equations, State, float], State]


@dataclass(frozen=True)
class Entry:
    """A scheme, and whether it evaluates joint damping and springs at the end of the step."""

    step: Step
    damping: bool = False
    springs: bool = False


def explicit_euler(equations: Equations, state: State, h: float) -> State:
    """Explicit Euler: coordinates and rates change at their derivatives at the start of the step."""
    coordinates, rates = state
    return equations.displaced(coordinates, _times(h, rates)), _sum(rates, h, equations.accelerations(state))


def semi_implicit_euler(equations: Equations, state: State, h: float) -> State:
    """Semi-implicit Euler: first the rates, then the coordinates with the new rates."""
    rates = _sum(state[1], h, equations.accelerations(state))
    return equations.displaced(state[0], _times(h, rates)), rates


def linearly_implicit_euler(equations: Equations, state: State, h: float) -> State:
    """Linearly implicit Euler: the change of the rates solves (1 - h J) d = h a, and the coordinates follow with the new rates.

    J is the derivative of the accelerations a with respect to the rates. The accelerations are polynomials of second degree in
    the rates, so that central differences are exact.
    """
    coordinates, rates = state
    columns = []
    for index in range(len(rates)):
        ahead, behind = ([rate + sign * (k == index) for k, rate in enumerate(rates)] for sign in (1.0, -1.0))
        after, before = equations.accelerations((coordinates, ahead)), equations.accelerations((coordinates, behind))
        columns.append((np.array(after) - np.array(before)) / 2)
    matrix = np.eye(len(rates)) - h * np.array(columns).T
    change = np.linalg.solve(matrix, np.array(equations.accelerations(state)))
    rates = _sum(rates, h, change.tolist())
    return equations.displaced(coordinates, _times(h, rates)), rates


def explicit(tableau: Tableau, averaged: bool = False) -> Step:
    """The explicit Runge-Kutta scheme of a tableau.

    averaged: whether the scheme adds the rates of stages as if a ball joint did not turn.
    """

    def step(equations: Equations, state: State, h: float) -> State:
        coordinates, rates = state
        slopes = list[tuple[list[float], list[float]]]()
        for row in tableau.stages:
            u, v = _weighted(row, slopes, h, rates)
            slope = v if averaged else equations.slopes(u, v)
            slopes.append((slope, equations.accelerations((equations.displaced(coordinates, u), v))))
        u, end = _weighted(tableau.weights, slopes, h, rates)
        return equations.displaced(coordinates, u), end

    return step


def _weighted(
    row: Sequence[float], slopes: Sequence[tuple[list[float], list[float]]], h: float, rates: list[float]
) -> tuple[list[float], list[float]]:
    """The increment and the rates after a step h along weighted slopes."""
    u, v = [0.0] * len(rates), rates
    for weight, (moved, accelerated) in zip(row, slopes, strict=True):
        u, v = _sum(u, h * weight, moved), _sum(v, h * weight, accelerated)
    return u, v


def _runge_kutta() -> dict[str, Entry]:
    entries = {MUNTHE_KAAS if tableau is KUTTA_4 else name: Entry(explicit(tableau)) for name, tableau in EXPLICIT.items()}
    averaged = {name: tableau for name, tableau in EXPLICIT.items() if tableau in (MIDPOINT_2, HEUN_2, KUTTA_4)}
    return entries | {f"averaged {name}": Entry(explicit(tableau, averaged=True)) for name, tableau in averaged.items()}


#: All schemes in the coordinates of joints by the names that results show; if several agree on a mechanism, the first counts.
JOINTED: Mapping[str, Entry] = {
    "semi-implicit Euler": Entry(semi_implicit_euler),
    "semi-implicit Euler with implicit damping": Entry(semi_implicit_euler, damping=True),
    "semi-implicit Euler with implicit damping and springs": Entry(semi_implicit_euler, damping=True, springs=True),
    "linearly implicit Euler": Entry(linearly_implicit_euler),
    "explicit Euler": Entry(explicit_euler),
    **_runge_kutta(),
}


def has_schemes(mechanism: Mechanism) -> bool:
    """Return whether this module defines schemes for a mechanism.

    It has no loops, no joints that follow others, no dry friction, no free bodies, no controllers and no stops.
    """
    coupled = mechanism.loops or mechanism.controllers or any(joint.mimic or joint.stops for joint in mechanism.joints)
    trees = () if coupled else forest(mechanism).trees
    links = [link for tree in trees for link in tree.links]
    return bool(links) and not any(link.kind == "free" or link.friction for link in links)


def states(entry: Entry, tree: Tree, timestep: float, strides: NDArray[np.int64], nudge: float = 0.0) -> Array:
    """States (n, k) of a tree, in the layout of `mechanisms.link_states`, after strides (n,) of steps of a scheme.

    Rows are NaN from the first sample that the scheme does not reach because a number overflows. With a nudge, every number of
    the initial state is changed by this fraction of its size, or of 1 if its size is smaller, alternately up and down.
    """
    equations = Equations(_doubles(tree, timestep if entry.damping else 0.0, timestep if entry.springs else 0.0))
    begin = [float(value) for value in start(tree)]
    state = _apart(tree, [x + (-1) ** index * nudge * max(1.0, abs(x)) for index, x in enumerate(begin)])
    rows = np.full((len(strides), len(begin)), np.nan)
    try:
        for row, stride in zip(rows, strides.tolist(), strict=True):
            for _ in range(stride):
                state = entry.step(equations, state, timestep)
            row[:] = _together(tree, state)
    except (ArithmeticError, ValueError, np.linalg.LinAlgError):  # ValueError: after an overflow, the sine of infinity
        pass
    return rows


def trajectory(mechanism: Mechanism, rows: Sequence[Array], t: Array) -> Trajectory:
    """The states of the bodies (b, n, ...) from the states of the trees (n, k) at instants t (n,), s."""
    whole, count = forest(mechanism), len(t)
    links = [
        poses.link_frames(tree, split(tree, row, t, DOUBLES), count, DOUBLES)
        for tree, row in zip(whole.trees, rows, strict=True)
    ]
    return poses.bodies(mechanism, poses.body_frames(whole, links, count, DOUBLES), t, DOUBLES)


def _doubles(tree: Tree, damping_step: float, spring_step: float) -> Form:
    """A tree in doubles, with damping and springs evaluated at the ends of steps of these lengths (s); 0 for the start."""
    form = in_arithmetic(tree, float)
    return replace(form, constants=[_at_end(each, damping_step, spring_step) for each in form.constants])


def _at_end(constants: Constants, damping_step: float, spring_step: float) -> Constants:
    added = damping_step * constants.damping + spring_step**2 * constants.stiffness
    if not added:
        return constants
    return replace(
        constants, armature=constants.armature + added, damping=constants.damping + spring_step * constants.stiffness
    )


def _apart(tree: Tree, row: Sequence[float]) -> State:
    """Coordinates and rates from a state in the layout of `mechanisms.link_states`."""
    coordinates, rates, first = list[float](), list[float](), 0
    for link in tree.links:
        held, moving = SIZES[link.kind]
        coordinates += row[first : first + held]
        rates += row[first + held : first + held + moving]
        first += held + moving
    return coordinates, rates


def _together(tree: Tree, state: State) -> list[float]:
    """A state in the layout of `mechanisms.link_states` from coordinates and rates: the inverse of `_apart`."""
    (coordinates, rates), values, q, v = state, list[float](), 0, 0
    for link in tree.links:
        held, moving = SIZES[link.kind]
        values += [*coordinates[q : q + held], *rates[v : v + moving]]
        q, v = q + held, v + moving
    return values


def _times(h: float, values: Sequence[float]) -> list[float]:
    return [h * value for value in values]


def _sum(values: Sequence[float], h: float, others: Sequence[float]) -> list[float]:
    return [value + h * other for value, other in zip(values, others, strict=True)]
