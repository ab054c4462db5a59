"""Mechanisms in Newton: the bodies, joints and articulations of a model.

Joints are Newton's revolute, prismatic, ball and fixed joints, and Newton's joint of six degrees of freedom for universal and
planar joints. Damping, springs, armature, dry friction and limits are properties of a joint, which not every solver models;
efforts are forces of the control. Bodies without mass are links without mass, which MuJoCo's solvers and `XPBD` do not have.
"""

import re
from collections.abc import Sequence
from typing import Any

import newton
import numpy as np
import warp as wp

from bodycheck.adapters.contract import Method, SceneUnsupported, SensingSimulation, states
from bodycheck.adapters.links import Link, tensor, velocity_of
from bodycheck.adapters.mechanisms import bounds, check_rebounds, frames, from_x, link_of, starts, stops_of
from bodycheck.adapters.mujoco_warp import graphs
from bodycheck.adapters.newton.sensing import Instruments, add_sites, transform
from bodycheck.adapters.newton.solvers import FAR, LIMIT_IMPEDANCE, OF_MUJOCO, SOFTEST, SOLVERS, STEEL_DAMPING, keeps_damping
from bodycheck.adapters.stepping import Loop, Normalised, Taking
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism, depth_first
from bodycheck.reference.requirements import of_mechanism
from bodycheck.reference.scene import State, Vector
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: The features of mechanisms that at least one of Newton's solvers models; see `Engine.models`.
MODELS = frozenset(
    {
        "mechanisms",
        "revolute joints",
        "prismatic joints",
        "ball joints",
        "fixed joints",
        "planar joints",
        "universal joints",
        "armature",
        "joint damping",
        "joint springs",
        "joint friction",
        "joint efforts",
        "massless bodies",
        "controllers",
        "rigid stops",
        "elastic stops",
    }
)

#: The identity quaternion (w, x, y, z).
NO_TURN = np.array([1.0, 0.0, 0.0, 0.0])


def prepare(mechanism: Mechanism, method: Method) -> Normalised | Taking:
    """Return the simulation of a mechanism. Raises `SceneUnsupported`."""
    check(mechanism, method)
    model = built(mechanism, method)
    return stepped(mechanism, method, model, model.state())


