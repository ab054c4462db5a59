"""Read Newton's sensors and the observables of its solvers, in a simulation of their own.

Newton has no pass that computes sensors of a state: its solvers fill observables while they step. `SensorIMU` computes the
specific force at a site from the observable `body_qdd` and from the attitude and the angular velocity of the present state. The
MuJoCo solvers compute `body_qdd` at the start of the step (`MuJoCo-rk4` at its last stage), and Kamino as the change of the
velocity in the step. Other solvers have no `body_qdd`: no accelerometer, and the angular velocity is that of the state, in the
world frame. The velocity of a point is that of Newton's function `velocity_at_point`, in the world frame.

The wrench of a joint is the observable `body_parent_f`: along the axes of the world, about the body's centre of mass. The force
of contacts on a body is that of `SensorContact`. The observable `qfrc_actuator` of the MuJoCo solvers does not contain the
efforts of `Control.joint_f`, which the adapter drives joints by.
"""

from collections.abc import Sequence
from typing import Any

import newton
import numpy as np
import warp as wp

from bodycheck.adapters.contract import Method
from bodycheck.adapters.newton.solvers import SOLVERS
from bodycheck.reference.mechanisms.exact import nearest_turn
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Quaternion, Vector
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

KIND = newton.solvers.SolverBase.ObservableKind

#: The types of sensors that need an observable of a solver, with the observable and the words for it.
NEEDS = {
    "accelerometer": (KIND.BODY_QDD, "accelerations of bodies"),
    "force_torque": (KIND.BODY_PARENT_F, "wrenches of joints"),
    "contact_force": (KIND.CONTACT_F, "forces of contacts"),
}


def lacking(scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
    """Return why Newton does not read a sensor, as `Sensing.lacking` does."""
    if sensor.type == "joint_effort":
        return "has no sensor of the efforts of its control"
    if sensor.type in NEEDS:
        kind, words = NEEDS[sensor.type]
        if kind not in SOLVERS[method.integrator].observables:
            return f"has no observable of {words} of the solver {method.integrator}"
    if sensor.type == "contact_force" and scene.plane is None:
        return "has no contacts in this scene"
    return None


def add_sites(builder: Any, sensors: Sequence[Sensor], bodies: Sequence[int]) -> None:
    """Add to a builder a site with the pose of each sensor on the body of its number."""
    for number, (sensor, body) in enumerate(zip(sensors, bodies, strict=True)):
        builder.add_site(body, xform=transform(sensor.position, nearest_turn(sensor.attitude)), label=site(number))


def site(number: int) -> str:
    """Return the label of the site of a sensor."""
    return f"sensor {number}"


def velocity_of_point(
    body: int,
    point: wp.vec3,
    centres: wp.array[wp.vec3],
    poses: wp.array[wp.transform],
    twists: wp.array[wp.spatial_vector],
    velocity: wp.array[wp.vec3],
) -> None:
    """Set the velocity (world) of a place in the frame of a body by Newton's function. Warp compiles this as a kernel."""
    arm = wp.quat_rotate(wp.transform_get_rotation(poses[body]), point - centres[body])
    velocity[0] = newton.math.velocity_at_point(twists[body], arm)


velocity_kernel = wp.kernel(velocity_of_point)


class Instruments:
    """The sensors of a model, and the observables of its solver that they need.

    Parameters
    ----------
    model
        Newton's model, with the sites of `add_sites`.
    sensors, bodies
        The sensors and the numbers of their bodies.
    """

    def __init__(self, model: Any, sensors: Sequence[Sensor], bodies: Sequence[int]) -> None:
        self.model, self.sensors, self.bodies = model, sensors, bodies
        self.observed: dict[str, Any] = {}
        self.imu: Any = None
        self.touch: Any = None

    def attach(self, solver: Any, contacts: Any) -> Any:
        """Ask a solver for its observables, and return the contacts that its steps fill, which may be given."""
        types = {sensor.type for sensor in self.sensors}
        kinds = {NEEDS[each][0] for each in types if each in NEEDS}
        if "gyroscope" in types:
            kinds |= {KIND.BODY_QDD} & solver.supported_observables
        if KIND.CONTACT_F in kinds and contacts is None:
            count = solver.get_max_contact_count()
            contacts = newton.CollisionPipeline(self.model, rigid_contact_max=count, soft_contact_max=0).contacts()
        self.observed = {"observables": solver.observables(kinds=kinds, contacts=contacts)}
        if KIND.BODY_QDD in kinds:
            sites = [self.model.shape_label.index(site(number)) for number in range(len(self.sensors))]
            self.imu = newton.sensors.SensorIMU(self.model, sites=sites, request_state_attributes=False)
        if KIND.CONTACT_F in kinds:
            touched = sorted({body for sensor, body in self._each() if sensor.type == "contact_force"})
            self.touch = newton.sensors.SensorContact(self.model, sensing_bodies=touched, request_contact_attributes=False)
            self.contacts = contacts
        return contacts

    def read(self, state: Any) -> tuple[Array, ...]:
        """Return the readings of all sensors after a step, at the start of what Newton has for it."""
        if self.imu is not None:
            self.imu.update(state, **self.observed)
        if self.touch is not None:
            self.touch.update(state, self.contacts, **self.observed)
        return tuple(
            np.array(self._reading(number, body, state), dtype=np.float64) for number, (_, body) in enumerate(self._each())
        )

    def _each(self) -> list[tuple[Sensor, int]]:
        return list(zip(self.sensors, self.bodies, strict=True))

    def _reading(self, number: int, body: int, state: Any) -> Any:
        sensor = self.sensors[number]
        match sensor.type:
            case "accelerometer":
                return self.imu.accelerometer.numpy()[number]
            case "gyroscope":
                return self.imu.gyroscope.numpy()[number] if self.imu is not None else state.body_qd.numpy()[body, 3:]
            case "velocimeter":
                velocity = wp.zeros(1, dtype=wp.vec3)
                moving = (self.model.body_com, state.body_q, state.body_qd)
                wp.launch(velocity_kernel, dim=1, inputs=[body, wp.vec3(*sensor.position), *moving], outputs=[velocity])
                return velocity.numpy()[0]
            case "force_torque":
                return self.observed["observables"].body_parent_f.numpy()[body]
            case _:
                return self.touch.total_force.numpy()[self.touch.sensing_indices.index(body)]


def transform(position: Vector, quaternion: Quaternion | Array) -> Any:
    """Return Warp's transform of a position (m) and a quaternion (w, x, y, z)."""
    w, x, y, z = quaternion
    return wp.transform(position, wp.quat(x, y, z, w))
