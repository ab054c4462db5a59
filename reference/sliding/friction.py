"""Coulomb friction of a flat face on a plane: force and torque as functions of velocity and spin, in the body frame.

At every point of the face friction is -mu p e, with the pressure p of the load and the direction e in which the point slides:
one law for sliding and spinning together (Farkas et al., Phys. Rev. Lett. 90, 248302, 2003; Weidman and Malhotra, Phys. Rev.
Lett. 95, 264303, 2005). The sums over the face are those of `direction_moments`, and are exact.
"""

import math
from collections.abc import Callable

from bodycheck.reference.errors import NotFlat
from bodycheck.reference.planar import describe_shape, resting_height
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Shape
from bodycheck.reference.sliding.direction_moments import direction_moments
from bodycheck.reference.sliding.footprint import Disk, Footprint, Points, Polygon, load_moments, rectangle
from bodycheck.reference.sliding.pressure import balanced, check, uniform
from bodycheck.reference.trajectory import Array

#: From velocity v1, v2 (m/s) of the point under the centre of mass and spin w (rad/s) to force (N) and torque (N m) there,
#: along and about the body's axes I, J and K. A body at rest feels none.
Law = Callable[[float, float, float], tuple[float, float, float]]

#: From velocity and spin to the pressure (3,) of the load, as in `pressure`.
Pressure = Callable[[float, float, float], Array]


def footprint_of(shape: Shape | None, law: str) -> Footprint:
    """The footprint of a body that lies on the face across its axis K, as a law of friction sees it.

    Raises `NotFlat` for shapes without such a face, and for the corners of a cylinder.
    """
    match shape:
        case Brick((a, b, _)):
            return Points(rectangle(a, b)) if law == "corners" else Polygon(rectangle(a, b))
        case Cylinder(radius, _) if law != "corners":
            return Disk(radius)
        case Cylinder():
            raise NotFlat("a cylinder has no corners to lie on")
        case _:
            raise NotFlat(f"{describe_shape(shape)} has no face to lie on")


def friction(body: Body, plane: Plane, gravity: float) -> Law:
    """The friction of a body that lies flat, by the law and the pressure that its plane names; gravity in m/s^2.

    A balanced load is not checked: see `refuse_tipping`. Raises `NotFlat` for shapes without the face that is needed, and
    `ValueError` for a balanced load under the decoupled law, in which the place of the load has no meaning.
    """
    footprint, load = footprint_of(body.shape, plane.law), body.mass * gravity
    if plane.law == "decoupled":
        if plane.pressure == "balanced":
            raise ValueError("a balanced load has no meaning under the decoupled law of friction")
        return decoupled_friction(footprint, plane.friction, load)
    if plane.pressure == "uniform":
        return uniform_friction(footprint, plane.friction, load)
    return balanced_friction(footprint, plane.friction, load, resting_height(body.shape))


def refuse_tipping(body: Body, plane: Plane, gravity: float) -> Callable[[float, float, float], None]:
    """The function of v1, v2 (m/s) and w (rad/s) that raises `WouldTip` where a balanced load would have to pull."""
    if plane.pressure == "uniform":
        return lambda v1, v2, w: None
    footprint = footprint_of(body.shape, plane.law)
    pressure = balanced_pressure(footprint, plane.friction, body.mass * gravity, resting_height(body.shape))
    return lambda v1, v2, w: check(footprint, pressure(v1, v2, w))


def uniform_friction(footprint: Footprint, coefficient: float, load: float) -> Law:
    """Friction under a load (N) that is spread evenly over the footprint, or over its points."""
    directions = direction_moments(footprint)
    scale = -coefficient * float(uniform(load_moments(footprint), load)[0])

    def law(v1: float, v2: float, w: float) -> tuple[float, float, float]:
        e1, e2, moment = directions(v1, v2, w)[0].tolist()
        return scale * e1, scale * e2, scale * moment

    return law


def balanced_pressure(footprint: Footprint, coefficient: float, load: float, height: float) -> Pressure:
    """The pressure under a load (N) that shifts to balance the moment of friction about the centre of mass.

    height: of the centre of mass above the plane (m). The pressure is negative somewhere where a body would tip.
    """
    directions, loads = direction_moments(footprint), load_moments(footprint)
    return lambda v1, v2, w: balanced(loads, directions(v1, v2, w), coefficient, load, height)


def balanced_friction(footprint: Footprint, coefficient: float, load: float, height: float) -> Law:
    """Friction under a load (N) that shifts to balance the moment of friction about the centre of mass at a height (m).

    It can be evaluated where a body would tip, because the trial steps of an integrator may lead there and back.
    """
    directions, loads = direction_moments(footprint), load_moments(footprint)

    def law(v1: float, v2: float, w: float) -> tuple[float, float, float]:
        moments = directions(v1, v2, w)
        force = -coefficient * (balanced(loads, moments, coefficient, load, height) @ moments)
        return float(force[0]), float(force[1]), float(force[2])

    return law


def decoupled_friction(footprint: Footprint, coefficient: float, load: float) -> Law:
    """The book's friction: mu N against the velocity, and the torque of the pure spin against the spin [G, Example 2.2].

    With both at once that is not Coulomb friction, which couples them. Where the load lies makes no difference to it.
    """
    _, _, torque = uniform_friction(footprint, coefficient, load)(0.0, 0.0, 1.0)

    def law(v1: float, v2: float, w: float) -> tuple[float, float, float]:
        speed = math.hypot(v1, v2)
        force = -coefficient * load if speed else 0.0
        speed = speed or 1.0
        return force * (v1 / speed), force * (v2 / speed), math.copysign(1, w) * torque if w else 0.0

    return law
