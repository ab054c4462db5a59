"""The bodies and launches of the probes, each with one obvious answer."""

from bodycheck.reference.scene import Body, Scene, State, Vector

#: A body of which every axis is principal and which therefore keeps its spin.
SPHERE = Body(2.0, (0.1, 0.1, 0.1))

#: A body with an axis of symmetry: its spin goes round the axis K steadily, and its rotational energy is constant.
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

    Velocity and spin are parallel, so that also a scheme in velocities along the body's axes has nothing to turn.
    """
    return Scene(SPHERE, State(velocity=along(speed), angular_velocity=along(spin)))
