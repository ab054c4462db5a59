"""The columns of results: what each is called, its unit and its meaning, for every table, schema, plot and message."""

from dataclasses import dataclass
from typing import Literal

#: As JSON Schema calls them.
Kind = Literal["string", "boolean", "integer", "number"]


@dataclass(frozen=True)
class Column:
    """A column of results.

    title: for heads of tables and axes. meaning: for readers who know nothing of bodycheck. unit: in SI, empty where there is
    none; counts: what a number without a unit counts. largest: whether it is the largest value over the sampled instants.
    """

    name: str
    kind: Kind
    title: str
    meaning: str
    unit: str = ""
    counts: str = ""
    largest: bool = False

    @property
    def told(self) -> str:
        """What it is, as a phrase."""
        return f"largest {self.meaning}" if self.largest else self.meaning


def _text(name: str, title: str, meaning: str) -> Column:
    return Column(name, "string", title, meaning)


def _figure(name: str, title: str, meaning: str, unit: str = "", counts: str = "") -> Column:
    return Column(name, "number", title, meaning, unit, counts)


def _largest(name: str, title: str, meaning: str, unit: str = "") -> Column:
    return Column(name, "number", title, meaning, unit, largest=True)


#: By name, in the order of tables. A number that has no unit and counts nothing is relative.
COLUMNS = {
    column.name: column
    for column in (
        _text("set", "Set", "label of the results that the run is from, where several are in one table"),
        _text("case", "Case", "name of the case"),
        _text("engine", "Engine", "name of the engine"),
        _text("version", "Version", "version of the engine"),
        _text("integrator", "Integrator", "name of the integrator, its options behind a colon"),
        _figure("timestep", "Time step", "time step", "s"),
        _text("status", "Status", "how the run ended"),
        Column("passed", "boolean", "Passed", "whether what the case expects of the run holds; empty where it expects nothing"),
        _text("reason", "Reason", "why the run is not ok, or which expectation does not hold"),
        _largest("position_error", "Position error", "distance of the centre of mass from where mechanics has it", "m"),
        _largest("velocity_error", "Velocity error", "difference of the velocity from that of mechanics", "m/s"),
        _largest("attitude_error", "Attitude error", "angle between the body's attitude and that of mechanics", "rad"),
        _largest(
            "angular_velocity_error",
            "Angular velocity error",
            "difference of the angular velocity, along the body's axes, from that of mechanics",
            "rad/s",
        ),
        _largest("energy_drift", "Energy drift", "change of the energy, which mechanics keeps, relative to its size"),
        _largest(
            "rotational_energy_drift",
            "Rotational energy drift",
            "change of the energy of rotation, which mechanics keeps, relative to its size",
        ),
        _largest(
            "angular_momentum_drift",
            "Angular momentum drift",
            "change of the angular momentum about the centre of mass, a vector, which mechanics keeps, relative to its size",
        ),
        _largest(
            "truth_error",
            "Truth error",
            "error that the truth's own attitude may have, below which an attitude error says nothing",
            "rad",
        ),
        Column("steps", "integer", "Steps", "steps taken", counts="steps"),
        _figure("wall_time", "Wall time", "time that the steps took", "s"),
        _figure("time_per_step", "Time per step", "time that a step took", "s"),
        _figure(
            "realtime_factor", "Real-time factor", "time in the scene over the time that it took", counts="times real time"
        ),
        _largest(
            "energy_error",
            "Energy error",
            "difference of the energy from that of mechanics, relative to its size",
        ),
        _largest(
            "rotational_energy_error",
            "Rotational energy error",
            "difference of the energy of rotation from that of mechanics, relative to its size",
        ),
        _largest(
            "angular_momentum_error",
            "Angular momentum error",
            "difference of the angular momentum, a vector, from that of mechanics, relative to its size",
        ),
        _figure(
            "stop_time_error",
            "Stop time error",
            "how far the time at which the body comes to rest is from that of mechanics",
            "s",
        ),
        _figure(
            "stop_position_error",
            "Stop position error",
            "how far the place at which the body comes to rest is from that of mechanics",
            "m",
        ),
        _figure(
            "stop_yaw_error",
            "Stop yaw error",
            "how far the angle at which the body comes to rest is from that of mechanics",
            "rad",
        ),
        _figure("creep", "Creep", "mean speed after the stop, where mechanics has the body at rest", "m/s"),
        _largest("penetration", "Penetration", "depth to which the body goes into the plane", "m"),
        _largest("tilt", "Tilt", "angle by which the body tilts off the plane", "rad"),
        _figure("mean_load", "Mean load", "what the plane bears on the average until the stop", counts="weights"),
        _figure("peak_load", "Peak load", "the most that the plane bears in a step until the stop", counts="weights"),
        _figure(
            "time_in_contact",
            "In contact",
            "part of the steps until the stop in which the plane bears anything",
            counts="of the steps",
        ),
    )
}

#: What may be expected of a run besides the columns.
ORDER = _figure(
    "order",
    "Order",
    "power of the time step with which the attitude error falls, seen at this step, its half and its quarter",
)

#: What may be expected of a run, and more.
EXPECTED = COLUMNS | {ORDER.name: ORDER}

#: Of the columns that have one.
UNITS = {column.name: column.unit for column in COLUMNS.values() if column.unit}
