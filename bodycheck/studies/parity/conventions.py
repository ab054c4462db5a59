"""The conventions in which an engine writes velocities of joints and Jacobians, determined by trying.

An engine may write the velocity of a floating joint with the angular part first, along the axes of the joint's frame, of the
child or of the parent, which is often the world, and for one of three points. None of this is a difference in mechanics. The
Jacobians of the bodies decide, and where an engine has none, the block of the mass matrix that belongs to the joint.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Literal, get_args

import numpy as np

from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.rotations import matrices
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.quantities import Quantity
from bodycheck.studies.parity.rotations import crossing
from bodycheck.studies.parity.stacks import Stack, transposed

Frame = Literal["joint", "child", "parent"]
Point = Literal["origin", "center of mass", "origin of the joint"]
Axes = Literal["world", "body"]
BodyPoint = Literal["origin", "center of mass", "world"]

#: Difference, relative to the size of a Jacobian or mass matrix, up to which a convention counts as the engine's.
ALIKE = 1e-6

#: The number of probe states, at which conventions are decided and nothing is compared.
PROBES = 3

#: The form in which an engine takes efforts or accelerations: as in the state, where they belong to the velocities of the file,
#: or converted to its own velocities.
Given = Literal["as in the state", "converted", "converted without its derivative"]


@dataclass(frozen=True)
class Written:
    """The convention in which the velocity of a joint is written. The default is that of `RobotState`.

    Parameters
    ----------
    linear, angular
        The axes of the components: those of the joint's frame in the parent, those of the child, or those of the parent.
    point
        The point whose linear velocity is written.
    angular_first
        Whether the angular part comes first.
    """

    linear: Frame = "joint"
    angular: Frame = "child"
    point: Point = "origin"
    angular_first: bool = False


#: The axes that are tried for linear and for angular parts, those of `RobotState` first.
_LINEAR: tuple[Frame, ...] = ("joint", "child", "parent")
_ANGULAR: tuple[Frame, ...] = ("child", "joint", "parent")

#: The forms that are tried for each type of joint with several velocities, the form of `RobotState` first.
CANDIDATES: Mapping[str, tuple[Written, ...]] = {
    "floating": tuple(
        Written(linear, angular, point, first)
        for point, first, linear, angular in product(get_args(Point), (False, True), _LINEAR, _ANGULAR)
    ),
    "spherical": tuple(Written(angular=angular) for angular in _ANGULAR),
    "planar": tuple(Written(linear, angular_first=first) for first, linear in product((False, True), _LINEAR[:2])),
}


@dataclass(frozen=True)
class JacobianFrame:
    """The convention in which the Jacobian of a body is written. The default is that of `Terms`.

    Parameters
    ----------
    axes
        The axes of the components.
    point
        The point of the body to which the linear velocity belongs; "world" is the point that coincides with the world's origin.
    angular_first
        Whether the rows of the angular velocity come first.
    """

    axes: Axes = "world"
    point: BodyPoint = "origin"
    angular_first: bool = False


JACOBIAN_FRAMES = tuple(
    JacobianFrame(axes, point, first) for point, first, axes in product(get_args(BodyPoint), (False, True), get_args(Axes))
)


@dataclass(frozen=True)
class Convention:
    """The conventions of an engine for velocities (by the name of the joint), Jacobians, efforts and accelerations."""

    joints: Mapping[str, Written] = field(default_factory=dict)
    jacobians: JacobianFrame = field(default_factory=JacobianFrame)
    efforts: Given = "converted"
    accelerations: Given = "converted"
    followers_have_efforts: bool = True

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences that describe the convention; empty if it is the one that bodycheck uses."""
        return (*self._velocities, *self._jacobians, *self._efforts, *self._accelerations)

    def of(self, quantity: Quantity) -> str:
        """Return a description of the convention of a quantity; empty if it is the one that bodycheck uses."""
        parts = {"jacobian": self._jacobians, "forward_dynamics": self._efforts, "inverse_dynamics": self._accelerations}
        return "" if quantity == "pose" else "; ".join((*self._velocities, *parts.get(quantity, ())))

    @property
    def _velocities(self) -> tuple[str, ...]:
        written_otherwise = [(name, form) for name, form in self.joints.items() if form != Written()]
        return tuple(f"it writes the velocity of {name} as {_words(form)}" for name, form in written_otherwise)

    @property
    def _jacobians(self) -> tuple[str, ...]:
        frame = self.jacobians
        if frame == JacobianFrame():
            return ()
        point = {"origin": "the frame's origin", "center of mass": "the centre of mass", "world": "the world's origin"}
        rows = "angular rows first, " if frame.angular_first else ""
        return (f"its Jacobians are along the axes of the {frame.axes}, {rows}for {point[frame.point]}",)

    @property
    def _efforts(self) -> tuple[str, ...]:
        converted = (f"the efforts of its forward dynamics are {self.efforts}",) if self._velocities else ()
        return (*converted, *(() if self.followers_have_efforts else ("its joints that follow others have no efforts",)))

    @property
    def _accelerations(self) -> tuple[str, ...]:
        return (f"the accelerations of its inverse dynamics are {self.accelerations}",) if self._velocities else ()


