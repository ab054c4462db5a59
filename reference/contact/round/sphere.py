"""A sphere on a plane, alone: flights, impacts, slips and rolling, in closed form from phase to phase."""

from bodycheck.reference.contact.motion import ContactMotion
from bodycheck.reference.contact.problem import Problem
from bodycheck.reference.contact.round.ball import ball
from bodycheck.reference.contact.round.motion import begin, moved
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Ellipsoid, Shape, Sphere
from bodycheck.reference.trajectory import Array

#: Why the equations are exact.
REASON = "a sphere touches at a point, so that Coulomb's law and impulse and momentum determine its motion"


def motion(problem: Problem, times: Array) -> ContactMotion | None:
    """The motion of one sphere at ascending times (n,) >= 0 (s), or None for anything else.

    Raises `NotModelled` for one whose moments of inertia differ, one that begins within the plane, and one that slips where
    nothing slips.
    """
    if len(problem.bodies) != 1 or problem.pushes:
        return None
    body = problem.bodies[0]
    radius = _radius(body.shape)
    if radius is None:
        return None
    if len(set(body.moments.tolist())) != 1:
        raise NotModelled("a sphere on a plane whose moments of inertia differ")
    round_body = ball(problem, body, radius, body.moments[0])
    return moved(
        round_body,
        body,
        begin(round_body, body.position, body.velocity, rotate(body.quaternion, body.spin)),
        times,
        "closed form: flight, impacts, slip and roll of a sphere",
        REASON,
    )


def _radius(shape: Shape) -> float | None:
    match shape:
        case Sphere(radius):
            return radius
        case Ellipsoid((radius, b, c)) if radius == b == c:
            return radius
    return None
