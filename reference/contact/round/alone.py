"""A sphere, or a cylinder on its side, alone on a plane: flights, impacts, slip and roll, in closed form from phase to phase.

A cylinder flies, hits the plane, slips and rolls across its axis like a sphere. It touches along a line. If it turns only about
its axis, does not move along it, and gravity has no component along it, all points of the line have the same slip, friction
acts in the middle of the line, and its motion is the plane motion of a sphere with the moment of inertia about its axis.
"""

from dataclasses import replace

import numpy as np

from bodycheck.reference.contact.motion import ContactMotion
from bodycheck.reference.contact.problem import NONE, ContactBody, Problem
from bodycheck.reference.contact.round.ball import ball
from bodycheck.reference.contact.round.motion import begin, moved
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.kinematics import dot, rotate
from bodycheck.reference.scene import Cylinder, Ellipsoid, Shape, Sphere
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The reason why the equations of a sphere are exact.
SPHERE_REASON = "a sphere touches at a point, so that Coulomb's law and impulse and momentum determine its motion"

#: The reason why the equations of a cylinder are exact.
CYLINDER_REASON = "a cylinder that rolls or slips across its axis touches along a line whose points slip alike"


def sphere(problem: Problem, times: Array) -> ContactMotion | None:
    """The motion of one sphere at ascending times (n,) >= 0 (s), or None for any other problem.

    Raises `NotModelled` for a sphere whose moments of inertia differ, that begins within the plane, or that slips at the start
    on a plane on which nothing slips.
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
        SPHERE_REASON,
    )


def _radius(shape: Shape) -> float | None:
    match shape:
        case Sphere(radius):
            return radius
        case Ellipsoid((radius, b, c)) if radius == b == c:
            return radius
    return None


def cylinder(problem: Problem, times: Array) -> ContactMotion | None:
    """The motion of one cylinder on its side at ascending times (n,) >= 0 (s), or None for any other problem.

    Raises `NotModelled` for a cylinder that turns about another axis, moves along its axis, or is pulled along it by gravity,
    and in the same cases as `begin` and `ball`.
    """
    if len(problem.bodies) != 1 or problem.pushes:
        return None
    body = problem.bodies[0]
    if not isinstance(body.shape, Cylinder):
        return None
    axis = rotate(body.quaternion, np.array([0, 0, 1], Wide))
    if abs(axis[2]) > NONE:
        return None
    straight = _level(axis, problem)
    along, aside = Wide(dot(body.velocity, straight)), np.hypot(body.spin[0], body.spin[1])
    _refuse(problem, body, straight, along, aside)
    round_body = ball(problem, body, body.shape.radius, body.moments[2])
    begun = begin(round_body, body.position, body.velocity - along * straight, body.spin[2] * straight)
    begun = replace(begun, velocity_error=begun.velocity_error + abs(along) + round_body.radius * aside)
    whole = moved(
        round_body, body, begun, times, "closed form: flight, impacts, slip and roll of a cylinder on its side", CYLINDER_REASON
    )
    tilt = float(np.abs(axis - straight).sum())
    turning = np.abs(whole.spin[0]).max(axis=1).astype(float)
    added = {"error": 2 * tilt, "angular_velocity_error": tilt * turning}
    return replace(whole, errors={name: error + added.get(name, 0.0) for name, error in whole.errors.items()})


def _level(axis: WideArray, problem: Problem) -> WideArray:
    """The direction (3,) of an axis that is along the plane within rounding, without its component along the normal.

    If the axis is also perpendicular to the fall line of an incline within rounding, it is made exactly perpendicular.
    """
    if problem.gravity[0] and abs(axis[0]) <= NONE:
        return np.array([0, np.sign(axis[1]), 0], Wide)
    return np.asarray(np.array([axis[0], axis[1], 0], Wide) / np.hypot(axis[0], axis[1]))


def _refuse(problem: Problem, body: ContactBody, axis: WideArray, along: Wide, aside: Wide) -> None:
    """Raise `NotModelled` for a cylinder that moves along its axis, turns about another axis, or is pulled along its axis."""
    if aside > NONE * abs(body.spin[2]):
        raise NotModelled("a cylinder on its side that turns about another axis than its own")
    if abs(along) > NONE * np.sqrt(dot(body.velocity, body.velocity)):
        raise NotModelled("a cylinder on its side that moves along its axis")
    if problem.gravity[0] and axis[0]:
        raise NotModelled("a cylinder on its side on an incline, with an axis that is not perpendicular to the fall line")
