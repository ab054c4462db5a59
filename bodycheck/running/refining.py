"""Run a scene with several time steps, for estimates of the error without a truth. This is called in the workers of engines.

A scene is a case, of which the truth is not used, or the file of a robot that the engine reads itself.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.engine_name import in_words
from bodycheck.adapters.file_motion import FileFacts, FileMotions, FileRun, MotionRefused, Names, Sticks, nudged
from bodycheck.adapters.robot_reading import FormatUnknown, ModelRefused, RobotFile
from bodycheck.casefile.content import Case
from bodycheck.reference.mechanisms.mechanism import AnyScene, BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import EulerRates, Scene, State
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results.outcome import Completed, Diverged
from bodycheck.running.simulation import ended_by, motion_in

#: A tuple of numbers.
Numbers = TypeVar("Numbers", bound=tuple[float, ...])


@dataclass(frozen=True)
class AskFile:
    """The question what a file contains."""

    engine: str
    file: RobotFile


@dataclass(frozen=True, eq=False)
class RunFile:
    """A run of a file."""

    engine: str
    file: RobotFile
    run: FileRun


@dataclass(frozen=True, eq=False)
class RunCase:
    """A run of a case: its method, its instants (n,), s, and whether its initial state is changed by one rounding."""

    engine: str
    case: Case
    method: Method
    times: Array
    nudged: bool


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of a scene at n instants.

    Attributes
    ----------
    t
        The instants (n,), s.
    position, quaternion
        Centres of mass (b, n, 3), m, and attitudes (b, n, 4) of bodies.
    angles, turns, slides
        Angles (j, n), rad, attitudes (k, n, 4) and displacements (s, n, 3), m, of joints. Those of a case follow from the poses
        of its bodies, and are empty here.
    energy
        The potential and the kinetic energy (2, n), J; None if the energy is not kept, or follows from the states.
    trajectory
        The states of a case; None for a file.
    regimes
        For each instant what acts there, in words; empty if it is not known.
    steps, wall_time
        The number of steps, and the wall time of stepping (s).
    notes
        Warnings of the engine, and the iterations of its solver.
    names
        The names of the bodies and joints of a file; none for a case.
    sticks
        The lines by which pictures show the bodies of a file, as in `FileMotion`.
    """

    t: Array
    position: Array
    quaternion: Array
    angles: Array
    turns: Array
    slides: Array
    energy: Array | None
    trajectory: Trajectory | None
    regimes: tuple[frozenset[str], ...]
    steps: int
    wall_time: float
    notes: Mapping[str, int] = field(default_factory=dict)
    names: Names = field(default_factory=Names)
    sticks: tuple[Sticks, ...] = ()

    def part(self, rows: NDArray[np.int64]) -> "Motion":
        """Return the motion at some of its instants, given by their indices (k,)."""
        places = (self.position[:, rows], self.quaternion[:, rows])
        joints = (self.angles[:, rows], self.turns[:, rows], self.slides[:, rows]) if self.trajectory is None else self._joints
        return replace(
            self,
            t=self.t[rows],
            position=places[0],
            quaternion=places[1],
            angles=joints[0],
            turns=joints[1],
            slides=joints[2],
            energy=None if self.energy is None else self.energy[:, rows],
            trajectory=None if self.trajectory is None else self.trajectory.part(rows),
            regimes=tuple(self.regimes[row] for row in rows) if self.regimes else (),
        )

    @property
    def _joints(self) -> tuple[Array, Array, Array]:
        return self.angles, self.turns, self.slides


@dataclass(frozen=True)
class Ended:
    """A run that did not complete. status: `diverged`, `reset`, `unsupported`, `refused` or `crashed`."""

    status: str
    reason: str


Call = AskFile | RunFile | RunCase
Answer = FileFacts | Motion | Ended


@dataclass(frozen=True, eq=False)
class Timed:
    """The answer to a call, and the processor time (s) that it took in the worker."""

    answer: Answer
    seconds: float


