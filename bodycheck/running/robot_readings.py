"""Let engines read files of robot models, each with its own reader in its own worker process.

Every reading has a copy of its own of the file and of all files beside it. A reader that writes into its copy, or into a file
beside it, changes nothing that another engine reads.
"""

import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from pathlib import Path
from tempfile import mkdtemp
from typing import ClassVar, Literal

import numpy as np

from bodycheck.adapters import registry
from bodycheck.adapters.robot_reading import (
    Behaviour,
    FormatUnknown,
    JointStates,
    ModelRefused,
    RobotFile,
    RobotModels,
    RobotReading,
    RobotSteps,
)
from bodycheck.files.temporary import temporary_folder
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut, crash
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.results.outcome import AdapterFault
from bodycheck.running.engines import home
from bodycheck.running.robot_trials import TIMESTEP_S, behaviours

#: Time limit (s) for the reading of one file by one engine. Some engines compile code for it.
TIME_LIMIT_S = 120.0

#: The engine that defines the meaning of MJCF files.
MJCF_ENGINE = "mujoco"


@dataclass(frozen=True)
class Refused:
    """The engine refuses the file; the reason is in its own words."""

    reason: str


@dataclass(frozen=True)
class FormatMissing:
    """The engine has no reader for the format. none_at_all: whether it reads no robot models of any format."""

    reason: str
    none_at_all: bool = False


@dataclass(frozen=True)
class AtFault:
    """The adapter of the engine is at fault; the reason names it."""

    reason: str
    status: ClassVar[Literal["adapter-fault"]] = "adapter-fault"


@dataclass(frozen=True)
class Tried:
    """The behaviour of the joints of a robot in an engine."""

    behaviours: Mapping[str, Behaviour]


Answer = RobotReading | Refused | FormatMissing | AtFault | Crashed | TimedOut


@dataclass(frozen=True)
class Call:
    """A file that an engine reads, and the states and the gravity (m/s^2) at which it computes its terms.

    The engine reads a copy of the folder of the file, which is made in the folder `copies`.
    """

    engine: str
    file: RobotFile
    copies: str
    states: tuple[RobotState, ...]
    gravity: Vector


@dataclass(frozen=True)
class TrialCall:
    """A file that an engine has read, whose joints it moves. model: the model that the file describes."""

    call: Call
    reading: RobotReading
    model: RobotModel

    @property
    def engine(self) -> str:
        """The name of the engine."""
        return self.call.engine


#: A function from a file, the model that it describes, states and gravity to the answers of all engines by name.
Reader = Callable[[RobotFile, RobotModel | None, Sequence[RobotState], Vector], dict[str, Answer]]

#: A function from an MJCF file to the model that MuJoCo, which defines the format, makes of it.
Compile = Callable[[RobotFile], RobotModel | Refused | Crashed | TimedOut]


@contextmanager
def reader(engines: Sequence[str], jobs: int, limit: float = TIME_LIMIT_S) -> Iterator[Reader]:
    """Provide a function that lets all engines read a file. Their processes are kept from one file to the next.

    Parameters
    ----------
    engines
        The names of the engines.
    jobs
        The number of engines that read at the same time.
    limit
        The time limit of the reading of one file by one engine (s).
    """
    with temporary_folder() as copies, pool.Workers(answered, jobs, limit, group=_engine, home=home, kept=1) as workers:

        def read_file(
            file: RobotFile, model: RobotModel | None, states: Sequence[RobotState], gravity: Vector
        ) -> dict[str, Answer]:
            calls = [Call(name, file, str(copies), tuple(states), gravity) for name in engines]
            answers = {call.engine: answer for call, answer in workers.map(calls) if not isinstance(answer, Tried)}
            if model is not None and states:
                readings = [(call, answers[call.engine]) for call in calls]
                trials = [TrialCall(call, one, model) for call, one in readings if isinstance(one, RobotReading)]
                for trial, outcome in workers.map(trials):
                    answers[trial.engine] = _with_behaviours(answers[trial.engine], outcome)
            return {name: answers[name] for name in engines}

        yield read_file


def _with_behaviours(reading: Answer, outcome: Answer | Tried) -> Answer:
    """Return a reading with the behaviour of its joints, or with a note that says why nothing is tried."""
    assert isinstance(reading, RobotReading)  # nothing else is tried
    match outcome:
        case Tried(behaviours=tried):
            return replace(reading, behaviours=tried)
        case Refused(reason=reason) | Crashed(reason=reason) | TimedOut(reason=reason):
            return replace(reading, notes=(*reading.notes, f"nothing is tried by motion: {reason}"))
        case _:
            return outcome


def answered(call: Call | TrialCall) -> RobotReading | Refused | FormatMissing | AtFault | Tried:
    """Return an engine's reading of a file, or the behaviour of the joints of a file that it has read.

    This is called in the worker process of the engine.
    """
    return read(call) if isinstance(call, Call) else tried(call)


