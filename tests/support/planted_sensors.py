"""A miniature engine with sensors of a free body and of a body on a hinge, with planted faults.

Its mechanics is written out with rotation matrices, and shares no code with the reference.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from bodycheck.adapters.contract import Engine, Integrator, Method, SensingSimulation, single
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Tensor
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: The axis of the hinge, its armature (kg m^2) and damping (N m s/rad), and the centre of mass of its body (m).
AXIS, ARMATURE, DAMPING, CENTRE = np.array([0.6, 0.0, 0.8]), 0.05, 0.1, np.array([0.1, 0.2, -0.3])

#: The mass (kg) and the moments of inertia (kg m^2) of both bodies.
MASS, MOMENTS = 1.2, np.diag([0.0134, 0.0105, 0.0043])

#: The attitude of the frame of the hinge, as a quaternion w, x, y, z, and as a matrix.
TURNED = (0.8, 0.2, -0.4, 0.4)
ATTITUDE = Rotation.from_quat([0.2, -0.4, 0.4, 0.8]).as_matrix()

#: The sensors of the free body, and the one of the hinge.
ON_BODY = (
    Sensor("imu", "accelerometer", position=(0.1, 0.05, 0.02), attitude=(0.5, 0.5, -0.5, 0.5)),
    Sensor("gyro", "gyroscope"),
    Sensor("speed", "velocimeter", position=(0.1, 0.05, 0.02)),
)
ON_HINGE = (Sensor("wrench", "force_torque", 0, 0),)

#: What the engine does beside mechanics.
Fault = Literal[
    "none",
    "without ω × v",
    "gravity with the other sign",
    "in units of g",
    "old",
    "differences of velocities",
    "differences of positions",
    "along the axes of the world",
    "about the centre of mass",
    "with the armature",
    "of the child on the parent",
    "zero",
]


def hinge() -> Mechanism:
    """Return the body on the hinge."""
    body = JointedBody("bob", Tensor(MASS, tuple(map(tuple, MOMENTS.tolist()))), tuple(CENTRE))  # type: ignore[arg-type]
    joint = Joint(
        *("pin", "revolute", WORLD, 0, (0.0, 0.0, 1.0), TURNED),
        axis=tuple(AXIS),
        armature=ARMATURE,
        damping=DAMPING,
        start=(0.7,),
        start_velocity=(2.0,),
    )
    return Mechanism((body,), (joint,), gravity=9.81)


@dataclass(frozen=True, eq=False)
class Motion:
    """The state of a body: position of the centre of mass, rotation, velocity, and angular velocity along its axes."""

    position: Array
    turn: Array
    velocity: Array
    rate: Array

    @property
    def row(self) -> Array:
        """The state (13,) as engines return it."""
        x, y, z, w = Rotation.from_matrix(self.turn).as_quat()
        return np.array([*self.position, w, x, y, z, *self.velocity, *self.rate])

    def at(self, arm: Array) -> tuple[Array, Array]:
        """The position and the velocity of a point of the body, relative to the centre of mass along its axes."""
        return self.position + self.turn @ arm, self.velocity + self.turn @ np.cross(self.rate, arm)


def runge_kutta(rates: Callable[[Array], Array], y: Array, h: float) -> Array:
    """The values after a step of the classical scheme of the fourth order."""
    first = rates(y)
    second = rates(y + h / 2 * first)
    third = rates(y + h / 2 * second)
    return np.asarray(y + h / 6 * (first + 2 * second + 2 * third + rates(y + h * third)))


class Flight:
    """The free body: its values are the position, the rotation matrix, the velocity and the angular velocity."""

    def __init__(self, gravity: float, start: Motion) -> None:
        self.down = np.array([0.0, 0.0, -gravity])
        self.values = np.concatenate([start.position, start.turn.ravel(), start.velocity, start.rate])

    def turning(self, rate: Array) -> Array:
        """The angular acceleration along the axes of the body."""
        return np.asarray(np.linalg.solve(MOMENTS, -np.cross(rate, MOMENTS @ rate)))

    def rates(self, y: Array) -> Array:
        turn, rate = y[3:12].reshape(3, 3), y[15:]
        skew = np.cross(np.eye(3), rate)
        return np.concatenate([y[12:15], (turn @ skew).ravel(), self.down, self.turning(rate)])

    def step(self, h: float) -> None:
        self.values = runge_kutta(self.rates, self.values, h)
        left, _, right = np.linalg.svd(self.values[3:12].reshape(3, 3))
        self.values[3:12] = (left @ right).ravel()

    @property
    def motion(self) -> Motion:
        return Motion(self.values[:3], self.values[3:12].reshape(3, 3), self.values[12:15], self.values[15:])


class Swing:
    """The body on the hinge: its values are the angle and its rate."""

    def __init__(self, scene: Mechanism) -> None:
        joint = scene.joints[0]
        self.down, self.origin = np.array([0.0, 0.0, -scene.gravity]), np.array(joint.position)
        self.values = np.array([*joint.start, *joint.start_velocity])

    def turn(self, angle: float) -> Array:
        return np.asarray(ATTITUDE @ Rotation.from_rotvec(angle * AXIS).as_matrix())

    def acceleration(self, angle: float, rate: float) -> float:
        arm = np.cross(AXIS, CENTRE)
        inertia = AXIS @ MOMENTS @ AXIS + MASS * arm @ arm + ARMATURE
        weight = MASS * self.turn(angle).T @ self.down
        return float((AXIS @ np.cross(CENTRE, weight) - DAMPING * rate) / inertia)

    def rates(self, y: Array) -> Array:
        return np.array([y[1], self.acceleration(*y)])

    def step(self, h: float) -> None:
        self.values = runge_kutta(self.rates, self.values, h)

    @property
    def motion(self) -> Motion:
        angle, rate = self.values
        turn = self.turn(angle)
        return Motion(self.origin + turn @ CENTRE, turn, turn @ np.cross(rate * AXIS, CENTRE), rate * AXIS)


@dataclass
class Sensors:
    """A simulation with sensors, which remembers what differences and late readings need."""

    moving: Flight | Swing
    sensors: Sequence[Sensor]
    fault: Fault
    timestep: float

    def __post_init__(self) -> None:
        self.past = [self.moving.motion]
        self.late: tuple[Array, ...] = tuple(np.zeros(len(sensor.columns)) for sensor in self.sensors)

    def advance(self, strides: Sequence[int]) -> Array:
        rows = []
        for stride in strides:
            for _ in range(int(stride)):
                self.late = self.present()
                self.moving.step(self.timestep)
                self.past = [*self.past[-2:], self.moving.motion]
            rows.append(self.past[-1].row[None])
        return single(np.array(rows))

    def read(self) -> tuple[Array, ...]:
        """Return the readings, those of the last state if they are late."""
        return self.late if self.fault == "old" else self.present()

    def present(self) -> tuple[Array, ...]:
        return tuple(self.reading(sensor) for sensor in self.sensors)

    def reading(self, sensor: Sensor) -> Array:
        """Return the reading of a sensor at the present state, with the fault."""
        now = self.past[-1]
        if isinstance(self.moving, Swing):
            return self.wrench(self.moving, now)
        own = Rotation.from_quat(np.array([*sensor.attitude[1:], sensor.attitude[0]])).as_matrix()
        axes = np.eye(3) if self.fault == "along the axes of the world" else now.turn @ own
        vectors = {
            "gyroscope": now.turn @ now.rate,
            "velocimeter": now.at(np.array(sensor.position))[1],
            "accelerometer": self.specific_force(self.moving, now, np.array(sensor.position)),
        }
        return np.zeros(3) if self.fault == "zero" else np.asarray(axes.T @ vectors[sensor.type])

    def specific_force(self, flight: Flight, now: Motion, arm: Array) -> Array:
        """Return the specific force at a point of the free body, along the axes of the world."""
        turning = np.cross(flight.turning(now.rate), arm) + np.cross(now.rate, np.cross(now.rate, arm))
        acceleration, h = flight.down + now.turn @ turning, self.timestep
        places, velocities = zip(*(motion.at(arm) for motion in self.past), strict=True)
        match self.fault:
            case "without ω × v":
                acceleration -= np.cross(now.turn @ now.rate, velocities[-1])
            case "differences of velocities" if len(velocities) > 1:
                acceleration = (velocities[-1] - velocities[-2]) / h
            case "differences of positions" if len(places) > 2:
                acceleration = (places[-1] - 2 * places[-2] + places[-3]) / h**2
            case "gravity with the other sign":
                return np.asarray(acceleration + flight.down)
            case "in units of g":
                return np.asarray((acceleration - flight.down) / np.linalg.norm(flight.down))
        return np.asarray(acceleration - flight.down)

    def wrench(self, swing: Swing, now: Motion) -> Array:
        """Return the wrench of the hinge on the body, about and along the frame of the body."""
        turning, rate = swing.acceleration(*swing.values) * AXIS, now.rate
        acceleration = np.cross(turning, CENTRE) + np.cross(rate, np.cross(rate, CENTRE))
        force = MASS * (acceleration - now.turn.T @ swing.down)
        moment = MOMENTS @ turning + np.cross(rate, MOMENTS @ rate)
        match self.fault:
            case "with the armature":
                moment = moment + ARMATURE * turning
            case "of the child on the parent":
                force, moment = -force, -(moment + np.cross(CENTRE, force))
                return np.concatenate([force, moment])
            case "along the axes of the world":
                return np.concatenate([now.turn @ force, now.turn @ (moment + np.cross(CENTRE, force))])
            case "about the centre of mass":
                return np.concatenate([force, moment])
            case "zero":
                return np.zeros(6)
        return np.concatenate([force, moment + np.cross(CENTRE, force)])


@dataclass(frozen=True)
class PlantedSensors:
    """The adapter of the miniature engine."""

    fault: Fault = "none"

    @property
    def engine(self) -> Engine:
        models = frozenset({"gravity", "translation", "rotation", "mechanisms", "revolute joints", "armature", "joint damping"})
        return Engine("planted", "bodycheck-miniature", "1.0", (Integrator("rk4"),), models, reads=("step",))

    def prepare(self, scenes: Sequence[AnyScene], method: Method) -> Sensors:
        (scene,) = scenes
        return self.simulation(scene, (), method)

    def lacking(self, scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
        return "has no sensor of contact forces" if sensor.type == "contact_force" else None

    def prepare_sensing(self, scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
        simulation = self.simulation(scene, sensors, method)
        return SensingSimulation(simulation, simulation.read)

    def simulation(self, scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> Sensors:
        if isinstance(scene, Mechanism):
            return Sensors(Swing(scene), sensors, self.fault, method.timestep)
        start = scene.initial
        turn = Rotation.from_quat([*start.quaternion[1:], start.quaternion[0]]).as_matrix()
        motion = Motion(np.array(start.position), turn, np.array(start.velocity), np.array(start.angular_velocity))
        return Sensors(Flight(scene.gravity, motion), sensors, self.fault, method.timestep)
