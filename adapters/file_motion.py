"""The motion of a whole scene in an engine, as the engine's own reader has made it from a robot's file.

Everything that the file says acts: contacts, tendons, actuators, limits, equality constraints. The time step and the method are
those of the file, or others that the caller names. Positions and attitudes are in the conventions of `bodycheck.reference`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.reference.trajectory import Array


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
    """

    method: Method
    methods: tuple[str, ...]
    actuators: tuple[str, ...] = ()
    keyframes: tuple[str, ...] = ()
    conserves: bool = False
    driven: bool = False
    friction: bool = False
    options: Mapping[str, type[int] | type[float]] = field(default_factory=dict)


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


def nudged(values: Sequence[float] | Array) -> Array:
    """Return values that are larger by one rounding, by 1.1e-16 where that is more."""
    array = np.asarray(values, np.float64)
    return np.maximum(np.nextafter(array, np.inf), array + 2.0**-53)
