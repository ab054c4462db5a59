"""The outcomes of a run: a closed set of frozen types with the same attributes `status`, `failed` and `reason`."""

from dataclasses import dataclass, field
from typing import ClassVar, Literal, Protocol

from bodycheck.adapters.contract import Efforts, Method
from bodycheck.figures.definition import InterfaceLoad, Load
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Plane
from bodycheck.reference.sensors.readings import Sensed
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Trajectory
from bodycheck.results.key import RunKey

#: The integrator of a motion that somebody recorded: how it was computed is not known.
RECORDED = "recorded"


class AdapterFault(Exception):
    """An adapter returned values that cannot be the states of its engine; the text says why."""


class Stored(Protocol):
    """A trajectory that is kept outside memory."""

    def read(self) -> Trajectory:
        """Return the trajectory. Raises `BadFolder` if it cannot be read."""


class StoredReadings(Protocol):
    """Readings of sensors that are kept outside memory."""

    def read(self) -> Sensed:
        """Return the readings. Raises `BadFolder` if they cannot be read."""


@dataclass(frozen=True, eq=False)
class Completed:
    """The engine completed the run.

    Attributes
    ----------
    states
        The trajectory of a run made in this process, or the place from which a stored trajectory can be read.
    steps
        Number of steps taken; with error control, those of a run to the end without samples between.
    wall_time
        Wall time of stepping alone (s); 0 if it is not known, as for a recorded motion.
    load
        The load of the contact; None in free flight, and if the engine does not report it.
    quaternion_norm_error
        The largest deviation from 1 of the norm of a quaternion, as the engine returned it; None if it is not known.
    interfaces
        The loads between bodies at rest; None if no bodies rest, or the engine does not report the loads.
    rejected, evaluations
        The numbers of rejected steps and of evaluations of the accelerations that belong to `steps`; None if the engine does
        not count them, and for steps of fixed size.
    efforts
        When the efforts of driven joints were computed, which the wall time includes; empty if no joint is driven.
    contact_terms
        What the engine was handed in the place of the scene's friction and restitution; empty if it was handed exactly these.
    readings
        The readings of sensors, or the place from which stored readings can be read; None if the case has no sensors, or the
        adapter reads none.
    """

    states: Trajectory | Stored
    steps: int
    wall_time: float
    load: Load | None = None
    quaternion_norm_error: float | None = None
    interfaces: tuple[InterfaceLoad, ...] | None = None
    rejected: int | None = None
    evaluations: int | None = None
    efforts: Efforts = ""
    contact_terms: str = ""
    readings: Sensed | StoredReadings | None = None
    status: ClassVar[str] = "ok"
    failed: ClassVar[bool] = False
    reason: ClassVar[str] = ""

    @property
    def trajectory(self) -> Trajectory:
        """The states at the sampled instants; stored states are read from disk each time, and not kept."""
        return self.states if isinstance(self.states, Trajectory) else self.states.read()

    @property
    def sensed(self) -> Sensed | None:
        """The readings of sensors; stored ones are read from disk each time, and not kept."""
        return self.readings if self.readings is None or isinstance(self.readings, Sensed) else self.readings.read()


@dataclass(frozen=True)
class Unsupported:
    """The engine cannot model what the scene requires; also the outcome of a run without a truth for comparison."""

    reason: str
    status: ClassVar[str] = "unsupported"
    failed: ClassVar[bool] = False


@dataclass(frozen=True)
class Diverged:
    """The states are not finite, have an impossible energy or never change, or the engine stopped or reset the simulation.

    Attributes
    ----------
    reason
        The event, and its time.
    signal
        The signal of the engine itself: nothing, that it gave up, or that it reset the simulation.
    trajectory
        The states up to the event and the first state after it, if the engine returned any.
    """

    reason: str
    signal: Literal["none", "gave up", "reset"] = "none"
    trajectory: Trajectory | None = field(default=None, compare=False, repr=False)
    status: ClassVar[str] = "diverged"
    failed: ClassVar[bool] = True


#: The outcome of a run whose time step is so long that the engine would make no step, which says nothing about it.
NO_STEP = Unsupported("the time step is longer than the run, in which no step ends")


Outcome = Completed | Unsupported | Diverged | Crashed | TimedOut


@dataclass(frozen=True, eq=False)
class Run:
    """A run of a case in an engine with a method, and its outcome.

    Attributes
    ----------
    case, engine, version, method
        The names of case and engine, the engine's version, and the method.
    outcome
        The outcome.
    contact_law
        The friction that the engine's contacts would produce on the scene's plane if they were rigid; None without a plane, or
        if the reference has no such law.
    scene
        The scene that was run; None if it is not known, for example if the process of the run died.
    role
        The roles of the method, "default", "recommended" or both, as the column `role` has them; empty if it has none. None if
        it is not known, as in results of earlier versions.
    sensors
        The sensors of the case.
    """

    case: str
    engine: str
    version: str
    method: Method
    outcome: Outcome
    contact_law: Plane | None = None
    scene: AnyScene | None = field(default=None, repr=False)
    role: str | None = None
    sensors: tuple[Sensor, ...] = field(default=(), repr=False)

    @property
    def is_recorded(self) -> bool:
        """True if somebody recorded the motion, so that it cannot be made again."""
        return self.method.integrator == RECORDED

    @property
    def key(self) -> RunKey:
        """The key of the run."""
        return RunKey(self.case, self.engine, self.method)
