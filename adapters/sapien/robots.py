"""Robot models as SAPIEN's `URDFLoader` reads them, and the terms that SAPIEN computes with them.

The root is fixed, which is the loader's default. A floating joint must be on the root and move a single link, which is then a
separate body; with further links the loader fails (`KeyError`). A root without other joints is a separate body too, and falls.
Cameras in the file are left out, because they need a renderer. SAPIEN drops an inertia whose mass or tensor is zero; PhysX then
computes the inertia from the shapes of collision, or uses 1e-6 kg and 1e-6 kg m^2. Joints have damping, as PhysX's drive.
Friction and effort limits in the file are dropped; PhysX's joints have their own friction, with a coefficient of 0.05. A mimic
joint becomes a tendon of PhysX, but only if one of the two joints is on the other's child, or if both are on the same link. The
rule of a mimic joint is that of the loader's record, because SAPIEN does not report tendons. Trials by motion (`step_robot`)
show which rule PhysX enforces: on the same link it is the inverse.

Masses, frames and properties of joints are those of PhysX, in single precision, and so are poses and the forces of gravity and
of Coriolis (`compute_passive_force`). The other terms are those of SAPIEN's `create_pinocchio_model`: SAPIEN writes the
articulation as a URDF and passes it to its copy of Pinocchio, which computes in double precision with numbers in single
precision. This copy is used here even if Pinocchio is installed, which SAPIEN would prefer. Separate bodies have no terms, and
robots with damping have no forward dynamics, because the copy has no damping.
"""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import sapien
from sapien import physx
from sapien.pysapien_pinocchio import PinocchioModel
from sapien.wrapper.urdf_exporter import export_kinematic_chain_urdf
from sapien.wrapper.urdf_loader import URDFLoader

from bodycheck.adapters.quiet import overheard, refusal
from bodycheck.adapters.robot_numbers import (
    along,
    components,
    finite,
    floating_joints,
    matrix,
    on_root,
    places_on_root,
    pose,
    vector,
)
from bodycheck.adapters.robot_reading import (
    FormatUnknown,
    JointStates,
    ModelRefused,
    ReadBody,
    ReadJoint,
    RobotFile,
    RobotReading,
)
from bodycheck.adapters.sapien.links import switch_off
from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.state import RobotState, Values
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: SAPIEN's types of joints in the words of `bodycheck.reference.robots.model`.
TYPES = {"revolute_unwrapped": "revolute", "undefined": "floating", "free": "floating"}

NOTES = ("SAPIEN drops the friction of joints; PhysX gives each a coefficient of friction of 0.05 of the force in the joint",)

#: SAPIEN's number for no limit of an effort is the largest of single precision.
NO_LIMIT = float(np.finfo(np.float32).max)


@dataclass(frozen=True, eq=False)
class Loaded:
    """A robot in a scene: its articulation, if it has one, and its separate bodies. The scene must exist as long as the robot.

    `floating` has the names of floating joints, keyed by the links that these joints move. `mimics` has the mimic elements of
    joints with a tendon, keyed by the names of these joints.
    """

    scene: Any
    articulation: Any
    bodies: tuple[Any, ...]
    floating: Mapping[str, str]
    mimics: Mapping[str, Mimic]

    @property
    def free(self) -> tuple[Any, ...]:
        """The bodies on floating joints, whose velocities come before all other velocities."""
        return tuple(body for body in self.bodies if body.name in self.floating)

    @property
    def links(self) -> tuple[Any, ...]:
        """The links of the articulation."""
        return tuple(self.articulation.links) if self.articulation is not None else ()

    @property
    def dof(self) -> int:
        """The number of velocities of the articulation."""
        return int(self.articulation.dof) if self.articulation is not None else 0


