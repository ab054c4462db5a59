"""The conventions of sensors that are mounted on a body: accelerometers, gyroscopes and velocimeters."""

from dataclasses import dataclass

import numpy as np

from bodycheck.judging.sensors.jointed import frames_of_body
from bodycheck.judging.sensors.laws import Frame, Laws, Source, differences, largest, laws
from bodycheck.judging.sensors.past import Past
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True, eq=False)
class Mounting:
    """The motion of the place of a sensor on a body, at each lag before each reading.

    Attributes
    ----------
    arm
        The place (3,) relative to the centre of mass, along the axes of the body (m).
    turn, axes
        The quaternions (lags, n, 4) to the world from the axes of the body, and from those of the sensor.
    rate, angular
        The angular velocity (rad/s) and acceleration (rad/s^2) along the axes of the body (lags, n, 3).
    position, velocity, acceleration
        Those of the place (lags, n, 3), world frame (m, m/s, m/s^2).
    """

    arm: Array
    turn: Array
    axes: Array
    rate: Array
    angular: Array
    position: Array
    velocity: Array
    acceleration: Array

    @property
    def spin(self) -> Array:
        """The centripetal acceleration (lags, n, 3) of the place, along the axes of the body."""
        return np.cross(self.rate, np.cross(self.rate, self.arm))

    def along(self, vectors: Array, present: bool = False) -> Array:
        """Return vectors (lags, n, 3) along the axes of the world along those of the sensor, at the first lags.

        present: whether the axes are those at the readings, and not at each lag.
        """
        axes = np.broadcast_to(self.axes[:1], (len(vectors), *self.axes.shape[1:])) if present else self.axes[: len(vectors)]
        return rotate(conjugate(axes), vectors)

    def of_body(self, vectors: Array) -> Array:
        """Return vectors (lags, n, 3) along the axes of the body along those of the sensor, at the first lags."""
        return self.along(rotate(self.turn[: len(vectors)], vectors))


def mounting(past: Past, sensor: Sensor) -> Mounting:
    """Return the motion of the place of a sensor."""
    states, rows, scene = past.states.body(sensor.body), past.rows, past.scene
    centre = exact.nearest_inertia(scene.bodies[sensor.body]).centre if isinstance(scene, Mechanism) else (0.0, 0.0, 0.0)
    arm = np.array(sensor.position) - np.array(centre)
    turn, rate, angular = states.quaternion[rows], states.angular_velocity[rows], past.angular[sensor.body][rows]
    mounted = np.broadcast_to(np.array(exact.nearest_turn(sensor.attitude)), turn.shape)
    acceleration = np.cross(angular, arm) + np.cross(rate, np.cross(rate, arm))
    return Mounting(
        arm,
        turn,
        multiply(turn, mounted),
        rate,
        angular,
        states.position[rows] + rotate(turn, np.broadcast_to(arm, rate.shape)),
        states.velocity[rows] + rotate(turn, np.cross(rate, arm)),
        past.linear[sensor.body][rows] + rotate(turn, acceleration),
    )


def accelerometer(past: Past, sensor: Sensor, values: Array) -> Laws:
    """Return the conventions of an accelerometer, which should read `values` (lags, n, 3)."""
    motion, h, gravity = mounting(past, sensor), past.timestep, past.scene.gravity
    weight = motion.along(np.broadcast_to(np.array([0.0, 0.0, gravity]), values.shape))
    spin, transport = motion.of_body(motion.spin), motion.of_body(np.cross(motion.angular, motion.arm))
    departures = {
        "without ω × v": -np.cross(motion.of_body(motion.rate), motion.along(motion.velocity)),
        "without ω × (ω × r)": -spin,
        "without dω/dt × r": -transport,
        "at the centre of mass": -spin - transport,
        "gravity with the other sign": -2 * weight,
        "without gravity": -weight,
    }
    sources: dict[Source, Array] = {"solver": values}
    differenced: dict[Source, float] = {}
    delayed: dict[Source, Array] = {}
    if h:
        now = values[:1] + motion.along(motion.acceleration - motion.acceleration[:1], present=True)
        delayed = {"velocities": now, "positions": now}
        by_velocities = differences(motion.velocity)[:2] / h
        by_positions = differences(differences(motion.position))[:2] / h**2
        sources["velocities"] = values[:2] + motion.along(by_velocities - motion.acceleration[:2])
        sources["positions"] = values[:2] + motion.along(by_positions - motion.acceleration[:2])
        differenced = {"velocities": largest(motion.velocity) / h, "positions": largest(motion.position) / h**2}
    size = max(gravity, largest(motion.spin))
    units = {"in units of g": 1 / gravity} if gravity else {}
    return laws(past, sources, _frames(past, sensor, motion), departures, units, size, differenced, delayed)


def gyroscope(past: Past, sensor: Sensor, values: Array) -> Laws:
    """Return the conventions of a gyroscope, which should read `values` (lags, n, 3)."""
    motion, h = mounting(past, sensor), past.timestep
    sources: dict[Source, Array] = {"solver": values}
    if h:
        sources["positions"] = motion.of_body(_turned(motion.turn)[:2] / h)
    return laws(past, sources, _frames(past, sensor, motion), differenced={"positions": 1 / h} if h else None)


def velocimeter(past: Past, sensor: Sensor, values: Array) -> Laws:
    """Return the conventions of a velocimeter, which should read `values` (lags, n, 3)."""
    motion, h = mounting(past, sensor), past.timestep
    sources: dict[Source, Array] = {"solver": values}
    delayed: dict[Source, Array] = {}
    if h:
        sources["positions"] = motion.along(differences(motion.position)[:2] / h)
        delayed["positions"] = motion.along(motion.velocity, present=True)
    departures = {"at the centre of mass": -motion.of_body(np.cross(motion.rate, motion.arm))}
    differenced: dict[Source, float] = {"positions": largest(motion.position) / h} if h else {}
    return laws(past, sources, _frames(past, sensor, motion), departures, differenced=differenced, delayed=delayed)


def _turned(turn: Array) -> Array:
    """Return the rotation vectors (lags - 1, n, 3) of steps, from the quaternions (lags, n, 4) at their ends (rad)."""
    step = multiply(conjugate(turn[1:]), turn[:-1])
    step = step * np.where(step[..., :1] < 0, -1.0, 1.0)
    sine = np.linalg.norm(step[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, step[..., :1])
    return np.asarray(step[..., 1:] * np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 0))


def _frames(past: Past, sensor: Sensor, motion: Mounting) -> dict[Frame, Array]:
    """Return the frames along whose axes a mounted sensor may read, beginning with its own."""
    frames = frames_of_body(past, sensor.body)
    if not np.abs(np.array(exact.nearest_turn(sensor.attitude))[1:]).any():  # its axes are those of the body
        del frames["body"]
    return {"sensor": motion.axes, **frames}
