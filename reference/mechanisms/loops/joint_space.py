"""Mechanisms with loops in the coordinates of their joints: the mass matrix of the tree, and multipliers for the loops.

Each joint consists of turns, slides and balls; a free body has three slides and a ball. The accelerations of bodies are linear
in those of the coordinates, a = J q'' + b, so that d'Alembert's principle gives

    sum over bodies of  Jv^T m (Jv q'' + bv - g) + Jw^T (I (Jw q'' + bw) + w x I w) = tau + J_loop^T forces.

The frames of the start are those of `start`.
"""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import Wide, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.independent.directions import quaternion_of
from bodycheck.reference.kinematics import cross, dot
from bodycheck.reference.mechanisms import exact, start
from bodycheck.reference.mechanisms.coordinates import COORDINATES, VELOCITIES, places
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, MotionKind
from bodycheck.reference.mechanisms.kinematics import from_the_root
from bodycheck.reference.mechanisms.loops.minimum_norm import solved
from bodycheck.reference.mechanisms.loops.vectors import about, apply, matrices, rounded, turning
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism

_EYE = np.eye(3, dtype=Wide)
_HERE = np.zeros(3, dtype=Wide)
_AXES = dict(zip("xyz", _EYE, strict=True))

#: What an element does: an elementary motion, or nothing.
Kind = MotionKind | Literal["fixed"]


@dataclass(frozen=True, eq=False)
class Element:
    """A part of a joint.

    Attributes
    ----------
    kind, parent
        What it does, and the place of the element before it; `WORLD` for none.
    turned, arm
        Its axes as columns (3, 3) and its origin (3,) in the frame of the element before it (m).
    axis
        (3,) its axis in its own frame.
    held, moving
        Its coordinates and velocities in those of the mechanism.
    joint
        The joint, of whose forces it has a part; None for a free body.
    """

    kind: Kind
    parent: int
    turned: WideArray
    arm: WideArray
    axis: WideArray
    held: slice
    moving: slice
    joint: Joint | None


