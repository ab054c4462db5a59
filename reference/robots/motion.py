"""The frames of the links of a robot model at several states, and the velocities of the links for each joint velocity."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.kinematics import about, cross, multiply, normalise
from bodycheck.reference.robots.model import RobotJoint, RobotModel, Wide, from_the_root
from bodycheck.reference.robots.rotations import matrices, plane_axes, quaternion
from bodycheck.reference.robots.state import VELOCITIES, RobotState, Values

_NOTHING, _ALL = np.zeros((3, 3), np.longdouble), np.eye(3, dtype=np.longdouble)


@dataclass(frozen=True, eq=False)
class PlacedLink:
    """A link at n states. All components are along the world's axes.

    Attributes
    ----------
    index
        The index of the link in the model.
    parent
        The index of its parent among the placed links; -1 for the root.
    columns
        The indices of its joint's k velocities among all velocities.
    turn, origin
        Unit quaternions (n, 4) from the link's axes to the world's, and the origins (n, 3) of its frame (m).
    arm
        The vectors (n, 3) from the origin of its parent to its own origin (m).
    slides, spins
        The velocities (n, k, 3) of its origin and the angular velocities (n, k, 3), relative to the parent, for unit velocities
        of its joint.
    mass, centre, tensor
        The mass (kg), the vectors (n, 3) from its origin to its centre of mass (m), and the inertia (n, 3, 3) about the centre
        of mass (kg m^2).
    """

    index: int
    parent: int
    columns: slice
    turn: Wide
    origin: Wide
    arm: Wide
    slides: Wide
    spins: Wide
    mass: np.longdouble
    centre: Wide
    tensor: Wide


def columns(model: RobotModel) -> dict[str, slice]:
    """The indices of the velocities of each joint, by its name, among all velocities, which are in the order of the file."""
    slices: dict[str, slice] = {}
    first = 0
    for joint in model.joints:
        after = first + VELOCITIES[joint.type]
        slices[joint.name] = slice(first, after)
        first = after
    return slices


def placed(model: RobotModel, states: Sequence[RobotState]) -> tuple[PlacedLink, ...]:
    """The links of a model at n states, the root first, each after its parent. Raises `ValueError` as `from_the_root` does."""
    return tuple(_placed(model, states))


def _placed(model: RobotModel, states: Sequence[RobotState]) -> Iterator[PlacedLink]:
    count, held = len(states), columns(model)
    still, origin = np.tile(np.array([1, 0, 0, 0], np.longdouble), (count, 1)), np.zeros((count, 3), np.longdouble)
    axes, nothing = matrices(still), np.zeros((count, 0, 3), np.longdouble)
    root = _link(model, model.root, still, axes)
    yield PlacedLink(model.root, -1, slice(0, 0), still, origin, origin, nothing, nothing, *root)
    frames, places = {model.root: (still, origin, axes)}, {model.root: 0}
    for index, joint in enumerate(from_the_root(model), start=1):
        turn, origin, axes = frames[joint.parent]
        shift, turned = displaced(joint, rows(states, joint, lambda state: state.positions))
        socket, slides, spins = axes @ joint.rotation, *directions(joint)
        arm = axes @ joint.position + each(socket, shift)
        before = multiply(turn, np.tile(quaternion(joint.rotation), (count, 1)))
        turn = normalise(multiply(before, turned))
        axes = matrices(turn)
        frames[joint.child], places[joint.child] = (turn, origin + arm, axes), index
        yield PlacedLink(
            joint.child,
            places[joint.parent],
            held[joint.name],
            turn,
            origin + arm,
            arm,
            slides @ np.swapaxes(socket, 1, 2),
            spins @ np.swapaxes(axes, 1, 2),
            *_link(model, joint.child, turn, axes),
        )


def _link(model: RobotModel, index: int, turn: Wide, axes: Wide) -> tuple[np.longdouble, Wide, Wide]:
    """Mass, centre of mass and inertia of a link along the world's axes. turn, axes: attitudes (n, 4) and (n, 3, 3)."""
    link = model.links[index]
    return np.longdouble(link.mass), axes @ link.center_of_mass, axes @ link.inertia @ np.swapaxes(axes, 1, 2)