def timed(call: Call) -> Timed:
    """Return the answer of an engine to a call with its processor time, which other programs of the machine do not change."""
    start = time.process_time()
    answer = perform(call)
    return Timed(answer, time.process_time() - start)


def perform(call: Call) -> Answer:
    """Return the answer of an engine to a call."""
    if isinstance(call, RunCase):
        return run_case(call)
    adapter = registry.load(call.engine)
    if not isinstance(adapter, FileMotions):
        return Ended("unsupported", f"{call.engine} cannot run whole scenes of robots' files here")
    try:
        return adapter.file_facts(call.file) if isinstance(call, AskFile) else run_file(adapter, call)
    except ModelRefused as error:
        return Ended("refused", str(error))
    except (FormatUnknown, MotionRefused) as error:
        return Ended("unsupported", str(error))


def engine_of(call: Call) -> str:
    """Return the engine of a call, by which calls share processes."""
    return call.engine


def run_file(adapter: FileMotions, call: RunFile) -> Motion | Ended:
    """Return the motion of a file, or why there is none."""
    motion = adapter.run_file(call.file, call.run)
    if motion.ended:
        return Ended("reset" if motion.reset else "diverged", motion.ended)
    parts = (motion.t, motion.position, motion.quaternion, motion.angles, motion.turns, motion.slides, motion.energy)
    about = (motion.regimes, motion.steps, motion.wall_time, motion.warnings, motion.names, motion.sticks)
    return Motion(*parts, None, *about)


def run_case(call: RunCase) -> Motion | Ended:
    """Return the motion of a case, or why there is none."""
    adapter = registry.load(call.engine)
    scene = nudged_scene(call.case.scene) if call.nudged else call.case.scene
    try:
        outcome = motion_in(adapter, call.engine, scene, call.method, call.times)
    except (Exception, SystemExit) as error:  # an engine may raise anything
        outcome = ended_by(error, in_words(call.engine, adapter.engine.version), call.case.name)
    match outcome:
        case Completed():
            trajectory = outcome.trajectory
            position, quaternion = (
                values if isinstance(scene, Mechanism) else values[None]
                for values in (trajectory.position, trajectory.quaternion)
            )
            none = (np.empty((0, 0)), np.empty((0, 0, 4)), np.empty((0, 0, 3)), None)
            return Motion(trajectory.t, position, quaternion, *none, trajectory, (), outcome.steps, outcome.wall_time)
        case Diverged(signal="reset"):
            return Ended("reset", outcome.reason)
        case _:
            return Ended(outcome.status, outcome.reason)


def nudged_scene(scene: AnyScene) -> AnyScene:
    """Return a scene whose initial coordinates and velocities are larger by one rounding."""
    if isinstance(scene, Scene):
        state = scene.initial
        position, velocity = _nudged(state.position), _nudged(state.velocity)
        moved = State(position, _nudged(state.quaternion), velocity, _nudged(state.angular_velocity))
        return replace(scene, initial=moved)
    return replace(scene, bodies=tuple(map(_nudged_body, scene.bodies)), joints=tuple(map(_nudged_joint, scene.joints)))


def _nudged_body(body: JointedBody) -> JointedBody:
    return body if body.start is None else replace(body, start=_nudged_start(body.start))


def _nudged_start(start: BodyStart) -> BodyStart:
    """Return the initial state of a free body, changed by one rounding; Euler angles and their rates are kept."""
    attitude = start.attitude if not isinstance(start.attitude, tuple) else _nudged(start.attitude)
    rotation = start.rotation if isinstance(start.rotation, EulerRates) else _nudged(start.rotation)
    return BodyStart(_nudged(start.position), attitude, _nudged(start.velocity), rotation)


def _nudged_joint(joint: Joint) -> Joint:
    """Return a joint with an initial state that is changed by one rounding; a joint that follows another one is kept."""
    if joint.mimic is not None:
        return joint
    return replace(joint, start=_nudged(joint.start), start_velocity=_nudged(joint.start_velocity))


def _nudged(values: Numbers) -> Numbers:
    return cast(Numbers, tuple(nudged(values).tolist()))