def _words(form: Written) -> str:
    first = "the angular part first, " if form.angular_first else ""
    return (
        f"{first}the linear part of the {form.point} along the {form.linear}'s axes, the angular one along the {form.angular}'s"
    )


def written(model: RobotModel, name: str, states: Sequence[RobotState], how: Written) -> tuple[Array, Array]:
    """Return the matrices (s, k, k) that convert a joint's velocity from that of `RobotState` to `how`, and their derivatives.

    model: the model with the bodies of the engine, whose centres of mass may be the points of the velocities.
    """
    joint = next(one for one in model.joints if one.name == name)
    position = np.array([state.positions[name] for state in states])
    velocity, socket = np.array([state.velocities[name] for state in states]), np.asarray(joint.rotation, np.float64)
    match joint.type:
        case "spherical":
            return _turning(how.angular, socket, matrices(position), velocity)
        case "planar":
            return _planar(position, velocity, how)
        case _:
            centre = np.asarray(model.links[joint.child].center_of_mass, np.float64)
            return _floating(position, velocity, centre, socket, how)


def _turning(axes: Frame, socket: Array, turn: Array, spin: Array) -> tuple[Array, Array]:
    """Return the matrices (s, 3, 3) from components along the child's axes to components along `axes`, and their derivatives.

    socket (3, 3): the rotation of the joint's frame in the parent's. turn (s, 3, 3): the rotation of the child's frame in the
    joint's. spin (s, 3): the angular velocity of the child along its own axes (rad/s).
    """
    match axes:
        case "child":
            return np.broadcast_to(np.eye(3), turn.shape), np.zeros_like(turn)
        case "joint":
            return turn, turn @ crossing(spin)
        case "parent":
            return socket @ turn, socket @ turn @ crossing(spin)


def _planar(position: Array, velocity: Array, how: Written) -> tuple[Array, Array]:
    angle, rate = position[:, 2], velocity[:, 2]
    matrix, change = np.zeros((len(angle), 3, 3)), np.zeros((len(angle), 3, 3))
    matrix[:, 2, 2] = 1.0
    if how.linear == "joint":
        matrix[:, 0, 0] = matrix[:, 1, 1] = 1.0
    else:
        cosine, sine = np.cos(angle), np.sin(angle)
        matrix[:, :2, :2] = np.stack([cosine, sine, -sine, cosine], axis=-1).reshape(-1, 2, 2)
        change[:, :2, :2] = (np.stack([-sine, cosine, -cosine, -sine], axis=-1) * rate[:, None]).reshape(-1, 2, 2)
    order = [2, 0, 1] if how.angular_first else [0, 1, 2]
    return matrix[:, order], change[:, order]


