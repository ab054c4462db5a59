"""Run a whole scene in DART as its readers make it from a file: an articulated robot of a URDF, or the world of an MJCF.

The root of a URDF is welded to the world, as in `bodycheck parity`. DART's settings stay as its readers leave them: limits of
positions are not enforced, and the bodies of one robot do not touch each other.
"""

from collections.abc import Iterator
from typing import Any

import dartpy as dart
import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.adapters.dart.robots import joints_of, loaded, world_of_mjcf
from bodycheck.adapters.file_motion import FileFacts, FileMotion, FileRun, Names, Seen, check_run, contact_of, nudged, sampled
from bodycheck.adapters.quiet import overheard
from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.reference.trajectory import Array

#: The acceleration of gravity (m/s^2) in a scene of a URDF, which has none; DART's own is along the y axis.
GRAVITY = (0.0, 0.0, -9.81)


def file_facts(integrator: str, file: RobotFile) -> FileFacts:
    """Return the contents of a file on which a run depends, as `FileMotions.file_facts` does."""
    world = _world(file)
    skeletons = [world.getSkeleton(index) for index in range(world.getNumSkeletons())]
    dofs = [skeleton.getDof(index) for skeleton in skeletons for index in range(skeleton.getNumDofs())]
    method = Method(integrator, dart.simulation.World().getTimeStep())
    return FileFacts(method, (integrator,), friction=any(dof.getCoulombFriction() for dof in dofs))


def run_file(integrator: str, file: RobotFile, run: FileRun) -> FileMotion:
    """Return the motion of a scene, as `FileMotions.run_file` does."""
    check_run("DART", run, (integrator,))
    with overheard():  # DART repeats its warnings
        return sampled(_Scene(_world(file), run), run)


def _world(file: RobotFile) -> Any:
    """Return the world of a file. Raises `ModelRefused`."""
    if file.format == "mjcf":
        world, _ = world_of_mjcf(file)
        return world
    skeleton, _ = loaded(file)
    world = dart.simulation.World()
    world.setGravity(GRAVITY)
    world.addSkeleton(skeleton)
    return world


class _Scene:
    """A world at the start of a run, as `SteppedScene`."""

    def __init__(self, world: Any, run: FileRun) -> None:
        self.world = world
        world.setTimeStep(run.method.timestep)
        skeletons = [world.getSkeleton(index) for index in range(world.getNumSkeletons())]
        self.skeletons = [skeleton for skeleton in skeletons if skeleton.getNumDofs()]
        joints = [joint for skeleton in self.skeletons for joint in joints_of(skeleton)]
        self.bodies = [joint.getChildBodyNode() for joint in joints if _moves(joint)]
        self.hinges = [joint for joint in joints if joint.getType() == "RevoluteJoint"]
        self.slides = [joint for joint in joints if joint.getType() == "PrismaticJoint"]
        self.free = [joint for joint in joints if joint.getType() == "FreeJoint"]
        bodies = [joint.getChildBodyNode().getName() for joint in self.free]
        self.names = Names(
            tuple(body.getName() for body in self.bodies),
            tuple(joint.getName() for joint in self.hinges),
            tuple(bodies),
            (*bodies, *(joint.getName() for joint in self.slides)),
        )
        for skeleton in self.skeletons if run.nudged else ():
            skeleton.setPositions(nudged(skeleton.getPositions()))
            skeleton.setVelocities(nudged(skeleton.getVelocities()))

    def advance(self, steps: int) -> None:
        for _ in range(steps):
            self.world.step()

    def seen(self) -> Seen:
        turns = [_attitude(joint.getChildBodyNode()) for joint in self.free]
        places = [joint.getChildBodyNode().getWorldTransform().translation() for joint in self.free]
        return Seen(
            position=np.array([body.getCOM() for body in self.bodies]).reshape(-1, 3),
            quaternion=np.array([_attitude(body) for body in self.bodies]).reshape(-1, 4),
            angles=np.array([joint.getPosition(0) for joint in self.hinges]),
            turns=np.array(turns).reshape(-1, 4),
            slides=np.array([*places, *((joint.getPosition(0), 0.0, 0.0) for joint in self.slides)]).reshape(-1, 3),
            regime=frozenset(_touching(self.world)),
        )


def _touching(world: Any) -> Iterator[str]:
    """Yield the contacts of the last step in words."""
    for contact in world.getLastCollisionResult().getContacts():
        frames = (contact.collisionObject1.getShapeFrame(), contact.collisionObject2.getShapeFrame())
        yield contact_of(frame.asShapeNode().getBodyNodePtr().getName() for frame in frames)


def _moves(joint: Any) -> bool:
    """Return whether a body can move: its joint has velocities, or one between it and the root has."""
    while joint is not None:
        if joint.getNumDofs():
            return True
        parent = joint.getParentBodyNode()
        joint = None if parent is None else parent.getParentJoint()
    return False


def _attitude(body: Any) -> Array:
    """Return the attitude (4,) of the frame of a body."""
    return np.array(body.getWorldTransform().quaternion().wxyz())
