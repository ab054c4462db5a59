"""Run a whole scene in SAPIEN as its `URDFLoader` makes it from a file: with contacts, limits, damping and tendons.

The root is fixed, which is the loader's default. What SAPIEN adds of its own to slow every motion is switched off: the damping
of links, sleeping, and the friction of 0.05 of joints. Gravity is 9.81 m/s^2 downwards; all numbers are in single precision.
"""

import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from sapien import physx

from bodycheck.adapters.contract import Method
from bodycheck.adapters.file_motion import FileFacts, FileMotion, FileRun, Names, Seen, check_run, contact_of, nudged, sampled
from bodycheck.adapters.quiet import overheard
from bodycheck.adapters.robot_reading import FormatUnknown, RobotFile
from bodycheck.adapters.sapien.links import switch_off
from bodycheck.adapters.sapien.robots import Loaded, loaded, pulled
from bodycheck.reference.kinematics import normalise, rotate

#: The acceleration of gravity (m/s^2).
GRAVITY = (0.0, 0.0, -9.81)


def file_facts(solvers: tuple[str, ...], file: RobotFile) -> FileFacts:
    """Return the contents of a file on which a run depends, as `FileMotions.file_facts` does."""
    _check(file)
    with overheard(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        loaded(file)
    first = "TGS" if physx.get_scene_config().enable_tgs else "PGS"
    methods = (first, *(name for name in solvers if name != first))
    return FileFacts(Method(first, float(physx.PhysxCpuSystem().timestep)), methods)


def run_file(solvers: tuple[str, ...], file: RobotFile, run: FileRun) -> FileMotion:
    """Return the motion of a scene, as `FileMotions.run_file` does."""
    _check(file)
    check_run("SAPIEN", run, solvers)
    with overheard(), warnings.catch_warnings(), pulled(GRAVITY, run.method.integrator == "TGS"):
        warnings.simplefilter("ignore")
        return sampled(_Scene(loaded(file), run), run)


def _check(file: RobotFile) -> None:
    """Raise `FormatUnknown` for a format that SAPIEN does not read."""
    if file.format != "urdf":
        raise FormatUnknown(f"SAPIEN has no reader of {file.format} files")


class _Scene:
    """A scene of PhysX at the start of a run, as `SteppedScene`."""

    def __init__(self, robot: Loaded, run: FileRun) -> None:
        self.robot, self.system = robot, robot.scene.physx_system
        self.system.set_timestep(run.method.timestep)
        joints = robot.articulation.get_active_joints() if robot.dof else []
        if robot.dof:
            switch_off(robot.articulation)
        for joint in joints:
            joint.set_friction(0.0)  # SAPIEN's own 0.05, which no file states
        moving: set[Any] = set()
        for link in robot.links:  # parents come before children
            if link.parent is not None and (link.joint.dof or link.parent in moving):
                moving.add(link)
        self.bodies = [*robot.bodies, *(link for link in robot.links if link in moving)]
        self.kinds = [joint.type.removesuffix("_unwrapped") for joint in joints]
        if run.nudged and robot.dof:
            robot.articulation.set_qpos(nudged(robot.articulation.get_qpos()))
            robot.articulation.set_qvel(nudged(robot.articulation.get_qvel()))
        names = [joint.name for joint in joints]
        free = tuple(body.name for body in robot.bodies)
        self.names = Names(
            tuple(body.name for body in self.bodies), self._of("revolute", names), free, (*free, *self._of("prismatic", names))
        )

    def _of(self, kind: str, values: Any) -> tuple[Any, ...]:
        """Return the values of the joints of one kind, of values for all joints."""
        return tuple(value for value, one in zip(values, self.kinds, strict=True) if one == kind)

    def advance(self, steps: int) -> None:
        for _ in range(steps):
            self.system.step()

    def seen(self) -> Seen:
        q = self.robot.articulation.get_qpos().tolist() if self.robot.dof else []
        poses = [body.entity_pose for body in self.bodies]
        attitudes = normalise(np.array([pose.q for pose in poses], np.float64).reshape(-1, 4))
        centres = np.array([body.cmass_local_pose.p for body in self.bodies], np.float64).reshape(-1, 3)
        places = np.array([pose.p for pose in poses], np.float64).reshape(-1, 3)
        free = len(self.robot.bodies)
        slides = [*places[:free], *((value, 0.0, 0.0) for value in self._of("prismatic", q))]
        return Seen(
            position=places + rotate(attitudes, centres) if len(places) else places,
            quaternion=attitudes,
            angles=np.array(self._of("revolute", q)),
            turns=attitudes[:free],
            slides=np.array(slides).reshape(-1, 3),
            regime=frozenset(self._touching()),
        )

    def _touching(self) -> Iterator[str]:
        """Yield the contacts of the last step in words."""
        for contact in self.system.get_contacts():
            if any(point.separation <= 0 for point in contact.points):
                yield contact_of(body.name for body in contact.bodies)
