"""Bodies at rest that bear each other: stacks and piles of bricks and standing cylinders, with spheres on level faces.

All faces that bear loads are parallel to the plane. All contact forces are along gravity, so that the forces are parallel:
projected along gravity, the centre of mass of all bodies that a face bears must be within the face, and tan(alpha) <= mu at
each face.
"""

from collections.abc import Sequence

import numpy as np

from bodycheck.reference.bounds import EPS, STATES
from bodycheck.reference.contact.motion import ContactMotion, Interface
from bodycheck.reference.contact.piles.bearing import Bearing, balanced, centre_of, loads
from bodycheck.reference.contact.piles.upright import SLIVER, Upright, margin, meet, upright
from bodycheck.reference.contact.problem import NONE, Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Wide, wide
from bodycheck.reference.mechanisms.mechanism import WORLD
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: Relative error of a number of the widest type after a few roundings.
ROUNDINGS = 8 * float(np.finfo(Wide).eps)

#: The relative rounding of the inputs within which rest and sliding are not distinguished.
AT_THE_LIMIT = 4 * EPS


def motion(problem: Problem, times: Array) -> ContactMotion | None:
    """The constant states, at ascending times (n,) >= 0 (s), of several bodies that rest on a plane and on each other.

    Returns None for a single body, with pushes or without gravity onto the plane, for bodies that move or do not stand upright,
    for spheres on an incline, and where a body touches nothing below it. Raises `NotModelled` where the bodies cannot rest.
    """
    if len(problem.bodies) < 2 or problem.pushes or not problem.gravity[2] or _moves(problem):
        return None
    stands = [upright(body) for body in problem.bodies]
    faces = [face for face in stands if face is not None]
    if len(faces) < len(stands) or (problem.plane.incline and any(face.ball for face in faces)):
        return None
    bearings, beside = bearings_of(faces)
    if {bearing.upper for bearing in bearings} != set(range(len(faces))):
        return None
    slope = _slope(problem, bearings)
    if _is_tree(bearings):
        _check_tree(problem, faces, bearings, slope)
    elif not balanced(problem, faces, bearings, float(slope)):
        raise NotModelled("bodies that bear each other and are not at rest by their weights alone")
    forces = {} if beside else loads(problem, faces, bearings)
    interfaces = tuple(Interface(bearing.pair, load) for bearing, load in forces.items())
    return _at_rest(problem, times, faces, bearings, float(slope), interfaces)


def bearings_of(faces: Sequence[Upright]) -> tuple[tuple[Bearing, ...], bool]:
    """Return which bodies bear which, and whether the sides of any bodies touch.

    Raises `NotModelled` if bodies overlap, or a body stands on a sphere.
    """
    near = NONE * max(face.size for face in faces)
    bearings, beside = [], False
    for upper, above in enumerate(faces):
        if above.bottom < -near:
            raise NotModelled("a body that reaches into the plane at the start")
        if abs(above.bottom) <= near:
            bearings.append(Bearing(WORLD, upper))
        for lower, below in enumerate(faces):
            if lower == upper or above.bottom + above.top < below.bottom + below.top:
                continue
            gap = above.bottom - below.top
            if gap > near or not meet(above, below, larger=SLIVER):
                continue
            if above.ball and below.ball:
                _check_spheres(above, below, near)
            elif above.ball and abs(gap) <= near:
                if margin(below, above.centre) > near:
                    bearings.append(Bearing(lower, upper))
            elif not meet(above, below, larger=-SLIVER):
                beside = True
            elif gap < -near:
                raise NotModelled("bodies that overlap at the start")
            elif below.ball:
                raise NotModelled("a body that stands on a sphere")
            else:
                bearings.append(Bearing(lower, upper))
    return tuple(bearings), beside


def _check_spheres(one: Upright, other: Upright, near: float) -> None:
    """Raise `NotModelled` if two spheres, whose outlines along the normal overlap, touch or overlap in space."""
    rise = (one.bottom + one.top - other.bottom - other.top) / 2
    if np.hypot(np.hypot(*(one.centre - other.centre)), rise) <= one.half[0] + other.half[0] + near:
        raise NotModelled("spheres that touch each other")