def read_robot(file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
    """Return how SAPIEN reads a file, as `RobotModels.read_robot` does."""
    if file.format != "urdf":
        raise FormatUnknown(f"SAPIEN has no reader of {file.format} files")
    standard = vector(physx.get_scene_config().gravity)
    with overheard(), warnings.catch_warnings(record=True) as caught, pulled(gravity):
        warnings.simplefilter("always")
        robot = loaded(file)
        model, fault = pinocchio_model(robot, gravity)
        bodies = [read_body(link) for link in (*robot.links, *robot.bodies)]
        places = places_on_root(file)
        notes = [f"SAPIEN warns: {warning.message}" for warning in caught]
        return RobotReading(
            bodies=tuple(bodies),
            joints=(*read_free(robot), *read_joints(robot)),
            links=tuple(body.name for body in bodies),
            velocities=6 * len(robot.free) + robot.dof,
            gravity=standard,
            terms=tuple(terms(robot, model, on_root(state, places)) for state in states),
            notes=tuple(dict.fromkeys([*NOTES, *notes, *fault])),
        )


def pinocchio_model(robot: Loaded, gravity: Vector) -> tuple[Any, list[str]]:
    """Return SAPIEN's Pinocchio model of an articulation, and notes.

    The model is None if the robot has no joint that moves, or if SAPIEN fails to build it; the notes then contain its message.
    """
    if not robot.dof:
        return None, []
    try:
        model = PinocchioModel(export_kinematic_chain_urdf(robot.articulation, force_fix_root=True), gravity)
    except (ValueError, RuntimeError) as error:
        return None, [f"SAPIEN's create_pinocchio_model fails: {error}"]
    model.set_joint_order([f"joint_{joint.child_link.index}" for joint in robot.articulation.get_active_joints()])
    model.set_link_order([f"link_{link.index}" for link in robot.articulation.links])
    return model, []


@contextmanager
def pulled(gravity: Vector, tgs: bool = True) -> Iterator[None]:
    """Set the gravity (m/s^2) and the solver of new PhysX scenes while this context lasts. The settings are of the process.

    tgs: whether the solver is TGS, PhysX's and SAPIEN's own, and not PGS.
    """
    kept = physx.get_scene_config()
    before = np.array(kept.gravity), kept.enable_tgs
    kept.gravity, kept.enable_tgs = gravity, tgs
    physx.set_scene_config(kept)
    try:
        yield
    finally:
        kept.gravity, kept.enable_tgs = before
        physx.set_scene_config(kept)


def loaded(file: RobotFile) -> Loaded:
    """Return the robot of a URDF. Raises `ModelRefused`."""
    scene = sapien.Scene([physx.PhysxCpuSystem()])
    loader = URDFLoader().set_scene(scene)
    try:
        articulations, bodies, _ = loader.parse(file.path)
        built, entities = [builder.build() for builder in articulations], [builder.build() for builder in bodies]
    except Exception as error:  # the loader raises exceptions of many types, also `Exception` itself
        raise ModelRefused(refusal(file.path, f"{type(error).__name__}: {error}")) from error
    single = tuple(entity.find_component_by_type(physx.PhysxRigidDynamicComponent) for entity in entities)
    for body, entity in zip(single, entities, strict=True):
        body.set_name(entity.name)
    tied = {
        name: mimic
        for builder, articulation in zip(articulations, built, strict=True)
        for name, mimic in tendons(builder, articulation)
    }
    return Loaded(scene, built[0] if built else None, single, floating_joints(file), tied)


def tendons(builder: Any, articulation: Any) -> Iterator[tuple[str, Mimic]]:
    """Yield the names and mimic elements, as the loader tells them, of the joints for which SAPIEN has made tendons."""
    for record in builder.mimic_joint_records:
        joint, leader = articulation.find_joint_by_name(record.joint), articulation.find_joint_by_name(record.mimic)
        below = joint.parent_link == leader.child_link and joint.parent_link.parent is not None
        if below or joint.parent_link == leader.parent_link:
            yield record.joint, Mimic(record.mimic, record.multiplier, record.offset)


def step_robot(file: RobotFile, starts: Sequence[JointStates], timestep: float, steps: int) -> list[JointStates]:
    """Return the states after steps of PhysX, as `RobotSteps.step_robot` does. Shapes are in no group, so that none touch."""
    with overheard(), warnings.catch_warnings(), pulled((0.0, 0.0, 0.0)):
        warnings.simplefilter("ignore")
        robot = loaded(file)
        robot.scene.physx_system.set_timestep(timestep)
        switch_off(robot.articulation)
        for joint in robot.articulation.get_active_joints():
            joint.set_friction(0.0)  # SAPIEN's own 0.05, which no file states
        for link in robot.links:
            for shape in link.collision_shapes:
                shape.set_collision_groups([0, 0, 0, 0])
        return [moved(robot.scene.physx_system, robot.articulation, start, steps) for start in starts]


def moved(system: Any, articulation: Any, start: JointStates, steps: int) -> JointStates:
    """Return the state of an articulation after steps from a state."""
    names = [joint.name for joint in articulation.get_active_joints()]
    articulation.set_qpos([start.positions.get(name, 0.0) for name in names])
    articulation.set_qvel([start.velocities.get(name, 0.0) for name in names])
    for _ in range(steps):
        system.step()
    positions, velocities = articulation.get_qpos().astype(float), articulation.get_qvel().astype(float)
    return JointStates(*(dict(zip(names, values.tolist(), strict=True)) for values in (positions, velocities)))


def read_body(link: Any) -> ReadBody:
    """Return a link."""
    centre = link.cmass_local_pose
    parent = link.parent if isinstance(link, physx.PhysxArticulationLinkComponent) else None
    return ReadBody(
        link.name,
        None if parent is None else parent.name,
        float(link.mass),
        vector(centre.p),
        components(along(link.inertia, matrix(centre.q))),
    )


def read_free(robot: Loaded) -> tuple[ReadJoint, ...]:
    """Return the joints of free bodies."""
    return tuple(
        ReadJoint(robot.floating[body.name], "floating", body.name, 6 * index, 6) for index, body in enumerate(robot.free)
    )


def read_joints(robot: Loaded) -> tuple[ReadJoint, ...]:
    """Return the joints of the articulation that move."""
    joints = robot.articulation.get_active_joints() if robot.dof else []
    return tuple(read_joint(robot, joint, index) for index, joint in enumerate(joints, 6 * len(robot.free)))


def read_joint(robot: Loaded, joint: Any, index: int) -> ReadJoint:
    """Return a joint that moves. It turns about, or slides along, the x axis of its frame in the child."""
    lower, upper = joint.limits[0]
    return ReadJoint(
        name=joint.name,
        type=TYPES.get(joint.type, joint.type),
        child=joint.child_link.name,
        first=index,
        count=1,
        axis=vector(matrix(joint.pose_in_child.q)[:, 0]),
        armature=float(joint.armature[0]),
        damping=float(joint.damping),
        stiffness=float(joint.stiffness),
        effort_limit=finite(joint.force_limit, NO_LIMIT),
        lower=finite(lower),
        upper=finite(upper),
        mimic=robot.mimics.get(joint.name),
    )


def terms(robot: Loaded, model: Any, state: RobotState) -> Terms:
    """Return the terms that SAPIEN computes at a state; `model` is its model for Pinocchio, or None."""
    put(robot, state)
    poses = {link.name: pose(link.entity_pose.p, link.entity_pose.q) for link in (*robot.links, *robot.bodies)}
    if not robot.dof or robot.free:
        return Terms(poses=poses)
    articulation = robot.articulation
    positions, velocities = rates(articulation, state.positions), rates(articulation, state.velocities)
    pulls = articulation.compute_passive_force(gravity=True, coriolis_and_centrifugal=False).astype(float)
    turning = articulation.compute_passive_force(gravity=False, coriolis_and_centrifugal=True).astype(float)
    if model is None:
        return Terms(poses=poses, gravity_force=pulls, coriolis_force=turning)
    damped, efforts = any(joint.damping for joint in articulation.get_active_joints()), rates(articulation, state.efforts)
    return Terms(
        poses=poses,
        jacobians=jacobians(articulation, model, positions),
        mass_matrix=np.array(model.compute_generalized_mass_matrix(positions)).reshape(robot.dof, robot.dof),
        gravity_force=pulls,
        coriolis_force=turning,
        forward_dynamics=None if damped else np.array(model.compute_forward_dynamics(positions, velocities, efforts)),
        inverse_dynamics=np.array(
            model.compute_inverse_dynamics(positions, velocities, rates(articulation, state.accelerations))
        ),
    )


def put(robot: Loaded, state: RobotState) -> None:
    """Put a robot into the positions and velocities of a state."""
    if robot.articulation is not None:  # without this, poses would be those of the last positions, even if no joint moves
        robot.articulation.set_qpos(rates(robot.articulation, state.positions))
        robot.articulation.set_qvel(rates(robot.articulation, state.velocities))
    for body in robot.free:
        position = state.positions.get(robot.floating[body.name])
        if position is not None:
            body.entity.set_pose(sapien.Pose(position[:3], position[3:]))


def rates(robot: Any, values: Values) -> Array:
    """Return SAPIEN's coordinates, velocities, accelerations or efforts of all joints."""
    return np.array([values.get(joint.name, (0.0,))[0] for joint in robot.get_active_joints()])


def jacobians(robot: Any, model: Any, positions: Array) -> Mapping[str, Array]:
    """Return the Jacobians (6, n) of the origins of the links' frames, linear rows first.

    SAPIEN offers Jacobians along the axes of the link, and Jacobians for the velocity at the origin of the world. The first
    ones are used here, and rotated to the axes of the world. The result is empty for a robot with a single velocity, for which
    SAPIEN's function fails with an `IndexError`.
    """
    if robot.dof == 1:
        return {}
    model.compute_full_jacobian(positions)
    model.compute_forward_kinematics(positions)
    by_link = {}
    for index, link in enumerate(robot.links):
        turn = matrix(model.get_link_pose(index).q)
        of_link = np.array(model.get_link_jacobian(index, local=True))
        by_link[link.name] = np.concatenate([turn @ of_link[:3], turn @ of_link[3:]])
    return by_link
