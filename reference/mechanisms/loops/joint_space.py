"""Mechanisms with loops in the coordinates of their joints: the mass matrix of the tree, and multipliers for the loops.

Each joint consists of turns, slides and balls; a free body has three slides and a ball. The accelerations of bodies are linear
in the accelerations of the coordinates, a = J q'' + b, so that d'Alembert's principle gives

    sum over bodies of  Jv^T m (Jv q'' + bv - g) + Jw^T (I (Jw q'' + bw) + w x I w) = tau + J_loop^T forces.

The frames at the start come from `start`.
"""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import Wide, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.kinematics import cross, dot
from bodycheck.reference.mechanisms import exact, start
from bodycheck.reference.mechanisms.coordinates import COORDINATES, VELOCITIES, places
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, MotionKind
from bodycheck.reference.mechanisms.kinematics import from_the_root
from bodycheck.reference.mechanisms.loops.minimum_norm import solved
from bodycheck.reference.mechanisms.loops.vectors import about, apply, matrices, quaternions, rounded, turning
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism

_EYE = np.eye(3, dtype=Wide)
_HERE = np.zeros(3, dtype=Wide)
_AXES = dict(zip("xyz", _EYE, strict=True))

#: The kind of an element: an elementary motion, or "fixed" for no motion.
Kind = MotionKind | Literal["fixed"]


@dataclass(frozen=True, eq=False)
class Element:
    """A part of a joint.

    Attributes
    ----------
    kind, parent
        Its kind, and the index of the element before it; `WORLD` if there is none.
    turned, arm
        Its axes as columns (3, 3) and its origin (3,), m, in the frame of the element before it.
    axis
        (3,) its axis in its own frame.
    held, moving
        The slices of its coordinates and velocities among those of the mechanism.
    joint
        The joint to which it belongs, and whose forces act along it; None for a free body.
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
    """A mechanism of b bodies and l loops with c coordinates and u velocities, including those of free bodies.

    Attributes
    ----------
    elements, ends
        The elements, each after its parent, and the index of the element that carries each body.
    coordinates
        The number c of coordinates.
    mass, centre, tensor
        Masses (b,), kg, centres of mass (b, 3), m, and inertia tensors (b, 3, 3), kg m^2, of the bodies, in their frames.
    points
        The two ends of each loop, each as the index of an element and a point (3,) in its frame (m).
    along
        (b + 2 l, u) 1 where a velocity moves a body, then the first ends of the loops, then the second ends; else 0.
    gravity
        The gravitational acceleration, along -z (m/s^2).
    inertia, damping, stiffness, rest, effort
        (u,) armature, and the parameters of the force along the coordinate of each velocity, as in `mechanism.Joint`.
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
        For each element (s, 3, 3) axes as columns, and (s, 3) origins (m).
    spin, velocity, turn_bias, bias
        For each element (s, 3) angular velocity, velocity of the origin, and the parts of their derivatives without
        accelerations of coordinates.
    turns, slides, centres
        (s, u, 3) angular velocity and velocity of the element for a unit value of each velocity, and a point on the axis of
        rotation (m).
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
    """The tree of a mechanism. Raises `NotModelled` if it has dry friction."""
    if any(joint.friction for joint in mechanism.joints):
        raise NotModelled("dry friction in a mechanism with loops", "dry friction")
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
    """The numbers of coordinates and of velocities of the joints. In states these come before those of free bodies."""
    held, moving = (sum(size[joint.type] for joint in mechanism.joints) for size in (COORDINATES, VELOCITIES))
    return held, moving


def _steps(joint: Joint | None) -> list[tuple[Kind, WideArray]]:
    """The kinds of the elements of a joint, or of a free body, each with its axis; the axis of a ball is not used."""
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
    """Append the elements of a joint, and return the index of the last element."""
    for kind, axis in steps:
        coordinates, velocities = {"ball": (4, 3), "fixed": (0, 0)}.get(kind, (1, 1))
        slices = slice(held, held + coordinates), slice(moving, moving + velocities)
        elements.append(Element(kind, parent, turned, arm, axis, *slices, joint))
        parent, turned, arm = len(elements) - 1, _EYE, _HERE
        held, moving = held + coordinates, moving + velocities
    return parent


