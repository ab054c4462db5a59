"""The types of sensors, and a sensor as data.

Readings are along the axes that the type names. With the rotation R from the sensor's axes to the world, the acceleration a of
its place in the world, the gravitational acceleration g as a vector, and the velocity v and angular velocity w of the body:

- An accelerometer reads the specific force R^T (a - g): at rest 9.81 m/s^2 upwards, in free flight zero at the centre of mass.
- A gyroscope reads R^T w, and a velocimeter R^T v at its place.
- A force_torque sensor reads the force and the moment that the parent exerts on the child through the joint (or through all
  joints between them), about the origin of the child's frame and along the child's axes. Its component along the axis of the
  joint is effort + spring - damping - dry friction - armature times acceleration, with stops: what turns the child and all
  bodies beyond it, and not what turns the rotor.
- A joint_effort sensor reads the effort of the joint's controller after saturation and delay, plus the effort of the joint;
  not the spring, damping, dry friction or stops.
- A contact_force sensor reads the resultant of the forces of contacts on the body, along the axes of the world.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bodycheck.reference.scene import Attitude, Vector
from bodycheck.reference.trajectory import Array

#: The names of the types.
SensorType = Literal["accelerometer", "gyroscope", "velocimeter", "force_torque", "joint_effort", "contact_force"]

#: The components of a vector, of a force and a moment, and of a single number, as suffixes of columns.
VECTOR, WRENCH, NUMBER = (".x", ".y", ".z"), (".fx", ".fy", ".fz", ".tx", ".ty", ".tz"), ("",)


@dataclass(frozen=True)
class SensorForm:
    """A type of sensor.

    Attributes
    ----------
    name
        The name of the type.
    meaning
        What it reads, in a sentence.
    components
        The suffixes of the columns of its components.
    units
        The unit of each component; of a joint_effort sensor, N m if the joint is revolute and N if it is prismatic.
    mounted
        Whether it has a place and axes of its own on a body.
    of_joint
        Whether it belongs to a joint instead of a body.
    """

    name: SensorType
    meaning: str
    components: tuple[str, ...]
    units: tuple[str, ...]
    mounted: bool = False
    of_joint: bool = False


#: All types of sensors, by their names.
SENSOR_TYPES: dict[SensorType, SensorForm] = {
    form.name: form
    for form in (
        SensorForm("accelerometer", "The specific force at its place, along its axes.", VECTOR, ("m/s^2",) * 3, mounted=True),
        SensorForm("gyroscope", "The angular velocity of the body, along its axes.", VECTOR, ("rad/s",) * 3, mounted=True),
        SensorForm("velocimeter", "The velocity of its place, along its axes.", VECTOR, ("m/s",) * 3, mounted=True),
        SensorForm(
            "force_torque",
            "The force and moment of the parent on the child, about and along the child's frame.",
            WRENCH,
            ("N",) * 3 + ("N m",) * 3,
            of_joint=True,
        ),
        SensorForm("joint_effort", "The effort of the controller and the joint itself.", NUMBER, ("N m or N",), of_joint=True),
        SensorForm("contact_force", "The resultant of contacts on the body, along the axes of the world.", VECTOR, ("N",) * 3),
    )
}


@dataclass(frozen=True)
class Sensor:
    """A sensor of a case.

    Attributes
    ----------
    name, type
        Its name, unique in the case, and its type.
    body
        The index of the body; 0 if the scene is a single body. Of a sensor of a joint, the index of the child.
    joint
        The index of the joint in `Mechanism.joints`; None for the types that belong to a body.
    position
        Its place in the body's frame (m). The origin of that frame is the centre of mass if the scene is a single body.
    attitude
        The rotation from its axes to those of the body's frame.
    """

    name: str
    type: SensorType
    body: int = 0
    joint: int | None = None
    position: Vector = (0.0, 0.0, 0.0)
    attitude: Attitude = (1.0, 0.0, 0.0, 0.0)

    @property
    def form(self) -> SensorForm:
        """The entry of the sensor's type in `SENSOR_TYPES`."""
        return SENSOR_TYPES[self.type]

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns of its components, such as "imu.x"."""
        return tuple(f"{self.name}{suffix}" for suffix in self.form.components)


def split(sensors: Sequence[Sensor], values: Array) -> tuple[Array, ...]:
    """Return the reading (k,) of each of some sensors from the values of all their components, one sensor after another."""
    return tuple(np.split(values, np.cumsum([len(sensor.form.components) for sensor in sensors])[:-1]))
