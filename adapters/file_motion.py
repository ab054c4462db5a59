"""The motion of a whole scene in an engine, as the engine's own reader has made it from a robot's file.

Everything that the file says acts: contacts, tendons, actuators, limits, equality constraints. The time step and the method are
those of the file, or others that the caller names. Positions and attitudes are in the conventions of `bodycheck.reference`.
"""

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from bodycheck.adapters.contract import EngineDiverged, EngineReset, Method
from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: Lines in the frame of a body, each from one point (m) to another.
Sticks = tuple[tuple[Vector, Vector], ...]


class MotionRefused(Exception):
    """The engine can read a file, but a setting of the run is not possible, such as a keyframe that the file lacks."""


@dataclass(frozen=True)
class FileFacts:
    """The contents of a file on which a run depends.

    Attributes
    ----------
    method
        The method that the file itself states, with its time step (s).
    methods
        The spellings of the methods that the engine offers for the file, that of the file first.
    actuators, keyframes
        The names of the actuators and of the keyframes, in their order.
    conserves
        Whether the scene keeps its energy: nothing in it can take energy away or add any.
    driven
        Whether actuators act.
    friction
        Whether there is dry friction in joints or tendons.
    options
        The options of methods for files, with the types of their values.
    settings
        The values of the options `iterations` and `tolerance` in the file; empty if the engine has no such solver.
    """

    method: Method
    methods: tuple[str, ...]
    actuators: tuple[str, ...] = ()
    keyframes: tuple[str, ...] = ()
    conserves: bool = False
    driven: bool = False
    friction: bool = False
    options: Mapping[str, type[int] | type[float]] = field(default_factory=dict)
    settings: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Controls:
    """The controls of actuators over time.

    Attributes
    ----------
    times
        The instants (k,), s, in ascending order, from each of which on a row holds until the next one.
    values
        The controls (k, a), with a column for each of `names`.
    names
        The names of the actuators.
    """

    times: Array
    values: Array
    names: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class FileRun:
    """The settings of a run.

    Attributes
    ----------
    method
        The method and its time step (s).
    times
        The instants (n,), s, at which the motion is sampled, in ascending order: multiples of the time step.
    keyframe
        The name of the keyframe in which the run starts; empty for the first one, or the initial state if the file has none.
    controls
        The controls; None for those of the keyframe, or zero.
    nudged
        Whether each initial coordinate and velocity is changed by one rounding.
    """

    method: Method
    times: Array
    keyframe: str = ""
    controls: Controls | None = None
    nudged: bool = False


@dataclass(frozen=True)
class Names:
    """The names of the bodies and joints of a motion, in the order of its arrays of the same names; see `FileMotion`."""

    bodies: tuple[str, ...] = ()
    angles: tuple[str, ...] = ()
    turns: tuple[str, ...] = ()
    slides: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Seen:
    """A scene at one instant.

    Attributes
    ----------
    position, quaternion
        Centres of mass (b, 3), m, and attitudes (b, 4) of the bodies that can move.
    angles, turns, slides
        The angles (j,), rad, the attitudes (k, 4) and the displacements (s, 3), m, of joints.
    regime
        What acts, in words, as in `FileMotion.regimes`.
    """

    position: Array
    quaternion: Array
    angles: Array
    turns: Array
    slides: Array
    regime: frozenset[str] = frozenset()


class SteppedScene(Protocol):
    """A scene of an engine at the start of a run, which `sampled` steps."""

    @property
    def names(self) -> Names:
        """The names of what `seen` returns."""
        ...

    def advance(self, steps: int) -> None:
        """Make steps. Raises `EngineDiverged` and `EngineReset`."""
        ...

    def seen(self) -> Seen:
        """Return the present state."""
        ...


@dataclass(frozen=True, eq=False)
class FileMotion:
    """The motion of a scene at n instants.

    Attributes
    ----------
    t
        The instants (n,), s; fewer than asked for if the engine stopped.
    position, quaternion
        Centres of mass (b, n, 3), m, and attitudes (b, n, 4) of the bodies that can move.
    angles
        The angles of joints (j, n), rad.
    turns
        The attitudes of joints of several angles, as unit quaternions (k, n, 4).
    slides
        The displacements of joints (s, n, 3), m.
    names
        The names of the bodies and joints, by which motions in several engines are compared.
    sticks
        For each body the lines by which pictures show it: pairs of points (m) along its axes, from its centre of mass; none if
        the adapter reports none.
    energy
        The potential and the kinetic energy (2, n), J; None if the scene does not keep its energy.
    regimes
        For each instant what acts there: contacts, limits and saturated actuators, in words.
    steps
        The number of steps.
    wall_time
        The wall time of stepping (s).
    ended
        The reason why the engine stopped, with its instant; empty if it did not.
    reset
        Whether the engine reset the scene.
    warnings
        What the engine warned of, and the largest number of iterations of its solver, by words.
    """

    t: Array
    position: Array
    quaternion: Array
    angles: Array
    turns: Array
    slides: Array
    energy: Array | None
    regimes: tuple[frozenset[str], ...]
    steps: int
    wall_time: float
    ended: str = ""
    reset: bool = False
    warnings: Mapping[str, int] = field(default_factory=dict)
    names: Names = field(default_factory=Names)
    sticks: tuple[Sticks, ...] = ()


