"""Figures of the motion: the distances of position, velocity, attitude and angular velocity from the truth.

For a mechanism, a figure is the largest value over its bodies.
"""

import math

from bodycheck.figures.definition import Comparison, Figure
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import distance


def position_error(compared: Comparison) -> Array:
    """Return the distance (n,), m, of the centre of mass in the run from the centre of mass in the truth."""
    return compared.of_bodies(distance(compared.trajectory.position, compared.truth.trajectory.position))


def velocity_error(compared: Comparison) -> Array:
    """Return the Euclidean distance (n,), m/s, between the velocities of run and truth in the world frame."""
    return compared.of_bodies(distance(compared.trajectory.velocity, compared.truth.trajectory.velocity))


def attitude_error(compared: Comparison) -> Array:
    """Return the angle (n,), rad, of the single rotation between the attitudes of run and truth."""
    turned = geodesic_angle(compared.truth.trajectory.quaternion, normalise(compared.trajectory.quaternion))
    return compared.of_bodies(turned)


def angular_velocity_error(compared: Comparison) -> Array:
    """Return the Euclidean distance (n,), rad/s, between the angular velocities of run and truth in the body frame."""
    return compared.of_bodies(distance(compared.trajectory.angular_velocity, compared.truth.trajectory.angular_velocity))


ERRORS = (
    Figure(
        name="position_error",
        title="Position error",
        meaning="distance of the centre of mass from its exact position",
        unit="m",
        largest=True,
        compute=position_error,
        scale=lambda scales: scales.length,
        presence="every run",
        bounded_by="truth_position_error",
        plotted=True,
    ),
    Figure(
        name="velocity_error",
        title="Velocity error",
        meaning="difference between the velocity and the exact velocity",
        unit="m/s",
        largest=True,
        compute=velocity_error,
        jumps=True,
        scale=lambda scales: scales.speed,
        presence="every run",
        bounded_by="truth_velocity_error",
    ),
    Figure(
        name="attitude_error",
        title="Attitude error",
        meaning="angle between the body's attitude and the exact attitude",
        unit="rad",
        largest=True,
        compute=attitude_error,
        scale=lambda scales: scales.angle,
        presence="every run",
        most=lambda _: math.pi,
        bounded_by="truth_error",
        plotted=True,
    ),
    Figure(
        name="angular_velocity_error",
        title="Angular velocity error",
        meaning="difference between the angular velocity, along the body's axes, and the exact one",
        unit="rad/s",
        largest=True,
        compute=angular_velocity_error,
        jumps=True,
        scale=lambda scales: scales.rate,
        presence="every run",
        bounded_by="truth_angular_velocity_error",
        tabled=False,
    ),
)

#: The error is measured before the adapter of an engine normalises its quaternions, which must be normalised to describe an
#: attitude.
NORM = Figure(
    name="quaternion_norm_error",
    title="Quaternion norm error",
    meaning="largest deviation from 1 of the norm of a quaternion, as the engine returned it",
    counts="of the norm",
    compute=lambda compared: compared.quaternion_norm_error,
    tabled=False,
)
