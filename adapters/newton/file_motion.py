"""Run a whole scene in Newton as its importers make it from a file, in single precision.

The root of a URDF is welded to the world by the importer. The methods are the solvers that have limits of joints and contacts:
those that pass the model to MuJoCo Warp, XPBD and Steel. Actuators of an MJCF have the targets that the importer gives them.
"""

import warnings
from collections.abc import Iterator

import newton
import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.adapters.file_motion import FileFacts, FileMotion, FileRun, Names, Seen, check_run, contact_of, nudged, sampled
from bodycheck.adapters.mujoco_warp import graphs
from bodycheck.adapters.newton.robots import Imported, Joint, imported
from bodycheck.adapters.newton.solvers import OF_MUJOCO, SOLVERS
from bodycheck.adapters.quiet import overheard, refusal
from bodycheck.adapters.robot_numbers import scalar_first
from bodycheck.adapters.robot_reading import ModelRefused, RobotFile
from bodycheck.reference.kinematics import normalise, rotate

#: The methods, and the time step (s) of Newton's examples of robots.
METHODS = (*(f"MuJoCo-{scheme}" for scheme in OF_MUJOCO), "XPBD", "Steel")
TIMESTEP = 1 / 600


def file_facts(file: RobotFile) -> FileFacts:
    """Return the contents of a file on which a run depends, as `FileMotions.file_facts` does."""
    with overheard(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = imported(file).model
    friction = bool(model.joint_dof_count) and bool(np.any(model.joint_friction.numpy()))
    return FileFacts(Method(METHODS[0], TIMESTEP), METHODS, friction=friction)


def run_file(file: RobotFile, run: FileRun) -> FileMotion:
    """Return the motion of a scene, as `FileMotions.run_file` does."""
    check_run("Newton", run, METHODS)
    with overheard(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = imported(file)
        try:
            scene = _Scene(robot, run)
        except Exception as error:  # the conversion to a solver raises exceptions of many types
            raise ModelRefused(refusal(file.path, f"{type(error).__name__}: {error}")) from error
        return sampled(scene, run)


class _Scene:
    """A model with its solver at the start of a run, as `SteppedScene`."""

    def __init__(self, robot: Imported, run: FileRun) -> None:
        self.robot, model, state = robot, robot.model, robot.state
        if run.nudged:
            model.joint_q.assign(nudged(model.joint_q.numpy()))
            model.joint_qd.assign(nudged(model.joint_qd.numpy()))
        newton.eval_fk(model, model.joint_q, model.joint_qd, state)
        state.joint_q.assign(model.joint_q.numpy())
        state.joint_qd.assign(model.joint_qd.numpy())
        kind = SOLVERS[run.method.integrator]
        solver, control, following = kind.make(model, run.method), model.control(), model.state()
        pipeline = newton.CollisionPipeline(model) if kind.collides else None
        self.contacts = pipeline.contacts() if pipeline is not None else None

        def step() -> None:
            state.clear_forces()
            if pipeline is not None:
                pipeline.collide(state, self.contacts)
            solver.step(state, following, control, self.contacts, run.method.timestep)
            state.assign(following)

        self.graph = graphs.record(step)
        moving: set[int] = set()
        for joint in robot.joints:  # parents come before children
            if joint.moved.stop > joint.moved.start or joint.parent in moving:
                moving.add(joint.body)
        self.bodies = sorted(moving)
        self.free, self.balls = self._of("floating"), self._of("spherical")
        self.hinges, self.sliders = self._of("revolute"), self._of("prismatic")
        names = tuple(robot.names[joint.body] for joint in self.free)
        self.names = Names(
            tuple(robot.names[body] for body in self.bodies),
            tuple(joint.name for joint in self.hinges),
            (*names, *(joint.name for joint in self.balls)),
            (*names, *(joint.name for joint in self.sliders)),
        )

    def _of(self, kind: str) -> list[Joint]:
        return [joint for joint in self.robot.joints if joint.type == kind]

    def advance(self, steps: int) -> None:
        for _ in range(steps):
            graphs.replay(self.graph)

    def seen(self) -> Seen:
        model, state = self.robot.model, self.robot.state
        newton.eval_ik(model, state, state.joint_q, state.joint_qd)
        q = state.joint_q.numpy().astype(float)
        poses = state.body_q.numpy().astype(float)[self.bodies].reshape(-1, 7)
        centres = model.body_com.numpy().astype(float)[self.bodies].reshape(-1, 3)
        attitudes = normalise(poses[:, [6, 3, 4, 5]])
        free = [q[joint.held] for joint in self.free]
        turns = [*(part[3:] for part in free), *(q[joint.held] for joint in self.balls)]
        slides = [*(part[:3] for part in free), *((q[joint.held.start], 0.0, 0.0) for joint in self.sliders)]
        return Seen(
            position=poses[:, :3] + rotate(attitudes, centres) if len(poses) else poses[:, :3],
            quaternion=attitudes,
            angles=np.array([q[joint.held.start] for joint in self.hinges]),
            turns=normalise(np.array([scalar_first(turn) for turn in turns]).reshape(-1, 4)),
            slides=np.array(slides).reshape(-1, 3),
            regime=frozenset(self._touching()),
        )

    def _touching(self) -> Iterator[str]:
        """Yield the contacts of the last step in words, where Newton's collision detection finds them."""
        if self.contacts is None:
            return
        bodies = self.robot.model.shape_body.numpy()
        count = int(self.contacts.rigid_contact_count.numpy()[0])
        shapes = [array.numpy()[:count] for array in (self.contacts.rigid_contact_shape0, self.contacts.rigid_contact_shape1)]
        for pair in zip(*shapes, strict=True):
            yield contact_of("the world" if bodies[shape] < 0 else self.robot.names[bodies[shape]] for shape in pair)