def rows(states: Sequence[RobotState], joint: RobotJoint, part: Callable[[RobotState], Values]) -> Wide:
    """The numbers (n, k) of a joint at n states: its positions, or another quantity that `part` selects from a state."""
    if not VELOCITIES[joint.type]:
        return np.zeros((len(states), 0), np.longdouble)
    return np.array([part(state)[joint.name] for state in states], np.longdouble)


def displaced(joint: RobotJoint, position: Wide) -> tuple[Wide, Wide]:
    """Return the shift (n, 3), m, of a joint's child in the joint's frame, and quaternions (n, 4) from child to joint.

    position: (n, c) coordinates of the joint; a quaternion may have any length.
    """
    count = len(position)
    shift, still = np.zeros((count, 3), np.longdouble), np.tile(np.array([1, 0, 0, 0], np.longdouble), (count, 1))
    match joint.type:
        case "revolute":
            return shift, about(joint.axis, position[:, 0])
        case "prismatic":
            return position * joint.axis, still
        case "planar":
            return position[:, :2] @ plane_axes(joint.axis)[:, :2].T, about(joint.axis, position[:, 2])
        case "spherical":
            return shift, normalise(position)
        case "floating":
            return position[:, :3], normalise(position[:, 3:])
        case "fixed":
            return shift, still


def directions(joint: RobotJoint) -> tuple[Wide, Wide]:
    """The velocities of a joint's child relative to the joint's frame, for a unit value of each of the joint's k velocities.

    Returns the velocities (k, 3) of the child's origin, along the axes of the joint's frame, and the angular velocities (k, 3),
    along the axes of the child.
    """
    nothing, axis = _NOTHING[:1], joint.axis[None]
    match joint.type:
        case "revolute":
            return nothing, axis
        case "prismatic":
            return axis, nothing
        case "planar":
            x, y, normal = plane_axes(joint.axis).T[:, None]
            return np.concatenate([x, y, nothing]), np.concatenate([nothing, nothing, normal])
        case "spherical":
            return _NOTHING, _ALL
        case "floating":
            return np.concatenate([_ALL, _NOTHING]), np.concatenate([_NOTHING, _ALL])
        case "fixed":
            return _NOTHING[:0], _NOTHING[:0]


def poses(links: Sequence[PlacedLink], names: Sequence[str]) -> Mapping[str, Wide]:
    """Position (m) and unit quaternion w, x, y, z (n, 7) of each link's frame, by its name. names: of the model's links."""
    return {names[link.index]: np.concatenate([link.origin, link.turn], axis=1) for link in links}


def velocity_maps(links: Sequence[PlacedLink], count: int) -> list[tuple[Wide, Wide]]:
    """For each link, velocities of its origin and angular velocities, both (n, count, 3), per unit of each joint velocity."""
    maps: list[tuple[Wide, Wide]] = []
    for link in links:
        if link.parent < 0:
            linear = angular = np.zeros((len(link.turn), count, 3), np.longdouble)
        else:
            linear, angular = maps[link.parent]
            linear, angular = linear + cross(angular, link.arm[:, None]), angular.copy()
            linear[:, link.columns], angular[:, link.columns] = link.slides, link.spins
        maps.append((linear, angular))
    return maps


def jacobians(links: Sequence[PlacedLink], maps: Sequence[tuple[Wide, Wide]], names: Sequence[str]) -> Mapping[str, Wide]:
    """Jacobians (n, 6, k) of the origin of each link's frame, linear rows first, by its name. maps: from `velocity_maps`."""
    return {
        names[link.index]: np.concatenate([np.swapaxes(linear, 1, 2), np.swapaxes(angular, 1, 2)], axis=1)
        for link, (linear, angular) in zip(links, maps, strict=True)
    }


def each(matrices: Wide, vectors: Wide) -> Wide:
    """Matrices (n, 3, 3) times vectors (n, 3)."""
    return np.asarray((matrices @ vectors[..., None])[..., 0])
