"""Compare engines' readings of robot files with the files."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bodycheck.adapters.contract import Engine
from bodycheck.adapters.robot_reading import RobotReading
from bodycheck.errors import BadInput
from bodycheck.files.temporary import temporary_folder
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.state import VELOCITIES
from bodycheck.reference.robots.states import seeded_states
from bodycheck.reports.quantities import count
from bodycheck.robots.elements import printable
from bodycheck.running import robot_readings
from bodycheck.running.robot_readings import Answer, AtFault, Compile, FormatMissing, Reader
from bodycheck.studies.parity.behaviours import as_moving, with_sources
from bodycheck.studies.parity.comparing import Asked, asked, compare
from bodycheck.studies.parity.conventions import PROBES
from bodycheck.studies.parity.diagnosis.explaining import diagnosed
from bodycheck.studies.parity.files import NamedFile, named
from bodycheck.studies.parity.models import Robot, Unreadable, read
from bodycheck.studies.parity.motion import sentence
from bodycheck.studies.parity.quantities import FILE, MODEL, QUANTITIES, Quantity
from bodycheck.studies.parity.rows import Compared, ParityRow, row

if TYPE_CHECKING:
    from bodycheck.running.campaign import Advance

#: The tolerance of an engine that computes in single precision is at least this.
SINGLE_PRECISION = 1e-4

#: The gravitational acceleration at which a URDF is compared (m/s^2), as a URDF states no gravity.
GRAVITY = (0.0, 0.0, -9.81)


#: The longest motion that is compared (s). Falling chains are chaotic, so that longer motions show nothing more.
LONGEST_MOTION = 10.0


#: The most numbers in the Jacobians of all links at all states. Several copies of them are in memory, with 8 or 16 bytes per
#: number. A robot of 200 links and 200 joints has this many numbers at 100 states.
LARGEST = 24_000_000


@dataclass(frozen=True)
class Asking:
    """The options of a comparison of models.

    Parameters
    ----------
    states
        The number of states. Robots of more than some two hundred links have fewer.
    seed
        The seed of the states.
    tolerance
        The largest relative difference that counts as agreement.
    packages
        The folders in which packages may be found.
    motion
        The time (s) after which free motions are compared; 0 for none.
    """

    states: int = 100
    seed: int = 0
    tolerance: float = 1e-9
    packages: tuple[Path, ...] = ()
    motion: float = 0.0


@dataclass(frozen=True)
class Parity:
    """The results for one model.

    Attributes
    ----------
    name, path
        The name of the model, and the path of its file.
    rows
        The rows about the file, and then those of each engine.
    notes
        Notes for users on each engine's reading, by the name of the engine.
    removed
        The parts of the file that the copy for engines lacks, in words.
    """

    name: str
    path: str
    rows: tuple[ParityRow, ...]
    notes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    removed: tuple[str, ...] = ()


@contextmanager
def asking(engines: Mapping[str, Engine], jobs: int) -> Iterator[tuple[Reader, Compile]]:
    """Provide functions by which engines read files and an MJCF is compiled, in processes that end with the context."""
    with robot_readings.reader(tuple(engines), jobs) as reader, robot_readings.compiler() as compile_:
        yield reader, compile_


def study(
    engines: Mapping[str, Engine],
    files: Sequence[NamedFile],
    asks: Asking,
    jobs: int,
    progress: "Advance",
    only_readers: bool = False,
) -> Iterator[Parity]:
    """Yield the results of each model, in the order of the files. A file that cannot be read has a row that says so.

    Parameters
    ----------
    engines
        The records of the engines by name.
    files
        The files.
    asks
        The options of the comparison.
    jobs
        The number of engines that read at the same time.
    progress
        A function that is called with a text after each model.
    only_readers
        Whether to leave out engines that read no robot models of any format.

    Raises
    ------
    BadInput
        If none of the files can be read; the text has the reasons of all of them.
    """
    with temporary_folder() as folder, asking(engines, jobs) as (reader, compile_):
        robots = []
        for index, file in enumerate(files):
            into = folder / str(index)
            into.mkdir()
            robots.append(read(file, asks.packages, into, compile_))
        unreadable = [one for one in robots if isinstance(one, Unreadable)]
        if len(unreadable) == len(robots):
            raise BadInput("\n".join(printable(reason) for one in unreadable for reason in one.reasons))
        for one in robots:
            yield _of_robot(engines, one, asks, reader, only_readers)
            progress(one.name)


def one(engines: Mapping[str, Engine], path: Path, asks: Asking, into: Path, how: tuple[Reader, Compile]) -> Parity:
    """Return the results of one model.

    into: an empty folder for the copy of its file. how: the functions that `asking` provides.
    """
    (file,) = named([path]).files
    return _of_robot(engines, read(file, asks.packages, into, how[1]), asks, how[0], only_readers=True)


def _of_robot(
    engines: Mapping[str, Engine], robot_read: Robot | Unreadable, asks: Asking, reader: Reader, only_readers: bool
) -> Parity:
    if isinstance(robot_read, Unreadable):
        return _unread(robot_read)
    with np.errstate(all="ignore"):  # what engines answer may be infinite or not a number, which makes a difference
        return _compared(engines, robot_read, asks, reader, only_readers)


def _compared(engines: Mapping[str, Engine], robot_read: Robot, asks: Asking, reader: Reader, only_readers: bool) -> Parity:
    rows = [row(robot_read.name, FILE, "", one) for one in file_rows(robot_read)]
    notes: dict[str, tuple[str, ...]] = {}
    gravity = GRAVITY if robot_read.model is None else robot_read.model.gravity
    states = (
        ()
        if robot_read.model is None
        else seeded_states(robot_read.model, fitting(robot_read.model, asks.states) + PROBES, asks.seed)
    )
    answers = reader(robot_read.file, robot_read.model, states, gravity)
    if only_readers:
        answers = robot_readings.readable(answers)
    given = None if robot_read.model is None else asked(robot_read.model, states, gravity, robot_read.stated_gravity)
    for name, answer in answers.items():
        compared, sentences = of_answer(answer, given, engines[name], asks)
        notes[name] = tuple(map(printable, sentences))
        rows += [row(robot_read.name, name, engines[name].version, one) for one in judged(compared, answer, robot_read)]
    return Parity(printable(robot_read.name), robot_read.path, tuple(rows), notes, robot_read.removed)


def _unread(file: Unreadable) -> Parity:
    reasons = (Compared("unreadable", None, MODEL, reason) for reason in file.reasons)
    return Parity(printable(file.name), file.path, tuple(row(file.name, FILE, "", one) for one in reasons))


def fitting(model: RobotModel, states: int) -> int:
    """Return the number of states at which a model is compared, at most `states`.

    It is smaller if the Jacobians, including those at the probe states, would take too much memory.
    """
    velocities = sum(VELOCITIES[joint.type] for joint in model.joints)
    return max(1, min(states, LARGEST // max(1, 6 * velocities * len(model.links)) - PROBES))


def of_answer(
    answer: Answer, given: Asked | None, engine: Engine, asks: Asking
) -> tuple[tuple[Compared, ...], tuple[str, ...]]:
    """Return the rows of an engine's answer about a model, and notes for users.

    given: the questions to the engine; None for a file that describes no model, which engines are asked to read all the same.
    """
    if isinstance(answer, FormatMissing):
        return (Compared("not-modelled", None, MODEL, answer.reason),), ()
    if isinstance(answer, AtFault | Crashed | TimedOut):
        return (Compared(answer.status, None, MODEL, answer.reason),), ()
    if not isinstance(answer, RobotReading):
        return (Compared("refused", None, MODEL, answer.reason),), ()
    if given is None:
        content = f"{count(len(answer.bodies), 'body', 'bodies')}, {count(len(answer.joints), 'joint')}"
        return (Compared("accepted-unphysical", None, MODEL, content),), answer.notes
    least = SINGLE_PRECISION if engine.precision == "float32" else 0.0
    compared = compare(given, as_moving(answer), max(asks.tolerance, least, answer.rounding))
    diagnosis = diagnosed(compared)
    notes = [*answer.notes, *compared.convention.notes]
    if asks.motion and diagnosis.model is not None:
        notes.append(sentence(compared.match.bodies, diagnosis.model, given.states[0], given.gravity, asks.motion))
    return tuple(with_sources(diagnosis.rows, compared.rows, answer)), tuple(notes)


def file_rows(robot_read: Robot) -> Iterator[Compared]:
    """Yield the rows about the file itself: the faults that its specification refuses, and values that no body can have."""
    if robot_read.unanswered is not None:
        yield robot_read.unanswered
    for fault in robot_read.faults:
        yield Compared("refused", _quantity(fault.quantity), fault.subject, fault.text)
    named_faults = {(fault.quantity, fault.subject) for fault in robot_read.faults}
    for one in robot_read.impossible:
        if (one.quantity, one.subject) not in named_faults:
            yield Compared("refused", _quantity(one.quantity), one.subject, one.text)


def judged(rows: Sequence[Compared], answer: Answer, robot_read: Robot) -> Iterator[Compared]:
    """Yield the rows of an engine, with the status "accepted-unphysical" for impossible values of the file that it accepts."""
    if not isinstance(answer, RobotReading) or robot_read.model is None:
        yield from rows
        return
    left = {(_quantity(one.quantity), one.subject): one.text for one in robot_read.impossible}
    left |= {("parent", fault.subject): fault.text for fault in robot_read.faults if fault.quantity == "parent"}
    for one in rows:
        text = None if one.status == "not-modelled" else left.pop((one.quantity, one.subject), None)
        if text is not None and one.status == "agrees":
            yield Compared("accepted-unphysical", one.quantity, one.subject, one.engine_value, text, source=one.source)
        else:
            yield one
    names = {*answer.links, *(joint.name for joint in answer.joints), MODEL}
    for (quantity, subject), text in left.items():
        if subject in names:
            yield Compared("accepted-unphysical", quantity, subject, "", text, source="told")


def _quantity(name: str) -> Quantity | None:
    return next((known for known in QUANTITIES if known == name), None)
