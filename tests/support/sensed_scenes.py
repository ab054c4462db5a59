"""Scenes with sensors whose readings are known, and readings of an engine beside those that its own states demand."""

import math

import numpy as np

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Method, Sensing
from bodycheck.adapters.scheduling import exert
from bodycheck.casefile.case import Case, load
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Joint, Mechanism
from bodycheck.reference.sensors.expected import expected
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.running.states import of_scene, trajectory_of
from tests.support.jointed import body

#: The reading (m/s^2) of the accelerometer of the shipped brick at the start.
BRICK_AT_START = (-2.5159379844961242, 0.7909406456091635, 0.0323383084577115)

#: The mass (kg) and the length (m) of the pendulum, and gravity (m/s^2).
MASS, LENGTH, GRAVITY = 1.3, 0.7, 9.81

#: The effort (N m) that holds the arm of the shipped scene at rest, against 2 kg at 0.25 m.
HOLDING = -2 * GRAVITY * 0.25

#: The shipped scenes with sensors in which no controller drives a joint and nothing touches, but for the arm at rest.
UNDRIVEN = (
    "brick",
    "constant-velocity",
    "free-fall",
    "centrifuge",
    "pendulum",
    "fixed-tool",
    "floating-arm",
    "three-link-wrench",
)

#: A sensor of the wrench in the pin of the pendulum.
WRENCH = Sensor("wrench", "force_torque", 0, 0)


def shipped(name: str) -> Case:
    """A shipped case with sensors."""
    return load(f"sensor-{name}")


def swung() -> Mechanism:
    """A point mass on a rod at the lowest point of its way, with the speed of a swing from the horizontal.

    The tension is m g + m v^2 / L = 3 m g.
    """
    bob = body("bob", MASS, (0.0, 0.0, 0.0), (0.0, 0.0, -LENGTH))
    rate = math.sqrt(2 * GRAVITY / LENGTH)
    pin = Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.0,), start_velocity=(rate,))
    return Mechanism((bob,), (pin,), gravity=GRAVITY)


def after(
    adapter: Sensing, scene: AnyScene, sensors: tuple[Sensor, ...], spelling: str, steps: int, timestep: float = 0.001
) -> tuple[tuple[Array, ...], Trajectory]:
    """The readings of sensors after some steps of an engine, and its states then."""
    method = Method.parse(spelling, timestep)
    assert not [reason for sensor in sensors if (reason := adapter.lacking(scene, sensor, method))]
    sensing = offers.prepare_sensing(adapter, scene, sensors, method)
    states = sensing.simulation.advance(np.array([steps]))
    exert(sensing.simulation)
    return sensing.read(), trajectory_of(np.array([steps * timestep]), of_scene(states, scene))


def differences(adapter: Sensing, scene: AnyScene, sensors: tuple[Sensor, ...], spelling: str, steps: int) -> dict[str, float]:
    """The largest differences of readings after some steps from what the sensors should read at the states of the engine."""
    readings, states = after(adapter, scene, sensors, spelling, steps)
    wanted = expected(scene, sensors, states)
    return {
        sensor.name: float(np.abs(reading - exactly[0]).max())
        for sensor, reading, exactly in zip(sensors, readings, wanted, strict=True)
    }
