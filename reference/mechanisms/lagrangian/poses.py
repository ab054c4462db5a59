"""The motion of joints and bodies from the states of the Lagrangian's equations, in the floating-point type of the states."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.independent.arithmetic import wide
from bodycheck.reference.independent.directions import quaternion_of
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms.lagrangian.border import Border, Carried, Element
from bodycheck.reference.mechanisms.lagrangian.structure import Structure, Units


@dataclass(frozen=True, eq=False)
class WideMotion:
    """The motion of a mechanism of b bodies at n instants, in a floating-point type that may be wider than double.

    Attributes
    ----------
    joint_position, joint_velocity
        (n, c) coordinates and (n, u) velocities of the joints, in the layout of `coordinates`.
    position, quaternion, velocity, angular_velocity
        (b, n, k) states of the bodies, in the conventions of `trajectory.Trajectory`.
    """

    joint_position: WideArray
    joint_velocity: WideArray
    position: WideArray
    quaternion: WideArray
    velocity: WideArray
    angular_velocity: WideArray


@dataclass(frozen=True, eq=False)
class _Frame:
    """The motion of the frame of an element at n instants.

    Its axes as columns (n, 3, 3), its origin (n, 3) and the velocity of the origin (n, 3), in the world, and its angular
    velocity along its own axes (n, 3).
    """

    axes: WideArray
    origin: WideArray
    velocity: WideArray
    omega: WideArray


def motion(border: Border, structure: Structure, units: Units, t: WideArray, states: WideArray, bodies: int) -> WideMotion:
    """The motion of a mechanism from the states (n, k) of its equations at times t (n,), s, in the type of the states."""
    dtype = states.dtype.type
    coordinates = structure.places[-1][0].stop if structure.places else 0
    in_si = [
        _in_si(element, states[:, held], states[:, coordinates:][:, moving], units)
        for element, (held, moving) in zip(border.elements, structure.places, strict=True)
    ]
    frames: list[_Frame] = []
    joints: dict[int, list[tuple[WideArray, WideArray]]] = {}
    nothing = _standing(len(t), dtype)
    for index, element in enumerate(border.elements):
        q, u = _led(border, structure, in_si, index)
        parent = nothing if element.parent is None else frames[element.parent]
        landed = _landed(element, border.gravity, t)
        frames.append(_moved(element, parent, q, u, landed))
        if element.joint is not None:
            if element.kind == "free":
                q, u = np.hstack([q[:, :3] + landed[0], q[:, 3:]]), np.hstack([u[:, :3] + landed[1], u[:, 3:]])
            joints.setdefault(element.joint, []).append((q, u))
    empty = (np.empty((len(t), 0), dtype), np.empty((len(t), 0), dtype))
    ordered = [empty, *(pair for joint in sorted(joints) for pair in joints[joint])]
    states_of: dict[int, tuple[WideArray, ...]] = {carried.body: _body(carried, nothing) for carried in border.standing}
    for element, frame in zip(border.elements, frames, strict=True):
        states_of |= {carried.body: _body(carried, frame) for carried in element.carried}
    return WideMotion(
        *(np.concatenate([pair[part] for pair in ordered], axis=1) for part in (0, 1)),
        *(np.stack([states_of[body][part] for body in range(bodies)]) for part in range(4)),
    )


def _standing(n: int, dtype: Any) -> _Frame:
    none = np.zeros((n, 3), dtype)
    return _Frame(np.broadcast_to(np.eye(3, dtype=dtype), (n, 3, 3)), none, none, none)


def _led(
    border: Border, structure: Structure, in_si: list[tuple[WideArray, WideArray]], index: int
) -> tuple[WideArray, WideArray]:
    """The coordinates and velocities of an element, in SI units, from those of the element that it may follow."""
    rule, leader = border.elements[index].rule, structure.follows[index]
    if rule is None or leader is None:
        return in_si[index]
    q, u = _led(border, structure, in_si, leader)
    factor, term = _rounded([rule[1:]], q.dtype.type)[0]
    return factor * q + term, factor * u


def _in_si(element: Element, q: WideArray, u: WideArray, units: Units) -> tuple[WideArray, WideArray]:
    """Convert coordinates and velocities to SI units. The factors are powers of two."""
    kind = q.dtype.type
    lengths = {"slide": 1, "free": 3}.get(element.kind, 0)
    held, moving = np.ones(q.shape[1], kind), np.full(u.shape[1], 1 / kind(units.time))
    held[:lengths] = units.length
    moving[:lengths] *= kind(units.length)
    return q * held, u * moving


def _landed(element: Element, gravity: float, t: WideArray) -> tuple[WideArray, WideArray]:
    """Position and velocity (n, 3) of the origin of a falling frame in the element's zero frame; zero for other elements."""
    dtype = t.dtype.type
    if not element.falls or element.parent is not None:
        return np.zeros((len(t), 3), dtype), np.zeros((len(t), 3), dtype)
    position, speed = (_rounded([values], dtype)[0] for values in element.fallen)
    down = -dtype(gravity) * _rounded(element.turned, dtype)[:, 2]
    instants = t[:, None]
    return position + instants * (speed + instants * down / 2), speed + instants * down


