"""What an engine would tell and compute of a robot model: the reference's own terms, of a model that may have faults."""

from collections.abc import Mapping, Sequence

import numpy as np

from bodycheck.adapters.robot_numbers import components, vector
from bodycheck.adapters.robot_reading import ReadBody, ReadJoint, RobotReading
from bodycheck.reference.robots.dynamics import terms_at, velocity_labels
from bodycheck.reference.robots.fusing import fused
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.state import VELOCITIES, RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.studies.parity.aligning import selected
from bodycheck.studies.parity.conventions import Written, written
from bodycheck.studies.parity.stacks import Stack, stacked, values

GRAVITY: Vector = (0.0, 0.0, -9.81)


def reading(
    model: RobotModel,
    states: Sequence[RobotState],
    tells: bool = True,
    keeps: Sequence[str] = (),
    order: Sequence[str] = (),
    how: Mapping[str, Written] | None = None,
) -> RobotReading:
    """What an engine has that reads a model.

    model: what it takes the file for. tells: whether it tells of masses, inertias and numbers of joints. keeps: fixed links
    that stay bodies of their own. order: the joints in the order of the engine; that of the model if empty. how: how it writes
    the velocities of joints that have several.
    """
    bodies = fused(model, keeps)
    labels = velocity_labels(model)
    names = list(order) or list(dict.fromkeys(name for name, _ in labels))
    ordered = sorted(range(len(labels)), key=lambda place: (names.index(labels[place][0]), labels[place][1]))
    terms = selected(_in_convention(stacked(terms_at(model, states, GRAVITY)), bodies, labels, states, how or {}), ordered)
    links = [link.name for link in bodies.links]
    return RobotReading(
        tuple(_body(bodies, place, tells) for place in range(len(links))),
        tuple(_joint(bodies, name, [labels[place] for place in ordered], tells) for name in names),
        tuple(link.name for link in model.links),
        len(labels),
        GRAVITY,
        unstacked(terms, len(states), links),
    )


def unstacked(stack: Stack, count: int, links: Sequence[str]) -> tuple[Terms, ...]:
    """A stack as the terms at each state."""

    def part(array: object, state: int) -> object:
        return None if array is None else np.asarray(array)[state]

    vectors = ("mass_matrix", "gravity_force", "coriolis_force", "passive_force", "forward_dynamics", "inverse_dynamics")
    return tuple(
        Terms(
            {name: stack.poses[name][state] for name in links},
            {name: stack.jacobians[name][state] for name in links},
            **{name: part(getattr(stack, name), state) for name in vectors},  # type: ignore[arg-type]
        )
        for state in range(count)
    )


def _body(model: RobotModel, place: int, tells: bool) -> ReadBody:
    link, joint = model.links[place], model.joint_of[place]
    parent = None if joint is None else model.links[joint.parent].name
    if not tells:
        return ReadBody(link.name, parent)
    return ReadBody(link.name, parent, float(link.mass), vector(link.center_of_mass), components(link.inertia))


def _joint(model: RobotModel, name: str, labels: Sequence[tuple[str, int]], tells: bool) -> ReadJoint:
    joint = next(one for one in model.joints if one.name == name)
    child, first = model.links[joint.child].name, labels.index((name, 0))
    if not tells:
        return ReadJoint(name, joint.type, child, first, VELOCITIES[joint.type], mimic=joint.mimic)
    axis = vector(joint.axis) if np.any(joint.axis) else None
    return ReadJoint(
        *(name, joint.type, child, first, VELOCITIES[joint.type], axis),
        *(joint.armature, joint.damping, joint.friction, joint.stiffness),
        *(joint.effort_limit, joint.lower, joint.upper, joint.mimic),
    )


def _in_convention(
    terms: Stack,
    bodies: RobotModel,
    labels: Sequence[tuple[str, int]],
    states: Sequence[RobotState],
    how: Mapping[str, Written],
) -> Stack:
    """Terms for velocities y = S v that are written otherwise: M' = S^-T M S^-1, c' = S^-T (c - M S^-1 S' v) and so on."""
    n = len(labels)
    matrix, change = np.tile(np.eye(n), (len(states), 1, 1)), np.zeros((len(states), n, n))
    for name, own in how.items():
        places = [place for place, label in enumerate(labels) if label[0] == name]
        block = np.ix_(range(len(states)), places, places)
        matrix[block], change[block] = written(bodies, name, states, own)
    back = np.linalg.inv(matrix)
    turned = np.swapaxes(back, 1, 2)
    drift = (change @ values(states, labels, lambda state: state.velocities)[..., None])[..., 0]

    def force(array: object) -> np.ndarray:
        return np.asarray((turned @ np.asarray(array)[..., None])[..., 0])

    mass = turned @ np.asarray(terms.mass_matrix) @ back
    return Stack(
        terms.poses,
        {name: jacobian @ back for name, jacobian in terms.jacobians.items()},
        mass,
        force(terms.gravity_force),
        force(terms.coriolis_force) - (mass @ drift[..., None])[..., 0],
        force(terms.passive_force),
        (matrix @ np.asarray(terms.forward_dynamics)[..., None])[..., 0] + drift,
        force(terms.inverse_dynamics),
    )
