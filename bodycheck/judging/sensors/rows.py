"""The rows of sensors.csv: what each sensor of a case reads in an engine with a method."""

from dataclasses import dataclass
from typing import Annotated

from bodycheck.judging.sensors.laws import FRAMES, SOURCES
from bodycheck.reference.sensors.sensor import SENSOR_TYPES
from bodycheck.results.tables import RUN, Meaning, table_of


@dataclass(frozen=True)
class SensorRow:
    """The error of a sensor in a run, and the convention that explains its readings. A wrench has two rows."""

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    sensor: Annotated[
        str, Meaning("Sensor", "name of the sensor; the force and the moment of a wrench have the suffixes .force and .moment")
    ]
    type: Annotated[str, Meaning("Type", "type of the sensor", words=frozenset(SENSOR_TYPES))]
    error: Annotated[
        float | None,
        Meaning(
            "Error",
            "largest distance of a reading from the truth, in the unit of the sensor, without the reading after a reset; empty "
            "if the engine does not read the sensor, or the reference has no model of it",
        ),
    ]
    relative_error: Annotated[
        float | None,
        Meaning(
            "Relative error",
            "error divided by the largest true reading; of an accelerometer, by the largest of that, the gravitational "
            "acceleration and the square of the angular velocity times the distance from the centre of mass; empty if it is 0",
        ),
    ]
    sign: Annotated[
        str,
        Meaning(
            "Sign",
            "+ or -; with exchanged axes, the signed axis that each component shows, as in +y -x +z, and ? for a component "
            "that cannot be told; empty if none can",
        ),
    ]
    frame: Annotated[
        str,
        Meaning("Frame", "frame along whose axes the readings are; empty if it cannot be told", words=FRAMES),
    ]
    age_steps: Annotated[
        float | None,
        Meaning("Age", "delay of the readings in steps, by a fit; empty if it cannot be told", "steps", signed=True),
    ]
    source: Annotated[
        str,
        Meaning(
            "Source",
            "solver for the state itself and the accelerations that the equations of motion give there, velocities for a "
            "difference of velocities over a step, positions for a difference of positions; empty if it cannot be told",
            words=SOURCES,
        ),
    ]
    note: Annotated[
        str,
        Meaning(
            "Note", "terms that the readings have in excess or lack, what the scene does not tell, and why fields are empty"
        ),
    ]
    age_uncertainty: Annotated[float | None, Meaning("Uncertainty of the age", "uncertainty of the age", "steps")]
    reset_error: Annotated[
        float | None,
        Meaning(
            "Error after a reset",
            "distance from the truth at the start of the reading after a reset, in the unit of the sensor; empty if the engine "
            "has no reading then",
        ),
    ]


SENSORS = table_of(
    SensorRow,
    "sensors",
    "readings of sensors",
    key=(*RUN, "sensor"),
    filled=("case", "engine", "version", "integrator", "timestep", "sensor", "type"),
)