def _moved(element: Element, parent: _Frame, q: WideArray, u: WideArray, landed: tuple[WideArray, WideArray]) -> _Frame:
    """The frame of an element from the frame of its parent. landed: position and velocity of the falling frame's origin."""
    dtype = q.dtype.type
    turned, arm = _rounded(element.turned, dtype), _rounded([element.origin], dtype)[0]
    axes = parent.axes @ turned.T
    slid, slides = landed
    omega = parent.omega @ turned.T
    rotation: WideArray | None = None
    turning = np.zeros_like(slid)
    match element.kind:
        case "turn":
            c, s, zero, one = np.cos(q[:, 0]), np.sin(q[:, 0]), np.zeros(len(q), dtype), np.ones(len(q), dtype)
            rotation = np.array([[c, -s, zero], [s, c, zero], [zero, zero, one]])
            turning = np.stack([zero, zero, u[:, 0]], axis=1)
        case "slide":
            slid = slid + np.array([0, 0, 1], dtype) * q
            slides = slides + np.array([0, 0, 1], dtype) * u
        case "ball":
            rotation, turning = _matrix(q), u
        case "free":
            slid, slides, rotation, turning = slid + q[:, :3], slides + u[:, :3], _matrix(q[:, 3:]), u[:, 3:]
    origin = parent.origin + _turn(parent.axes, arm) + _turn(axes, slid)
    velocity = parent.velocity + _turn(parent.axes, np.cross(parent.omega, arm)) + _turn(axes, np.cross(omega, slid) + slides)
    if rotation is not None:
        cosines = np.moveaxis(rotation, 2, 0)
        axes, omega = axes @ cosines, np.einsum("nji,nj->ni", cosines, omega)
    return _Frame(axes, origin, velocity, omega + turning)


def _body(carried: Carried, frame: _Frame) -> tuple[WideArray, ...]:
    """Position, quaternion, velocity and angular velocity, each (n, k), of a body that an element carries."""
    dtype = frame.origin.dtype.type
    centre, axes = _rounded([carried.centre], dtype)[0], _rounded(carried.axes, dtype)
    position = frame.origin + _turn(frame.axes, centre)
    velocity = frame.velocity + _turn(frame.axes, np.cross(frame.omega, centre))
    return position, quaternion_of(frame.axes @ axes), velocity, frame.omega @ axes


def _matrix(quaternion: WideArray) -> WideArray:
    """The matrices (3, 3, n) of quaternions (n, 4)."""
    w, x, y, z = (quaternion / np.sqrt((quaternion * quaternion).sum(axis=1))[:, None]).T
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _turn(axes: WideArray, vectors: WideArray) -> WideArray:
    """Components (n, 3) in the world of vectors (n, 3) or (3,) along axes (n, 3, 3)."""
    return np.asarray((axes * vectors[..., None, :]).sum(axis=2))


def _rounded(rows: Any, dtype: Any) -> WideArray:
    """An array of rows of exact numbers, rounded to a floating-point type."""
    if dtype is np.float64:
        return np.array([[float(value) for value in row] for row in rows])
    return np.array([[wide(value) for value in row] for row in rows], dtype)
