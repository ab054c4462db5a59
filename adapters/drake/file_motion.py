"""Run a whole scene in Drake as its parser makes it from a file: with contacts, limits and couplers.

Only a discrete plant has limits of joints and couplers, so the methods are the approximations of contact of a discrete plant.
The root of a URDF is welded to the world, as in `bodycheck parity`. Actuators are not driven.
"""

from typing import Any

import numpy as np
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from bodycheck.adapters.contract import EngineDiverged, Method
from bodycheck.adapters.drake.models import configured
from bodycheck.adapters.drake.robots import filled, heard, joints_of, named
from bodycheck.adapters.file_motion import FileFacts, FileMotion, FileRun, Names, Seen, check_run, contact_of, nudged, sampled
from bodycheck.adapters.quiet import refusal
from bodycheck.adapters.robot_numbers import floating_joints
from bodycheck.adapters.robot_reading import ModelRefused, RobotFile
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.trajectory import Array


def file_facts(approximations: tuple[str, ...], file: RobotFile) -> FileFacts:
    """Return the contents of a file on which a run depends, as `FileMotions.file_facts` does."""
    method = Method(approximations[0], MultibodyPlantConfig().time_step)
    with heard():
        plant, _ = _built(file, method, approximations)
    return FileFacts(method, approximations, driven=plant.num_actuators() > 0)


def run_file(approximations: tuple[str, ...], file: RobotFile, run: FileRun) -> FileMotion:
    """Return the motion of a scene, as `FileMotions.run_file` does."""
    check_run("Drake", run, approximations)
    with heard():
        plant, diagram = _built(file, run.method, approximations)
        return sampled(_Scene(plant, diagram, file, run), run)


def _built(file: RobotFile, method: Method, approximations: tuple[str, ...]) -> tuple[Any, Any]:
    """Return the plant of a file, and the diagram with its geometry. Raises `ModelRefused`."""
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlant(configured(method, approximations), builder)
    try:
        filled(plant, file)
        plant.Finalize()
        return plant, builder.Build()
    except RuntimeError as error:
        raise ModelRefused(refusal(file.path, str(error))) from error


class _Scene:
    """A plant with its simulator at the start of a run, as `SteppedScene`."""

    def __init__(self, plant: Any, diagram: Any, file: RobotFile, run: FileRun) -> None:
        self.plant, self.timestep, self.done = plant, run.method.timestep, 0
        self.simulator = Simulator(diagram)
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        if run.nudged:
            plant.SetPositions(self.context, nudged(plant.GetPositions(self.context)))
            plant.SetVelocities(self.context, nudged(plant.GetVelocities(self.context)))
        fixed = {body.index() for body in plant.GetBodiesWeldedTo(plant.world_body())}
        every = (plant.get_body(BodyIndex(index)) for index in range(plant.num_bodies()))
        self.bodies = [body for body in every if body.index() not in fixed]
        joints = named(joints_of(plant), floating_joints(file))
        self.hinges = {name: joint for name, joint in joints.items() if joint.type_name() == "revolute"}
        self.slides = {name: joint for name, joint in joints.items() if joint.type_name() == "prismatic"}
        self.free = {name: joint for name, joint in joints.items() if joint.type_name() == "quaternion_floating"}
        bodies = [joint.child_body().name() for joint in self.free.values()]
        self.names = Names(
            tuple(body.name() for body in self.bodies), tuple(self.hinges), tuple(bodies), (*bodies, *self.slides)
        )

    def advance(self, steps: int) -> None:
        self.done += steps
        try:
            self.simulator.AdvanceTo(self.done * self.timestep)
        except RuntimeError as error:
            raise EngineDiverged(f"Drake stops before t = {self.done * self.timestep:.6g} s: {error}") from error

    def seen(self) -> Seen:
        plant, context = self.plant, self.context
        poses = [plant.EvalBodyPoseInWorld(context, body) for body in self.bodies]
        attitudes = np.array([pose.rotation().ToQuaternion().wxyz() for pose in poses]).reshape(-1, 4)
        centres = np.array([_centre(body) for body in self.bodies]).reshape(-1, 3)
        places = np.array([pose.translation() for pose in poses]).reshape(-1, 3)
        q = plant.GetPositions(context)
        free = [q[joint.position_start() : joint.position_start() + 7] for joint in self.free.values()]
        slides = [(q[joint.position_start()], 0.0, 0.0) for joint in self.slides.values()]
        return Seen(
            position=places + rotate(attitudes, centres) if len(places) else places,
            quaternion=attitudes,
            angles=np.array([q[joint.position_start()] for joint in self.hinges.values()]),
            turns=np.array([part[:4] for part in free]).reshape(-1, 4),
            slides=np.array([*(part[4:] for part in free), *slides]).reshape(-1, 3),
            regime=frozenset(self._acting(q)),
        )

    def _acting(self, q: Array) -> list[str]:
        """Return the contacts and the active limits of a state in words."""
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        acting = []
        for index in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(index)
            acting.append(contact_of(self.plant.get_body(body).name() for body in (info.bodyA_index(), info.bodyB_index())))
        for name, joint in (self.hinges | self.slides).items():
            lower, upper = joint.position_lower_limits()[0], joint.position_upper_limits()[0]
            if not lower < q[joint.position_start()] < upper:
                acting.append(f"limit of joint {name}")
        return acting


def _centre(body: Any) -> Array:
    """Return the centre of mass (3,) in the frame of a body, or the origin of the frame if the body has no mass."""
    inertia = body.default_spatial_inertia()
    return np.array(inertia.get_com()) if inertia.get_mass() else np.zeros(3)