def _moving_velocities(elements: list[Element], index: int, count: int) -> WideArray:
    """Return 1 for each velocity (u,) that moves an element, and 0 for the other velocities."""
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
    """Position, velocity and acceleration (s, 3) of a point (3,) of an element, without accelerations of the coordinates."""
    if element == WORLD:
        still = np.zeros((len(motion.turns), 3), dtype=Wide)
        return still + point, still, still
    arm = apply(motion.axes[element], point)
    spin = motion.spin[element]
    around = cross(spin, arm)
    bias = motion.bias[element] + cross(motion.turn_bias[element], arm) + cross(spin, around)
    return motion.origin[element] + arm, motion.velocity[element] + around, bias


def _rows(linkage: Tree, motion: Motion, row: int, position: WideArray) -> WideArray:
    """The velocities (s, u, 3) of a point at a position (s, 3), for a unit value of each velocity.

    row: the row in `Tree.along` of the body or loop end to which the point belongs.
    """
    rows: WideArray = (motion.slides + cross(motion.turns, position[:, None] - motion.centres)) * linkage.along[row][:, None]
    return rows


def _loops(linkage: Tree, motion: Motion) -> tuple[WideArray, WideArray, WideArray, WideArray]:
    """Gaps of loops, rates, accelerations without those of coordinates, each (s, 3 l), and the gaps' Jacobian (s, 3 l, u)."""
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
    """The mass matrix (s, u, u), and the forces (s, u) minus the inertial forces without accelerations of coordinates."""
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
        # Only the velocities that move the body count: in a long linkage these are few.
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


def derivatives(linkage: Tree, states: WideArray, pushed: WideArray | None = None) -> WideArray:
    """The derivatives (s, c + u) of states (s, c + u). pushed: (s, u) further forces along the coordinates."""
    motion = frame_motion(linkage, states)
    mass, force = _dynamics(linkage, motion, states)
    _, _, bias, rows = _loops(linkage, motion)
    accelerations, _ = solved(mass, rows, force if pushed is None else force + pushed, -bias)
    return np.hstack([_coordinate_rates(linkage, states, states[:, linkage.coordinates :]), accelerations])


def _coordinate_rates(linkage: Tree, states: WideArray, v: WideArray) -> WideArray:
    """The derivatives (s, c) of the coordinates for velocities v (s, u)."""
    rates = np.zeros((len(states), linkage.coordinates), dtype=Wide)
    for element in linkage.elements:
        if element.kind == "ball":
            rates[:, element.held] = turning(states[:, element.held], v[:, element.moving])
        elif element.kind != "fixed":
            rates[:, element.held] = v[:, element.moving]
    return rates


def close_loops(linkage: Tree, state: WideArray) -> WideArray:
    """A state (c + u,), corrected by the smallest changes such that the loops are closed and their gaps have no rates."""
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
    """Return the largest components (s,) of gaps of loops (m) and of their rates (m/s), at states (s, c + u)."""
    distances, rates, _, _ = _loops(linkage, frame_motion(linkage, states))
    return np.abs(distances).max(axis=1, initial=0), np.abs(rates).max(axis=1, initial=0)


def bodies(linkage: Tree, states: WideArray) -> tuple[WideArray, WideArray, WideArray, WideArray]:
    """Position, quaternion, velocity and angular velocity (b, s, k) of the bodies, as in `trajectory.Trajectory`."""
    motion = frame_motion(linkage, states)
    rows: list[tuple[WideArray, ...]] = []
    for body, end in enumerate(linkage.ends):
        position, velocity, _ = _at(motion, end, linkage.centre[body])
        axes = np.broadcast_to(_EYE, (len(states), 3, 3)) if end == WORLD else motion.axes[end]
        spin = np.zeros((len(states), 3), dtype=Wide) if end == WORLD else motion.spin[end]
        rows.append((position, quaternions(axes), velocity, apply(np.swapaxes(axes, 1, 2), spin)))
    first, second, third, fourth = (np.array([row[part] for row in rows]) for part in range(4))
    return first, second, third, fourth
