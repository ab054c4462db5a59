"""The bodies and launches of the probes, whose motions are obvious."""

from bodycheck.reference.scene import Body, Scene, State, Vector

#: A body with equal moments of inertia. Every axis is a principal axis, so that its spin is constant.
SPHERE = Body(2.0, (0.1, 0.1, 0.1))

#: A body with an axis of symmetry K. Its spin precesses about K at a constant rate, and its rotational energy is constant.
TOP = Body(2.0, (0.2, 0.2, 0.3))

#: A body with three different moments.
TRIAXIAL = Body(2.0, (0.15, 0.3, 0.2))

#: The direction of launches, a unit vector with different components.
DIRECTION: Vector = (2 / 7, 3 / 7, 6 / 7)


def along(size: float) -> Vector:
    """Return a vector of the given size in `DIRECTION`."""
    return (size * DIRECTION[0], size * DIRECTION[1], size * DIRECTION[2])


def coast(speed: float, spin: float) -> Scene:
    """Return the sphere in uniform straight motion, with a speed (m/s) and a spin (rad/s) about the direction of flight.

    Velocity and spin are parallel. Therefore the velocity is also constant along the axes of the body, and a scheme with
    velocities in the body frame does not need to rotate it.
    """
    return Scene(SPHERE, State(velocity=along(speed), angular_velocity=along(spin)))