@runtime_checkable
class FileMotions(Protocol):
    """An adapter whose engine can run a whole scene as its reader makes it from a file."""

    def file_facts(self, file: RobotFile) -> FileFacts:
        """Return the contents of a file on which a run depends. Raises `ModelRefused` and `FormatUnknown`."""
        ...

    def run_file(self, file: RobotFile, run: FileRun) -> FileMotion:
        """Return the motion of a scene. Raises `ModelRefused`, `FormatUnknown` and `MotionRefused`."""
        ...


def strides(times: Array, timestep: float) -> list[int]:
    """Return the numbers of steps (n,) from each of n instants (s) to the next, the first from the start."""
    return [int(steps) for steps in np.diff(np.rint(times / timestep), prepend=0.0)]


def nudged(values: ArrayLike) -> Array:
    """Return values that are larger by one rounding, by 1.1e-16 where that is more; in single precision, by 6e-8."""
    array = np.asarray(values)
    if array.dtype != np.float32:
        array = array.astype(np.float64)
    smallest = array.dtype.type(np.finfo(array.dtype).epsneg)
    return np.asarray(np.maximum(np.nextafter(array, array.dtype.type(np.inf)), array + smallest))


def check_run(engine: str, run: FileRun, methods: Sequence[str]) -> None:
    """Raise `MotionRefused` unless an engine without keyframes, controls and options of methods can make a run.

    engine: the name of the engine in messages. methods: the spellings of its methods.
    """
    if run.method.name not in methods:
        raise MotionRefused(f"{engine} has no method {run.method.name!r} for files; there are: {', '.join(methods)}")
    if run.keyframe:
        raise MotionRefused(f"{engine} reads no keyframe {run.keyframe!r}")
    if run.controls is not None:
        raise MotionRefused(f"{engine} is not given the controls of actuators of a file")


def contact_of(names: Iterable[str]) -> str:
    """Return the contact of two bodies in words, the same in whichever order an engine names them."""
    one, other = sorted(names)
    return f"contact of {one} and {other}"


def sampled(scene: SteppedScene, run: FileRun) -> FileMotion:
    """Return the motion of a scene without energies: it is stepped from its start through the instants of a run.

    The motion ends early if the engine stops it, or if a position is not finite.
    """
    every: list[Seen] = []
    done, wall_time, ended, reset = 0, 0.0, "", False
    for stride in strides(run.times, run.method.timestep):
        start = time.perf_counter()
        try:
            scene.advance(stride)
        except EngineDiverged as error:
            ended, reset = str(error), isinstance(error, EngineReset)
        wall_time += time.perf_counter() - start
        if ended:
            break
        done += stride
        state = scene.seen()
        if not all(np.isfinite(part).all() for part in (state.position, state.quaternion, state.angles, state.slides)):
            ended = f"its state is not finite at t = {done * run.method.timestep:.6g} s"
            break
        every.append(state)
    names = scene.names
    return FileMotion(
        t=run.times[: len(every)],
        position=_over_time([one.position for one in every], (len(names.bodies), 3)),
        quaternion=_over_time([one.quaternion for one in every], (len(names.bodies), 4)),
        angles=_over_time([one.angles for one in every], (len(names.angles),)),
        turns=_over_time([one.turns for one in every], (len(names.turns), 4)),
        slides=_over_time([one.slides for one in every], (len(names.slides), 3)),
        energy=None,
        regimes=tuple(one.regime for one in every),
        steps=done,
        wall_time=wall_time,
        ended=ended,
        reset=reset,
        names=names,
    )


def _over_time(states: Sequence[Array], shape: tuple[int, ...]) -> Array:
    """Return n arrays of a shape (k, ...) as one array (k, n, ...) in double precision."""
    return np.array(states, np.float64).reshape(len(states), *shape).swapaxes(0, 1)
