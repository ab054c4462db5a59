"""Run a whole scene in PyBullet as its importers make it from a file: with contacts, limits, damping and dry friction.

The root of a URDF is welded to the world, as in `bodycheck parity`. What PyBullet adds of its own to slow every motion is
switched off: the damping of links, and the motors that brake joints. Gravity is 9.81 m/s^2 downwards, since a physics server
has none unless it is set, and the importers set none.
"""

from collections.abc import Iterator

import numpy as np
import pybullet

from bodycheck.adapters.contract import Method
from bodycheck.adapters.file_motion import (
    FileFacts,
    FileMotion,
    FileRun,
    MotionRefused,
    Names,
    Seen,
    check_run,
    contact_of,
    nudged,
    sampled,
)
from bodycheck.adapters.pybullet.links import BASE
from bodycheck.adapters.pybullet.robots import Joint, Loaded, loaded_bodies, release, robot_of, server, text
from bodycheck.adapters.quiet import overheard, refusal
from bodycheck.adapters.robot_numbers import scalar_first
from bodycheck.adapters.robot_reading import RobotFile

#: The method, and the acceleration of gravity (m/s^2).
METHOD, GRAVITY = "multibody", (0.0, 0.0, -9.81)

#: The index of a joint's dry friction in the entries of `getJointInfo`.
FRICTION = 7


def file_facts(file: RobotFile) -> FileFacts:
    """Return the contents of a file on which a run depends, as `FileMotions.file_facts` does."""
    with server() as client:
        timestep = pybullet.getPhysicsEngineParameters(physicsClientId=client)["fixedTimeStep"]
        robots = _robots(client, file)
    return FileFacts(
        Method(METHOD, timestep), (METHOD,), friction=any(joint.info[FRICTION] for robot in robots for joint in robot.moving)
    )


def run_file(file: RobotFile, run: FileRun) -> FileMotion:
    """Return the motion of a scene, as `FileMotions.run_file` does."""
    check_run("PyBullet", run, (METHOD,))
    with server() as client:
        robots = _robots(client, file)
        with overheard():  # Bullet repeats its warnings in each call
            try:
                return sampled(_Scene(client, robots, run), run)
            except pybullet.error as error:  # PyBullet stores the states of at most 128 joints, including fixed joints
                raise MotionRefused(refusal(file.path, str(error))) from error


def _robots(client: int, file: RobotFile) -> list[Loaded]:
    """Load a file, and return its bodies. Raises `ModelRefused`."""
    bodies, _ = loaded_bodies(client, file)
    return [robot_of(client, body) for body in bodies]


class _Scene:
    """A physics server at the start of a run, as `SteppedScene`."""

    def __init__(self, client: int, robots: list[Loaded], run: FileRun) -> None:
        self.client = client
        pybullet.setTimeStep(run.method.timestep, physicsClientId=client)
        pybullet.setGravity(*GRAVITY, physicsClientId=client)
        self.free = [robot for robot in robots if robot.dynamics(BASE)[0]]
        self.links: list[tuple[Loaded, Joint]] = []
        for robot in robots:
            release(robot)
            moving = {BASE} if robot in self.free else set[int]()
            for joint in robot.joints:  # parents come before children
                if joint.count or joint.parent in moving:
                    moving.add(joint.index)
                    self.links.append((robot, joint))
        self.single = {
            kind: [(robot, joint) for robot in robots for joint in robot.joints if joint.type == kind]
            for kind in ("revolute", "prismatic")
        }
        self.balls = [(robot, joint) for robot in robots for joint in robot.joints if joint.type == "spherical"]
        if run.nudged:
            self._nudge()
        bases = [robot.base for robot in self.free]
        self.names = Names(
            (*bases, *(joint.link for _, joint in self.links)),
            tuple(joint.name for _, joint in self.single["revolute"]),
            (*bases, *(joint.name for _, joint in self.balls)),
            (*bases, *(joint.name for _, joint in self.single["prismatic"])),
        )

    def _nudge(self) -> None:
        """Change the initial positions and velocities of bases and of joints with one velocity by one rounding."""
        for robot in self.free:
            place, turn = pybullet.getBasePositionAndOrientation(robot.body, physicsClientId=self.client)
            moved = nudged(place).tolist(), nudged(turn).tolist()
            pybullet.resetBasePositionAndOrientation(robot.body, *moved, physicsClientId=self.client)
        for robot, joint in (*self.single["revolute"], *self.single["prismatic"]):
            position, velocity, *_ = pybullet.getJointState(robot.body, joint.index, physicsClientId=self.client)
            pybullet.resetJointState(robot.body, joint.index, *nudged([position, velocity]), physicsClientId=self.client)

    def advance(self, steps: int) -> None:
        for _ in range(steps):
            pybullet.stepSimulation(physicsClientId=self.client)

    def seen(self) -> Seen:
        bases = [pybullet.getBasePositionAndOrientation(robot.body, physicsClientId=self.client) for robot in self.free]
        links = [
            pybullet.getLinkState(robot.body, joint.index, computeForwardKinematics=True, physicsClientId=self.client)
            for robot, joint in self.links
        ]
        balls = [
            pybullet.getJointStateMultiDof(robot.body, joint.index, physicsClientId=self.client)[0]
            for robot, joint in self.balls
        ]
        turns, slides = [scalar_first(base[1]) for base in bases], self._coordinates("prismatic")
        return Seen(
            position=np.array([*(base[0] for base in bases), *(link[0] for link in links)]).reshape(-1, 3),
            quaternion=np.array([*turns, *(scalar_first(link[5]) for link in links)]).reshape(-1, 4),
            angles=np.array(self._coordinates("revolute")),
            turns=np.array([*turns, *map(scalar_first, balls)]).reshape(-1, 4),
            slides=np.array([*(base[0] for base in bases), *((value, 0.0, 0.0) for value in slides)]).reshape(-1, 3),
            regime=frozenset(self._touching()),
        )

    def _coordinates(self, kind: str) -> list[float]:
        return [
            pybullet.getJointState(robot.body, joint.index, physicsClientId=self.client)[0]
            for robot, joint in self.single[kind]
        ]

    def _touching(self) -> Iterator[str]:
        """Yield the contacts of the last step in words."""
        for contact in pybullet.getContactPoints(physicsClientId=self.client):
            yield contact_of(self._name(*side) for side in (contact[1:4:2], contact[2:5:2]))

    def _name(self, body: int, link: int) -> str:
        """Return the name of a link, or of the base of a body."""
        if link == BASE:
            return text(pybullet.getBodyInfo(body, physicsClientId=self.client)[0])
        return text(pybullet.getJointInfo(body, link, physicsClientId=self.client)[12])