def _floating(position: Array, velocity: Array, centre: Array, socket: Array, how: Written) -> tuple[Array, Array]:
    turn = matrices(position[:, 3:])
    spin, spun = velocity[:, 3:], turn @ crossing(velocity[:, 3:])
    zero = np.zeros_like(turn)
    match how.point:
        case "origin":
            arm, moves = np.zeros_like(spin), np.zeros_like(spin)
        case "center of mass":
            arm, moves = turn @ centre, spun @ centre
        case "origin of the joint":
            arm, moves = -position[:, :3], -velocity[:, :3]
    lever, levers = -crossing(arm) @ turn, -crossing(moves) @ turn - crossing(arm) @ spun
    axes, axes_change = np.broadcast_to(np.eye(3), turn.shape), zero
    if how.linear == "child":
        axes, axes_change = transposed(turn), transposed(spun)
    elif how.linear == "parent":
        axes = np.broadcast_to(socket, turn.shape)
    turning, own_change = _turning(how.angular, socket, turn, spin)
    matrix = np.block([[axes, axes @ lever], [zero, turning]])
    change = np.block([[axes_change, axes_change @ lever + axes @ levers], [zero, own_change]])
    order = [3, 4, 5, 0, 1, 2] if how.angular_first else [0, 1, 2, 3, 4, 5]
    return matrix[:, order], change[:, order]


def in_world(jacobian: Array, poses: Array, centre: Array, how: JacobianFrame) -> Array:
    """Return the Jacobians (s, 6, n) of a body's origin along the world's axes, linear rows first, from an engine's Jacobians.

    poses: the poses (s, 7) of the body. centre: its centre of mass (3,) in its frame.
    """
    linear, angular = (jacobian[:, 3:], jacobian[:, :3]) if how.angular_first else (jacobian[:, :3], jacobian[:, 3:])
    turn = matrices(poses[:, 3:])
    if how.axes == "body":
        linear, angular = turn @ linear, turn @ angular
    if how.point == "center of mass":
        linear = linear + crossing(turn @ centre) @ angular
    elif how.point == "world":
        linear = linear - crossing(poses[:, :3]) @ angular
    return np.concatenate([linear, angular], axis=1)


def find(
    model: RobotModel, places: Mapping[str, Sequence[int]], states: Sequence[RobotState], engine: Stack, truth: Stack
) -> Convention:
    """Return the convention of an engine.

    Parameters
    ----------
    model
        The model of the file with the bodies of the engine.
    places
        The indices of the velocities of each joint with several velocities, among the compared velocities.
    states
        The probe states.
    engine, truth
        The terms of the engine at these states, in its own conventions and in the order of the file, and the true terms.
    """
    centres = {link.name: np.asarray(link.center_of_mass, np.float64) for link in model.links}
    bodies = [name for name in centres if name in engine.jacobians and name in truth.jacobians]
    ways = {name: _ways(model, name, states) for name in places}
    types = {joint.name: joint.type for joint in model.joints}
    if not bodies:
        return Convention(
            _forms({name: _by_mass(ways[name], columns, engine, truth) for name, columns in places.items()}, types)
        )
    children = {joint.name: model.links[joint.child].name for joint in model.joints}
    best, chosen = (-1, 0.0, 0.0), Convention()
    for frame in JACOBIAN_FRAMES:
        in_axes = {name: in_world(engine.jacobians[name], truth.poses[name], centres[name], frame) for name in bodies}
        misfits = {name: _by_jacobian(ways[name], children[name], columns, in_axes, truth) for name, columns in places.items()}
        joints = _forms(misfits, types)
        changes = {name: (places[name], ways[name][how]) for name, how in joints.items()}
        errors = np.array([_error(_rewritten(in_axes[name], changes), truth.jacobians[name]) for name in bodies])
        left = float(np.sum(np.where(errors < ALIKE, 0.0, np.minimum(errors, 1.0))))
        score = (int(np.sum(errors < ALIKE)), -left, -_of_masses(engine, truth, changes))
        if score > best:
            best, chosen = score, Convention(joints, frame)
    return chosen