def _moves(problem: Problem) -> bool:
    return any(np.any(body.velocity) or np.any(body.spin) for body in problem.bodies)


def _slope(problem: Problem, bearings: Sequence[Bearing]) -> Wide:
    """The tangent of the incline. Raises `NotModelled` if the friction of a bearing does not hold.

    A coefficient that is smaller than the tangent by no more than roundings counts as sufficient; see `_creep`.
    """
    tangent = MP.tan(MP.mpf(problem.plane.incline))
    for bearing in bearings:
        friction = problem.pair(bearing.lower, bearing.upper)[0]
        if tangent > MP.mpf(friction) * (1 + AT_THE_LIMIT):
            raise NotModelled("several bodies on an incline that slide")
    return wide(tangent)


def _is_tree(bearings: Sequence[Bearing]) -> bool:
    """Return whether every body rests on exactly one other body or the plane."""
    return len({bearing.upper for bearing in bearings}) == len(bearings)


def _check_tree(problem: Problem, faces: Sequence[Upright], bearings: Sequence[Bearing], slope: Wide) -> None:
    """Raise `NotModelled` if the centre of mass that a face bears, projected along gravity, is not within the face."""
    below = {bearing.upper: bearing.lower for bearing in bearings}
    for upper, face in enumerate(faces):
        borne = [index for index in below if _rests_on(index, upper, below)]
        centre = centre_of([problem.bodies[index] for index in borne])
        point = centre[:2] + np.array([(centre[2] - face.bottom) * slope, Wide(0)])
        rims = [other for other in (face, *([faces[below[upper]]] if below[upper] != WORLD else [])) if not other.ball]
        if any(margin(rim, point) <= NONE * rim.size for rim in rims):
            raise NotModelled("a stack that tips over")


def _rests_on(index: int, lowest: int, below: dict[int, int]) -> bool:
    """Return whether the body `index` is the body `lowest`, or rests on it directly or through other bodies."""
    while index not in (lowest, WORLD):
        index = below[index]
    return index == lowest


def _at_rest(
    problem: Problem,
    times: Array,
    faces: Sequence[Upright],
    bearings: Sequence[Bearing],
    slope: float,
    interfaces: tuple[Interface, ...],
) -> ContactMotion:
    """The states of bodies that stay where they are.

    The bounds cover gaps and tilts from decimals in the file, roundings, and creep at the limit of friction.
    """
    n, (position, quaternion) = len(times), (_repeated(problem, name, len(times)) for name in ("position", "quaternion"))
    size = float(np.abs(position).max()) + max(face.size for face in faces)
    tops = [Wide(0) if bearing.lower == WORLD else faces[bearing.lower].top for bearing in bearings]
    gap = max(abs(float(faces[bearing.upper].bottom - top)) for bearing, top in zip(bearings, tops, strict=True))
    tilt, creep = max(face.tilt for face in faces), _creep(problem, bearings, slope)
    errors = {
        "error": np.full(n, tilt + ROUNDINGS),
        "position_error": len(faces) * (gap + tilt * size) + ROUNDINGS * size + creep * times**2 / 2,
        "velocity_error": creep * times,
        "angular_velocity_error": np.zeros(n),
    }
    assert tuple(errors) == STATES
    return ContactMotion(
        position,
        np.zeros_like(position),
        quaternion,
        np.zeros_like(position),
        errors,
        (),
        "statics: balance of forces and moments",
        "all faces bear what is above them within their rims, and friction holds",
        friction=slope,
        interfaces=interfaces,
    )


def _repeated(problem: Problem, name: str, count: int) -> WideArray:
    return np.repeat(np.array([getattr(body, name) for body in problem.bodies])[:, None], count, axis=1)


def _creep(problem: Problem, bearings: Sequence[Bearing], slope: float) -> float:
    """A bound of the acceleration (m/s^2) of the highest body if frictions at the limit do not hold because of roundings."""
    at_limit = [problem.pair(bearing.lower, bearing.upper)[0] <= slope * (1 + AT_THE_LIMIT) for bearing in bearings]
    return 2 * AT_THE_LIMIT * slope * abs(float(problem.gravity[2])) * sum(at_limit) if slope else 0.0