def prepare_sensing(mechanism: Mechanism, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a mechanism with sensors. Raises `SceneUnsupported`."""
    check(mechanism, method)
    model = built(mechanism, method, sensors)
    number_of = numbers(mechanism)
    state, instruments = model.state(), Instruments(model, sensors, [number_of[sensor.body] for sensor in sensors])
    return SensingSimulation(stepped(mechanism, method, model, state, instruments), lambda: instruments.read(state))


def check(mechanism: Mechanism, method: Method) -> None:
    """Raise `SceneUnsupported` for a mechanism that a solver of Newton does not have as it is."""
    solver_of_method = SOLVERS[method.integrator]
    lacking = [name for name in of_mechanism(mechanism).names() if name in solver_of_method.lacks]
    if lacking:
        raise SceneUnsupported(f"Newton's solver {method.integrator} has no {', '.join(lacking)}")
    check_rebounds(mechanism, "Newton")
    check_stops(mechanism, method)


def stepped(
    mechanism: Mechanism, method: Method, model: Any, state: Any, instruments: Instruments | None = None
) -> Normalised | Taking:
    """Return the simulation of a model by steps of a state, with the observables that sensors need if there are any."""
    following, control = model.state(), model.control()
    forces = control.joint_f.numpy()
    for index, joint in enumerate(in_order(mechanism)):
        if joint is not None and joint.effort:
            forces[model.joint_qd_start.numpy()[index]] = joint.effort
    control.joint_f.assign(forces)
    try:
        solver = SOLVERS[method.integrator].make(model, method)
    except ValueError as error:  # such as moments of which one is the sum of the others, rounded to single precision
        reason = " ".join(str(error).split())
        for index, number in numbers(mechanism).items():
            if index != WORLD:
                words = re.split(rf"Element name 'body_{number}', id \d+", reason)
                reason = mechanism.bodies[index].name.join(words)
        raise SceneUnsupported(f"Newton's solver {method.integrator} refuses the model: {reason}") from error
    contacts = None if instruments is None else instruments.attach(solver, None)
    observed = {} if instruments is None else instruments.observed

    def step() -> None:
        state.clear_forces()
        solver.step(state, following, control, contacts, method.timestep, **observed)
        state.assign(following)

    graph = graphs.record(step)
    poses, twists = state.body_q.numpy(), state.body_qd.numpy()  # views of the arrays that are stepped
    simulation = Normalised(
        Loop(graph, graphs.replay, lambda _: np.hstack([poses, twists]).ravel(), lambda seen: rows(mechanism, seen))
    )
    if not mechanism.driven:
        return simulation
    joints = Driven(model, state, control, mechanism)
    return Taking(simulation, joints.state, joints.apply)


class Driven:
    """The driven joints of a model.

    Solvers in maximal coordinates keep no coordinates of joints, which Newton computes from the poses of bodies; an angle is
    then within half a turn, and is continued from the angle before.

    Parameters
    ----------
    model, engine_state, control
        Newton's model, the state that is stepped, and its control.
    mechanism
        The mechanism.
    """

    def __init__(self, model: Any, engine_state: Any, control: Any, mechanism: Mechanism) -> None:
        self.model, self.engine_state = model, engine_state
        order = [None if joint is None else joint.name for joint in in_order(mechanism)]
        joints = [mechanism.joints[index] for index in mechanism.driven]
        numbers_of_joints = [order.index(joint.name) for joint in joints]
        self.in_q = model.joint_q_start.numpy()[numbers_of_joints]
        self.in_v = model.joint_qd_start.numpy()[numbers_of_joints]
        self.forces = control.joint_f.numpy()  # a view of the array that the solver reads
        self.constant = self.forces[self.in_v].astype(np.float64)
        self.turning = np.array([joint.type == "revolute" for joint in joints])
        self.last = model.joint_q.numpy()[self.in_q].astype(np.float64)
        self.q, self.v = wp.zeros_like(model.joint_q), wp.zeros_like(model.joint_qd)

    def state(self) -> tuple[Array, Array]:
        """Return the coordinates and velocities (j,) of the joints."""
        newton.eval_ik(self.model, self.engine_state, self.q, self.v)
        position = self.q.numpy()[self.in_q].astype(np.float64)
        turns = np.round((self.last - position) / (2 * np.pi))
        self.last = position + np.where(self.turning, 2 * np.pi * turns, 0.0)
        return self.last.copy(), self.v.numpy()[self.in_v].astype(np.float64)

    def apply(self, efforts: Array) -> None:
        """Exert efforts (j,) from now on, in addition to the constant ones."""
        self.forces[self.in_v] = self.constant + efforts


def check_stops(mechanism: Mechanism, method: Method) -> None:
    """Raise `SceneUnsupported` for stops that a solver of Newton does not have as they are."""
    for joint in mechanism.joints:
        stops = stops_of(joint, method)
        if by_mujoco(method) and stops is not None and not stops.damping:
            raise SceneUnsupported(f"Newton gives MuJoCo no limit without damping, and the stops of {joint.name} have none")


def by_mujoco(method: Method) -> bool:
    """Return whether a method passes the model to MuJoCo Warp."""
    return method.integrator in [f"MuJoCo-{scheme}" for scheme in OF_MUJOCO]


def in_order(mechanism: Mechanism) -> list[Joint | None]:
    """Return the joints in the order in which Newton needs them: tree by tree, each after its parent; None for a free body."""
    return [mechanism.joint_of[index] for index in depth_first(mechanism)]


def numbers(mechanism: Mechanism) -> dict[int, int]:
    """Return the number of each body in Newton's model by its index in the mechanism; the number of `WORLD` is -1.

    Each body has the number of the joint that it hangs on: `SolverFeatherstone` reads the inertia of a joint's body by the
    number of the joint, so that bodies in another order than the joints would have each other's inertias.
    """
    return {WORLD: -1} | {index: number for number, index in enumerate(depth_first(mechanism))}


def built(mechanism: Mechanism, method: Method, sensors: Sequence[Sensor] = ()) -> Any:
    """Return Newton's model of a mechanism with sensors, whose default state is the initial state."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -mechanism.gravity))
    newton.solvers.SolverSteel.register_custom_attributes(builder)
    if by_mujoco(method):
        newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    first, number_of = frames(mechanism), numbers(mechanism)
    for index in depth_first(mechanism):
        frame, link = first[index], link_of(mechanism.bodies[index])
        number = builder.add_link(
            xform=transform(frame.position, frame.quaternion),
            com=wp.vec3(*link.center_of_mass),
            mass=link.mass,
            inertia=wp.mat33(*tensor(link).ravel().tolist()),
            lock_inertia=True,
            custom_attributes={} if keeps_damping(method) else {STEEL_DAMPING: 0.0},
        )
        builder.body_qd[number] = twist(link, frame)
    values = dict(zip((joint.child for joint in mechanism.joints), starts(mechanism), strict=True))
    tree: list[int] = []
    for index in depth_first(mechanism):
        joint = mechanism.joint_of[index]
        if tree and (joint is None or joint.parent == WORLD):
            builder.add_articulation(tree)
            tree = []
        if joint is None:
            body = number_of[index]
            number = builder.add_joint_free(body)
            positions, velocities = [*transform(first[index].position, first[index].quaternion)], [*builder.body_qd[body]]
        else:
            number = add_joint(builder, joint, (number_of[joint.parent], number_of[joint.child]), method)
            positions, velocities = in_newton(joint, *values[index])
        tree.append(number)
        at, by = builder.joint_q_start[number], builder.joint_qd_start[number]
        builder.joint_q[at : at + len(positions)] = positions
        builder.joint_qd[by : by + len(velocities)] = velocities
    builder.add_articulation(tree)
    add_sites(builder, sensors, [number_of[sensor.body] for sensor in sensors])
    builder.color()
    # The check of inertia would replace moments of which one is nearly the sum of the others.
    return builder.finalize(skip_validation_inertia=True)


def add_joint(builder: Any, joint: Joint, between: tuple[int, int], method: Method) -> int:
    """Add a joint between two bodies of a builder, the parent first, and return its number."""
    axis, turn = axis_and_turn(joint)
    ends: dict[str, Any] = {
        "parent_xform": transform(joint.position, multiply(np.array(exact.nearest_turn(joint.attitude)), turn)),
        "child_xform": transform((0.0, 0.0, 0.0), turn),
    }
    acting: dict[str, Any] = {
        "armature": joint.armature,
        "damping": joint.damping,
        "stiffness": joint.stiffness,
        "rest_q": joint.rest,
        "friction": joint.friction,
    }
    if (stops := stops_of(joint, method)) is not None:
        acting |= dict(zip(("limit_lower", "limit_upper"), bounds(stops, FAR), strict=True))
        if not stops.rigid:
            acting |= {"limit_ke": stops.stiffness, "limit_kd": stops.damping}
            if by_mujoco(method):
                acting["custom_attributes"] = {LIMIT_IMPEDANCE: [SOFTEST]}
    if joint.type in ("revolute", "prismatic"):
        add = builder.add_joint_revolute if joint.type == "revolute" else builder.add_joint_prismatic
        return int(add(*between, **ends, axis=axis, **acting))
    if joint.type == "spherical":
        return int(builder.add_joint_ball(*between, **ends, armature=0.0, friction=0.0, damping=joint.damping, stiffness=0.0))
    if joint.type == "fixed":
        return int(builder.add_joint_fixed(*between, **ends))
    axes = [newton.ModelBuilder.JointDofConfig(axis=axis) for axis in np.eye(3).tolist()]
    linear, angular = ([], axes[:2]) if joint.type == "universal" else (axes[:2], axes[2:])
    return int(builder.add_joint_d6(*between, **ends, linear_axes=linear, angular_axes=angular))


def axis_and_turn(joint: Joint) -> tuple[Vector, Array]:
    """Return the axis of a joint in Newton's frames of it, and the quaternion (4,) from these frames to those of the mechanism.

    XPBD frees every axis of a frame along which the axis of the joint has a component, up to limits of its own, so that a body
    leaves an oblique axis; the frames are turned to have x along it, about which XPBD measures the angle of a hinge.
    """
    if joint.type not in ("revolute", "prismatic") or np.count_nonzero(axis := exact.nearest_axis(joint)) == 1:
        return exact.nearest_axis(joint), NO_TURN
    return (1.0, 0.0, 0.0), from_x(np.array(axis))


def in_newton(joint: Joint, position: Array, velocity: Array) -> tuple[list[float], list[float]]:
    """Return Newton's coordinates and velocities of a joint."""
    if joint.type == "spherical":
        w, x, y, z = position.tolist()
        return [x, y, z, w], rotate(position, velocity).tolist()
    return position.tolist(), velocity.tolist()


def rows(mechanism: Mechanism, seen: Array) -> Array:
    """Return the states (n, bodies, 13) of the contract from poses and twists (n, 13 bodies); see `engine.rows`."""
    engine_rows, number_of = seen.reshape(len(seen), -1, 13), numbers(mechanism)
    states_of_bodies = []
    for index, body in enumerate(mechanism.bodies):
        engine_rows_of_body = engine_rows[:, number_of[index]]
        turn = engine_rows_of_body[:, [6, 3, 4, 5]]
        unit = normalise(turn)
        centre = engine_rows_of_body[:, :3] + rotate(
            unit, np.broadcast_to(exact.nearest_inertia(body).centre, (len(engine_rows_of_body), 3))
        )
        states_of_bodies.append(
            states(centre, turn, engine_rows_of_body[:, 7:10], rotate(conjugate(unit), engine_rows_of_body[:, 10:]))
        )
    return np.stack(states_of_bodies, axis=1)


def twist(link: Link, state: State) -> tuple[float, ...]:
    """Return Newton's twist of a link in a state: the velocity of its centre of mass and its angular velocity (world frame)."""
    spin = rotate(np.array(state.quaternion), np.array(state.angular_velocity))
    return (*velocity_of(link.center_of_mass, state), *spin.tolist())