def _ways(model: RobotModel, name: str, states: Sequence[RobotState]) -> Mapping[Written, Array]:
    """Return the forms that are tried for a joint, the default first, each with its matrices (s, k, k); see `written`."""
    joint = next(one for one in model.joints if one.name == name)
    return {how: written(model, name, states, how)[0] for how in CANDIDATES[joint.type]}


def _rewritten(jacobian: Array, changes: Mapping[str, tuple[Sequence[int], Array]]) -> Array:
    """Return matrices with columns for the velocities of the file, from matrices with columns for those of an engine."""
    rewritten = jacobian.copy()
    for places, matrix in changes.values():
        rewritten[:, :, places] = jacobian[:, :, places] @ matrix
    return rewritten


def _of_masses(engine: Stack, truth: Stack, changes: Mapping[str, tuple[Sequence[int], Array]]) -> float:
    """Return the error of mass matrices with given conventions of joints; 0 if it is rounding.

    It decides if the Jacobians do not: those of a single body fit at any point, if its velocity is that of the same point.
    """
    if engine.mass_matrix is None or truth.mass_matrix is None or not truth.mass_matrix.size:
        return 0.0
    rewritten = _rewritten(transposed(_rewritten(engine.mass_matrix, changes)), changes)
    error = _error(rewritten, truth.mass_matrix)
    return error if error >= ALIKE else 0.0


def _by_jacobian(
    ways: Mapping[Written, Array], child: str, places: Sequence[int], jacobians: Mapping[str, Array], truth: Stack
) -> dict[Written, float]:
    """Return the errors of the forms of a joint's velocity, found from the Jacobian of the body that the joint moves.

    Empty if this Jacobian is missing.
    """
    if child not in jacobians:
        return {}
    columns, expected = jacobians[child][:, :, places], truth.jacobians[child][:, :, places]
    return {how: _error(columns @ matrix, expected) for how, matrix in ways.items()}


def _by_mass(ways: Mapping[Written, Array], places: Sequence[int], engine: Stack, truth: Stack) -> dict[Written, float]:
    """Return the errors of the forms of a joint's velocity, found from its block of the mass matrix; empty without one."""
    if engine.mass_matrix is None or truth.mass_matrix is None:
        return {}
    block = np.ix_(range(len(truth.mass_matrix)), places, places)
    mass, expected = engine.mass_matrix[block], truth.mass_matrix[block]
    return {how: _error(transposed(matrix) @ mass @ matrix, expected) for how, matrix in ways.items()}


def _forms(misfits: Mapping[str, Mapping[Written, float]], types: Mapping[str, str]) -> dict[str, Written]:
    """Return the form of the velocity of each joint, from the errors of all forms of each joint.

    All joints of a type get the same form, so that a joint that is wrong by a conversion does not get a form of its own. It is
    the form that fits most of the joints up to rounding; of several such forms, it is the first with the least sum of errors.
    """
    forms = dict.fromkeys(misfits, Written())
    for joint_type in {types[name] for name in misfits}:
        joints = [errors for name, errors in misfits.items() if types[name] == joint_type and errors]
        if not joints:
            continue
        fits = {form: sum(errors[form] <= ALIKE for errors in joints) for form in joints[0]}
        sums = {form: sum(errors[form] for errors in joints) for form in joints[0] if fits[form] == max(fits.values())}
        chosen = next(form for form, error in sums.items() if error <= min(sums.values()) + ALIKE)
        forms |= {name: chosen for name in misfits if types[name] == joint_type}
    return forms


def _error(value: Array, expected: Array) -> float:
    """Return the largest difference, relative to the largest entry of `expected`; infinite if it is not finite."""
    error = np.max(np.abs(value - expected), initial=0.0) / max(np.max(np.abs(expected), initial=0.0), 1e-300)
    return float(error) if np.isfinite(error) else np.inf