@dataclass(frozen=True, eq=False)
class Tree:
    """A mechanism of b bodies and l loops with c coordinates and u velocities, free bodies included.

    Attributes
    ----------
    elements, ends
        The elements, each behind its parent, and the place of the element that carries each body.
    coordinates
        c.
    mass, centre, tensor
        (b,), (b, 3) and (b, 3, 3) of the bodies, in their frames.
    points
        The ends of the loops, as two tuples of an element and a point (3,) in its frame for each.
    along
        (b + 2 l, u) which velocities move each body, and then each first and each second end of a loop.
    gravity
        (m/s^2).
    inertia, damping, stiffness, rest, effort
        (u,) armature and the numbers of the forces of each velocity's coordinate.
    """

    elements: tuple[Element, ...]
    ends: tuple[int, ...]
    coordinates: int
    mass: WideArray
    centre: WideArray
    tensor: WideArray
    points: tuple[tuple[tuple[int, WideArray], tuple[int, WideArray]], ...]
    along: WideArray
    gravity: np.longdouble
    inertia: WideArray
    damping: WideArray
    stiffness: WideArray
    rest: WideArray
    effort: WideArray


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of the frames of elements at s instants, along the axes of the world.

    Attributes
    ----------
    axes, origin
        (s, 3, 3) axes as columns, and (s, 3) origins (m), element by element.
    spin, velocity, turn_bias, bias
        (s, 3) angular velocity, velocity of the origin, and their derivatives without accelerations of coordinates.
    turns, slides, centres
        (s, u, 3) angular velocity and velocity of the origin for each velocity, and where the axis of a turn lies.
    """

    axes: list[WideArray]
    origin: list[WideArray]
    spin: list[WideArray]
    velocity: list[WideArray]
    turn_bias: list[WideArray]
    bias: list[WideArray]
    turns: WideArray
    slides: WideArray
    centres: WideArray


def tree(mechanism: Mechanism) -> Tree:
    """The tree of a mechanism. Raises `NotModelled` where it has dry friction."""
    if any(joint.friction for joint in mechanism.joints):
        raise NotModelled("dry friction in a mechanism with loops")
    slices = dict(zip((id(joint) for joint in mechanism.joints), places(mechanism), strict=True))
    held, moving = joint_sizes(mechanism)
    elements: list[Element] = []
    ends: dict[int, int] = {WORLD: WORLD}
    for body, joint in enumerate(mechanism.joint_of):
        if joint is None:
            ends[body] = _append_elements(elements, WORLD, _EYE, _HERE, _steps(None), held, moving, None)
            held, moving = held + 7, moving + 6
    for joint in from_the_root(mechanism):
        first, second = (part.start for part in slices[id(joint)])
        turned, arm = rounded(list(map(list, matrix(exact.turn(joint.attitude))))), np.array(joint.position, dtype=Wide)
        parent = ends[joint.parent]
        ends[joint.child] = _append_elements(elements, parent, turned, arm, _steps(joint), first, second, joint)
    inertias = [exact.inertia(body) for body in mechanism.bodies]
    points = tuple(
        tuple((ends[body], np.array(point, dtype=Wide)) for body, point in zip(loop.bodies, loop.points, strict=True))
        for loop in mechanism.loops
    )
    carriers = [ends[body] for body in range(len(mechanism.bodies))]
    carriers += [end[0] for side in (0, 1) for end in (pair[side] for pair in points)]
    numbers = {name: np.zeros(moving, dtype=Wide) for name in ("armature", "damping", "stiffness", "rest", "effort")}
    for element in elements:
        for name, values in numbers.items():
            values[element.moving] = getattr(element.joint, name) if element.joint is not None else 0
    return Tree(
        tuple(elements),
        tuple(carriers[: len(mechanism.bodies)]),
        held,
        np.array([wide(inertia.mass) for inertia in inertias], dtype=Wide),
        np.array([rounded(list(inertia.centre)) for inertia in inertias]),
        np.array([start.tensor(body) for body in mechanism.bodies]),
        points,  # type: ignore[arg-type]
        np.array([_moving_velocities(elements, index, moving) for index in carriers], dtype=Wide),
        Wide(mechanism.gravity),
        *(numbers[name] for name in ("armature", "damping", "stiffness", "rest", "effort")),
    )


def joint_sizes(mechanism: Mechanism) -> tuple[int, int]:
    """The numbers of coordinates and of velocities of the joints, which come before those of free bodies."""
    held, moving = (sum(size[joint.type] for joint in mechanism.joints) for size in (COORDINATES, VELOCITIES))
    return held, moving


def _steps(joint: Joint | None) -> list[tuple[Kind, WideArray]]:
    """The elements of a joint, or of a free body, and their axes; a ball needs none."""
    form = JOINT_TYPES["free"] if joint is None else joint.form
    direction = rounded(list(exact.unit_axis(joint))) if joint is not None and form.has_axis else _EYE[2]
    steps: list[tuple[Kind, WideArray]] = [(motion.kind, _AXES.get(motion.axis, direction)) for motion in form.motions]
    return steps or [("fixed", direction)]


def _append_elements(
    elements: list[Element],
    parent: int,
    turned: WideArray,
    arm: WideArray,
    steps: list[tuple[Kind, WideArray]],
    held: int,
    moving: int,
    joint: Joint | None,
) -> int:
    """Append the elements of a joint, and return the place of the last one."""
    for kind, axis in steps:
        coordinates, velocities = {"ball": (4, 3), "fixed": (0, 0)}.get(kind, (1, 1))
        slices = slice(held, held + coordinates), slice(moving, moving + velocities)
        elements.append(Element(kind, parent, turned, arm, axis, *slices, joint))
        parent, turned, arm = len(elements) - 1, _EYE, _HERE
        held, moving = held + coordinates, moving + velocities
    return parent


def _moving_velocities(elements: list[Element], index: int, count: int) -> WideArray:
    """Return one for each of the velocities (u,) that moves an element, and zero for the others."""
    moves = np.zeros(count, dtype=Wide)
    while index != WORLD:
        moves[elements[index].moving] = 1
        index = elements[index].parent
    return moves


def initial(mechanism: Mechanism) -> WideArray:
    """The coordinates and velocities (c + u,) at the start."""
    held: list[Any] = []
    moving: list[Any] = []
    for joint in mechanism.joints:
        values = [Wide(value) for value in joint.start]
        if joint.form.has_quaternion:
            w, x, y, z = joint.start[-4:]
            values[-4:] = list(rounded(list(exact.turn((w, x, y, z)))))
        held, moving = [*held, *values], [*moving, *(Wide(value) for value in joint.start_velocity)]
    frames = start.frames(mechanism)
    for body, jointed_body in enumerate(mechanism.bodies):
        if mechanism.joint_of[body] is None and jointed_body.start is not None:
            frame = frames[body]
            held += [*frame.origin, *rounded(list(exact.turn(jointed_body.start.attitude)))]
            moving += [*frame.velocity, *(frame.turn.T @ frame.spin)]
    return np.array([*held, *moving], dtype=Wide)


def frame_motion(linkage: Tree, states: WideArray) -> Motion:
    """The motion of all frames at states (s, c + u)."""
    count, velocities = len(states), len(linkage.inertia)
    q, v = states[:, : linkage.coordinates], states[:, linkage.coordinates :]
    still = np.zeros((count, 3), dtype=Wide)
    motion = Motion([], [], [], [], [], [], *(np.zeros((count, velocities, 3), dtype=Wide) for _ in range(3)))
    world = (np.broadcast_to(_EYE, (count, 3, 3)), still, still, still, still, still)
    parts = (motion.axes, motion.origin, motion.spin, motion.velocity, motion.turn_bias, motion.bias)
    for element in linkage.elements:
        axes, origin, spin, velocity, turn_bias, bias = (
            world if element.parent == WORLD else tuple(part[element.parent] for part in parts)
        )
        arm = apply(axes, element.arm)
        axes = axes @ element.turned
        coordinates, rate = q[:, element.held], v[:, element.moving]
        slid = turned = still
        match element.kind:
            case "slide":
                along = apply(axes, element.axis)
                motion.slides[:, element.moving.start] = along
                arm, slid = arm + along * coordinates, along * rate
            case "turn":
                along = apply(axes, element.axis)
                motion.turns[:, element.moving.start] = along
                axes, turned = axes @ about(element.axis, coordinates[:, 0]), along * rate
            case "ball":
                axes = axes @ matrices(coordinates)
                motion.turns[:, element.moving] = np.swapaxes(axes, 1, 2)
                turned = apply(axes, rate)
        around = cross(spin, arm)
        motion.centres[:, element.moving] = (origin + arm)[:, None]
        values = (
            axes,
            origin + arm,
            spin + turned,
            velocity + around + slid,
            turn_bias + cross(spin, turned),
            bias + cross(turn_bias, arm) + cross(spin, around + 2 * slid),
        )
        for part, value in zip(parts, values, strict=True):
            part.append(value)
    return motion


def _at(motion: Motion, element: int, point: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """Place, velocity and acceleration without those of the coordinates (s, 3) of a point (3,) in the frame of an element."""
    if element == WORLD:
        still = np.zeros((len(motion.turns), 3), dtype=Wide)
        return still + point, still, still
    arm = apply(motion.axes[element], point)
    spin = motion.spin[element]
    around = cross(spin, arm)
    bias = motion.bias[element] + cross(motion.turn_bias[element], arm) + cross(spin, around)
    return motion.origin[element] + arm, motion.velocity[element] + around, bias


def _rows(linkage: Tree, motion: Motion, row: int, position: WideArray) -> WideArray:
    """The velocities (s, u, 3) of a point at a place (s, 3) for each velocity; row: its row in `Tree.along`."""
    rows: WideArray = (motion.slides + cross(motion.turns, position[:, None] - motion.centres)) * linkage.along[row][:, None]
    return rows


def _loops(linkage: Tree, motion: Motion) -> tuple[WideArray, WideArray, WideArray, WideArray]:
    """Of the loops: gaps, their rates and their accelerations without those of coordinates (s, 3 l), and rows (s, 3 l, u)."""
    count, bodies, loops = len(motion.turns), len(linkage.mass), len(linkage.points)
    gaps, rates, biases, rows = ([np.zeros((count, 0), dtype=Wide)] for _ in range(4))
    rows = [np.zeros((count, 0, len(linkage.inertia)), dtype=Wide)]
    for index, (one, other) in enumerate(linkage.points):
        first, second = _at(motion, *one), _at(motion, *other)
        for part, values in enumerate((gaps, rates, biases)):
            values.append(first[part] - second[part])
        row = _rows(linkage, motion, bodies + index, first[0]) - _rows(linkage, motion, bodies + loops + index, second[0])
        rows.append(np.swapaxes(row, 1, 2))
    return np.hstack(gaps), np.hstack(rates), np.hstack(biases), np.concatenate(rows, axis=1)


def _dynamics(linkage: Tree, motion: Motion, states: WideArray) -> tuple[WideArray, WideArray]:
    """The mass matrix (s, u, u), and the forces less those of inertia without accelerations of coordinates (s, u)."""
    v = states[:, linkage.coordinates :]
    slots = np.zeros_like(v)
    for element in linkage.elements:
        if element.kind in ("turn", "slide"):
            slots[:, element.moving] = states[:, element.held]
    force = linkage.effort - linkage.damping * v - linkage.stiffness * (slots - linkage.rest)
    mass = np.zeros((*v.shape, v.shape[1]), dtype=Wide)
    mass[:, range(v.shape[1]), range(v.shape[1])] = linkage.inertia
    down = np.array([0, 0, -1], dtype=Wide) * linkage.gravity
    for body, end in enumerate(linkage.ends):
        # Those velocities alone that move the body, which are few of many in a long linkage.
        columns = np.flatnonzero(linkage.along[body])
        if not len(columns):
            continue
        axes, spin = motion.axes[end], motion.spin[end]
        arm = apply(axes, linkage.centre[body])
        tensor = axes @ linkage.tensor[body] @ np.swapaxes(axes, 1, 2)
        turns = motion.turns[:, columns]
        slides = motion.slides[:, columns] + cross(turns, (motion.origin[end] + arm)[:, None] - motion.centres[:, columns])
        push = linkage.mass[body] * (
            motion.bias[end] + cross(motion.turn_bias[end], arm) + cross(spin, cross(spin, arm)) - down
        )
        twist = apply(tensor, motion.turn_bias[end]) + cross(spin, apply(tensor, spin))
        inertia = linkage.mass[body] * (slides @ np.swapaxes(slides, 1, 2)) + turns @ tensor @ np.swapaxes(turns, 1, 2)
        mass[:, columns[:, None], columns] += inertia
        force[:, columns] -= dot(slides, push[:, None]) + dot(turns, twist[:, None])
    return mass, force


def derivatives(linkage: Tree, states: WideArray) -> WideArray:
    """The derivatives (s, c + u) of states (s, c + u)."""
    motion = frame_motion(linkage, states)
    mass, force = _dynamics(linkage, motion, states)
    _, _, bias, rows = _loops(linkage, motion)
    accelerations, _ = solved(mass, rows, force, -bias)
    return np.hstack([_coordinate_rates(linkage, states, states[:, linkage.coordinates :]), accelerations])


def _coordinate_rates(linkage: Tree, states: WideArray, v: WideArray) -> WideArray:
    """The derivatives (s, c) of the coordinates with the velocities (s, u)."""
    rates = np.zeros((len(states), linkage.coordinates), dtype=Wide)
    for element in linkage.elements:
        if element.kind == "ball":
            rates[:, element.held] = turning(states[:, element.held], v[:, element.moving])
        elif element.kind != "fixed":
            rates[:, element.held] = v[:, element.moving]
    return rates


def close_loops(linkage: Tree, state: WideArray) -> WideArray:
    """A state (c + u,) moved back to where the loops are closed and their rates are zero, by the smallest changes."""
    states = state[None].copy()
    c = linkage.coordinates
    for element in linkage.elements:
        if element.kind == "ball":
            states[:, element.held] /= np.sqrt((states[:, element.held] ** 2).sum())
    motion = frame_motion(linkage, states)
    mass, force = _dynamics(linkage, motion, states)
    gaps, _, _, rows = _loops(linkage, motion)
    shift, _ = solved(mass, rows, np.zeros_like(force), -gaps, refinements=2)
    states[:, :c] += _coordinate_rates(linkage, states, shift)
    _, rates, _, rows = _loops(linkage, frame_motion(linkage, states))
    change, _ = solved(mass, rows, np.zeros_like(force), -rates, refinements=2)
    states[:, c:] += change
    closed: WideArray = states[0]
    return closed


def gaps(linkage: Tree, states: WideArray) -> tuple[WideArray, WideArray]:
    """Return the largest distances (s,) between the ends of loops (m), and the rates of these (m/s), at states (s, c + u)."""
    distances, rates, _, _ = _loops(linkage, frame_motion(linkage, states))
    return np.abs(distances).max(axis=1, initial=0), np.abs(rates).max(axis=1, initial=0)


def bodies(linkage: Tree, states: WideArray) -> tuple[WideArray, WideArray, WideArray, WideArray]:
    """Position, quaternion, velocity and angular velocity (b, s, k) of the bodies: the conventions of `trajectory`."""
    motion = frame_motion(linkage, states)
    rows: list[tuple[WideArray, ...]] = []
    for body, end in enumerate(linkage.ends):
        position, velocity, _ = _at(motion, end, linkage.centre[body])
        axes = np.broadcast_to(_EYE, (len(states), 3, 3)) if end == WORLD else motion.axes[end]
        spin = np.zeros((len(states), 3), dtype=Wide) if end == WORLD else motion.spin[end]
        rows.append((position, quaternion_of(axes), velocity, apply(np.swapaxes(axes, 1, 2), spin)))
    first, second, third, fourth = (np.array([row[part] for row in rows]) for part in range(4))
    return first, second, third, fourth