def tried(trial: TrialCall) -> Tried | Refused | AtFault:
    """Return the behaviour of the joints of a robot in an engine; empty if its adapter has no `RobotSteps`."""
    adapter, call = registry.load(trial.engine), trial.call
    if not isinstance(adapter, RobotSteps):
        return Tried({})
    rounding = float(np.finfo(adapter.engine.precision).eps)
    with own_copy(call.file, call.copies) as file, np.errstate(all="ignore"):  # motions that overflow decide nothing

        def step(starts: Sequence[JointStates], steps: int) -> Sequence[JointStates]:
            return adapter.step_robot(file, starts, TIMESTEP_S, steps)

        try:
            return Tried(behaviours(step, trial.reading, trial.model, call.states[0], rounding))
        except ModelRefused as error:
            return Refused(str(error))
        except MemoryError:
            raise
        except Exception as error:  # as in `read`
            return AtFault(f"the adapter of {call.engine} is at fault: {crash(error).reason}")


def read(call: Call) -> RobotReading | Refused | FormatMissing | AtFault:
    """Return an engine's reading of a file."""
    adapter = registry.load(call.engine)
    if not isinstance(adapter, RobotModels):
        return FormatMissing(f"{call.engine} has no reader of robot models", none_at_all=True)
    with own_copy(call.file, call.copies) as file:
        return _read(call, adapter, file)


def _read(call: Call, adapter: RobotModels, file: RobotFile) -> RobotReading | Refused | FormatMissing | AtFault:
    try:
        reading = adapter.read_robot(file, call.states, call.gravity)
        check_shapes(reading, len(call.states))
    except ModelRefused as error:
        return Refused(str(error))
    except FormatUnknown as error:
        return FormatMissing(str(error))
    except MemoryError:
        raise
    except AdapterFault as error:
        return AtFault(f"the adapter of {call.engine} is at fault: {error}")
    except Exception as error:  # an adapter raises `ModelRefused` for whatever its engine says of a file
        return AtFault(f"the adapter of {call.engine} is at fault: {crash(error).reason}")
    return reading


@contextmanager
def own_copy(file: RobotFile, copies: str) -> Iterator[RobotFile]:
    """Provide a file in a new copy of its folder, which the end of the context removes. copies: the folder for the copy."""
    folder = Path(mkdtemp(dir=copies))
    try:
        shutil.copytree(Path(file.path).parent, folder, dirs_exist_ok=True)
        yield replace(file, path=str(folder / Path(file.path).name))
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def check_shapes(reading: RobotReading, states: int) -> None:
    """Raise `AdapterFault` unless there are terms at the requested number of states, and all have the right shapes."""
    if len(reading.terms) != states:
        raise AdapterFault(f"there are terms at {len(reading.terms)} states, not at {states}")
    count = reading.velocities
    shapes = {part.name: (count, count) if part.name == "mass_matrix" else (count,) for part in fields(Terms)[2:]}
    for terms in reading.terms:
        arrays = [(name, getattr(terms, name), shape) for name, shape in shapes.items()]
        arrays += [(f"the pose of {name}", pose, (7,)) for name, pose in terms.poses.items()]
        arrays += [(f"the Jacobian of {name}", jacobian, (6, count)) for name, jacobian in terms.jacobians.items()]
        for name, array, shape in arrays:
            if array is not None and np.shape(array) != shape:
                raise AdapterFault(f"{name} has the shape {np.shape(array)}, not {shape}")


@contextmanager
def compiler(limit: float = TIME_LIMIT_S) -> Iterator[Compile]:
    """Provide a function from an MJCF file to the model that MuJoCo, which defines the format, makes of it."""
    with temporary_folder() as copies, pool.Workers(_compiled, 1, limit, group=_mujoco, home=home, kept=1) as workers:

        def compile_file(file: RobotFile) -> RobotModel | Refused | Crashed | TimedOut:
            return workers.call((file, str(copies)))

        yield compile_file


def _compiled(call: tuple[RobotFile, str]) -> RobotModel | Refused:
    # The reader of MuJoCo is imported in the worker process of MuJoCo.
    from bodycheck.adapters.mujoco import robots

    try:
        with own_copy(*call) as file:
            model: RobotModel = robots.compiled(file.path)
    except ModelRefused as error:
        return Refused(str(error))
    return model


def _engine(call: Call | TrialCall) -> str:
    return call.engine


def _mujoco(call: object) -> str:
    return MJCF_ENGINE


def readable(answers: Mapping[str, Answer]) -> dict[str, Answer]:
    """Return the answers of those engines that read robot models of some format."""
    return {name: one for name, one in answers.items() if not (isinstance(one, FormatMissing) and one.none_at_all)}
