"""Miniature engines of a sliding box, of boxes that touch, and of arms on hinges, with planted faults.

They have no more mechanics than the probes of the audit need: the motion of a sound engine conserves what mechanics conserves,
or does not depend on what mechanics does not depend on.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, sin

import numpy as np

from bodycheck.adapters.contract import Engine, Integrator, Method, SceneUnsupported, single
from bodycheck.adapters.touching import TouchingBody, touching_bodies
from bodycheck.reference.kinematics import multiply, normalise, rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.scene import Brick, Scene
from bodycheck.reference.trajectory import Array

MODELS = frozenset(
    {"gravity", "translation", "rotation", "contact", "friction", "mechanisms", "revolute joints", "contacts", "restitution"}
)


@dataclass(frozen=True)
class Faults:
    """What an engine does beside mechanics; nothing unless it is given.

    pyramid: friction acts along the axis of the world that is nearest to the velocity. stronger_along: the relative excess of
    friction along the first axis of the box. restitution: that of impacts, for 1. leak: the fraction of the impulse that the
    second box gets in excess. untwisted: the fraction of its torque that the second box does not get. ageing: the relative
    excess of friction and of support in a contact that is new. stale: a child that is listed before its parent hangs on the
    place where its parent was in the last step.
    """

    pyramid: bool = False
    stronger_along: float = 0.0
    restitution: float = 1.0
    leak: float = 0.0
    untwisted: float = 0.0
    ageing: float = 0.0
    stale: bool = False


@dataclass
class Stepped:
    """A simulation of one scene, whose states (bodies, 13) a function advances by a step. It also gets the step's number."""

    states: Array
    step: Callable[[Array, int], Array]
    number: int = 0

    def advance(self, strides: Sequence[int]) -> Array:
        rows = []
        for stride in strides:
            for _ in range(int(stride)):
                self.states = self.step(self.states, self.number)
                self.number += 1
            rows.append(self.states.copy())
        return single(np.array(rows))


def moved(states: Array, timestep: float) -> Array:
    """The states after a step without forces; spins are constant in the axes of the bodies."""
    after = states.copy()
    after[:, :3] += timestep * states[:, 7:10]
    half = timestep / 2 * states[:, 10:]
    turn = np.concatenate([np.ones((len(states), 1)), half], axis=1)
    after[:, 3:7] = normalise(multiply(states[:, 3:7], turn))
    return after


def row(box: TouchingBody) -> Array:
    start = box.start
    return np.array([*start.position, *start.quaternion, *start.velocity, *start.angular_velocity])


def sliding(scene: Scene, timestep: float, own: Faults) -> Stepped:
    """A box that slides on the plane without turning."""
    assert scene.plane is not None
    start, loss = scene.initial, scene.plane.friction * scene.gravity * timestep
    axis = rotate(np.array(start.quaternion), np.array([1.0, 0.0, 0.0]))[:2]

    def step(states: Array, _: int) -> Array:
        after, velocity = states.copy(), states[0, 7:9]
        force = -velocity / np.linalg.norm(velocity)
        if own.pyramid:
            force = np.where(np.abs(force) == np.abs(force).max(), np.sign(force), 0.0)
        force = force + own.stronger_along * (force @ axis) * axis
        after[0, 7:9] += loss * force
        return moved(after, timestep)

    return Stepped(np.array([[*start.position, *start.quaternion, *start.velocity, *start.angular_velocity]]), step)


def hitting(boxes: Sequence[TouchingBody], timestep: float, own: Faults) -> Stepped:
    """Two boxes, of which the second comes along -x and hits the first by an impulse at the centre of their common patch."""
    first, second = boxes
    assert isinstance(first.shape, Brick)
    moments, distance = np.array(first.body.moments), 2 * first.shape.semi_axes[0]
    _, y, z = (np.array(second.start.position) - np.array(first.start.position)) / 2
    arm = np.array([0.0, z, -y])  # r x n for the first box, and of the opposite sign for the second
    effective = 1 / (2 / first.body.mass + 2 * (arm**2 / moments).sum())

    def step(states: Array, _: int) -> Array:
        after = states.copy()
        approach = states[0, 7] - states[1, 7] + arm @ (states[0, 10:] + states[1, 10:])
        if states[1, 0] - states[0, 0] < distance and approach > 0:
            impulse = (1 + own.restitution) * effective * approach
            after[0, 7] -= impulse / first.body.mass
            after[1, 7] += (1 + own.leak) * impulse / first.body.mass
            after[0, 10:] -= impulse * arm / moments
            after[1, 10:] += (1 - own.untwisted) * impulse * -arm / moments
        return moved(after, timestep)

    return Stepped(np.array([row(box) for box in boxes]), step)


def lying(boxes: Sequence[TouchingBody], scene: Mechanism, timestep: float, own: Faults) -> Stepped:
    """Boxes on the plane and on one another, which slow down. Contacts of a faulty engine differ when they are new."""
    assert scene.plane is not None
    loss = scene.plane.friction * scene.gravity * timestep

    def step(states: Array, number: int) -> Array:
        after, new = states.copy(), own.ageing * 0.5**number
        after[:, 2] -= new
        for state in after:
            if (speed := float(np.linalg.norm(state[7:9]))) > loss:
                state[7:9] *= 1 - loss * (1 + new) / speed
        return moved(after, timestep)

    return Stepped(np.array([row(box) for box in boxes]), step)


def hanging(mechanism: Mechanism, timestep: float, own: Faults) -> Stepped:
    """Arms on hinges that turn evenly. Their states are those of the frames, without velocities."""

    def placed(former: Array | None, time: float) -> Array:
        poses: dict[int, Array] = {WORLD: np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])}
        if former is not None:
            poses |= dict(enumerate(former[:, :7]))
        for _ in range(1 if own.stale and former is not None else len(mechanism.bodies)):
            for index, joint in enumerate(mechanism.joint_of):
                assert joint is not None
                origin, attitude = np.split(poses.get(joint.parent, poses[WORLD]), [3])
                angle = joint.start[0] + time * joint.start_velocity[0]
                axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
                turn = np.array([cos(angle / 2), *sin(angle / 2) * axis])
                poses[index] = np.array([*origin + rotate(attitude, np.array(joint.position)), *multiply(attitude, turn)])
        return np.array([[*poses[index], *(0.0,) * 6] for index in range(len(mechanism.bodies))])

    return Stepped(placed(None, 0.0), lambda states, number: placed(states, (number + 1) * timestep))


@dataclass(frozen=True)
class PlantedContacts:
    """The adapter of a miniature engine."""

    own: Faults = Faults()

    @property
    def engine(self) -> Engine:
        return Engine("planted", "bodycheck-miniature", "1.0", (Integrator("step"),), MODELS)

    def prepare(self, scenes: Sequence[AnyScene], method: Method) -> Stepped:
        (scene,) = scenes
        if not isinstance(scene, Mechanism):
            return sliding(scene, method.timestep, self.own)
        if scene.plane is None:
            return hanging(scene, method.timestep, self.own)
        boxes = touching_bodies(scene)
        if scene.gravity:
            return lying(boxes, scene, method.timestep, self.own)
        if len(boxes) != 2:
            raise SceneUnsupported("an impact of other than two boxes")
        return hitting(boxes, method.timestep, self.own)
