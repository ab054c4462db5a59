"""Readings of sensors as data: those of the truth, and those of an engine."""

from dataclasses import dataclass

from bodycheck.reference.trajectory import Array, Trajectory


@dataclass(frozen=True, eq=False)
class SensorTruth:
    """The true readings of one sensor at n instants.

    Attributes
    ----------
    values, bounds
        The readings (n, k) and bounds of their errors (n, k), with the components of `Sensor.form`; NaN at instants that are
        left out. Both are empty (0, k) if the reference has no model of the sensor.
    left_out
        The number of instants that are left out, because an impact happens there.
    reason
        Why the reference has no model of the sensor in this scene; empty if it has one.
    """

    values: Array
    bounds: Array
    left_out: int = 0
    reason: str = ""


@dataclass(frozen=True, eq=False)
class Sensed:
    """The readings of the sensors of a case in an engine.

    Attributes
    ----------
    lacking
        For each sensor the reason for which the engine does not read it; empty if it does. The readings are then NaN.
    readings
        For each sensor the readings (n, k) at the n instants of the run's trajectory, the first after the engine was reset.
    window
        The states after each of the first w steps of the run, the start first: w + 1 instants.
    stepwise
        For each sensor the readings (w + 1, k) at the instants of the window.
    """

    lacking: tuple[str, ...]
    readings: tuple[Array, ...]
    window: Trajectory
    stepwise: tuple[Array, ...]
