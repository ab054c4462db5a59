"""Coulomb friction of a flat face on a plane: force and torque as functions of velocity and spin, in the body frame.

At every point of the face the friction is -mu p e, with the pressure p of the load and the direction e in which the point
slides. This is one law for sliding and spinning together (Farkas et al., Phys. Rev. Lett. 90, 248302, 2003; Weidman and
Malhotra, Phys. Rev. Lett. 95, 264303, 2005). The integrals over the face are those of `direction_moments`, which are exact to
rounding.
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

#: A law of friction. It maps the velocity v1, v2 (m/s) of the point under the centre of mass along the body axes I and J, and
#: the spin w (rad/s) about K, to the force (N) along I and J and the torque (N m) about K. It is zero for a body at rest.
Law = Callable[[float, float, float], tuple[float, float, float]]

#: A distribution of the load. It maps the same velocity and spin to the pressure (3,) of the module `pressure`.
Pressure = Callable[[float, float, float], Array]


def footprint_of(shape: Shape | None, law: str) -> Footprint:
    """The footprint of a body that lies on the face across its axis K, under a law of friction (see `scene.Plane.law`).

    Raises `NotFlat` for a shape without such a face, and for a cylinder under the law "corners".
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
    """The law of friction of a body that lies flat, with the law and the pressure of its plane.

    It is not checked whether the body would tip under a balanced pressure; see `refuse_tipping`.

    Parameters
    ----------
    body
        The body.
    plane
        The plane.
    gravity
        Gravitational acceleration (m/s^2).

    Returns
    -------
    Law
        The law of friction.

    Raises
    ------
    NotFlat
        If the shape of the body lacks the face or the corners that are needed.
    ValueError
        If the pressure is balanced and the law is decoupled, since that law does not depend on where the load is.
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
    """Return a check of whether a body would tip.

    Parameters
    ----------
    body
        The body, which lies flat.
    plane
        The plane.
    gravity
        Gravitational acceleration (m/s^2).

    Returns
    -------
    Callable
        A function of v1, v2 (m/s) and w (rad/s), body frame, that raises `WouldTip` if the balanced pressure is negative
        somewhere. For a uniform pressure it does nothing.

    Raises
    ------
    NotFlat
        If the pressure is balanced and the shape of the body lacks the face or the corners that are needed.
    """
    if plane.pressure == "uniform":
        return lambda v1, v2, w: None
    footprint = footprint_of(body.shape, plane.law)
    pressure = balanced_pressure(footprint, plane.friction, body.mass * gravity, resting_height(body.shape))
    return lambda v1, v2, w: check(footprint, pressure(v1, v2, w))


def uniform_friction(footprint: Footprint, coefficient: float, load: float) -> Law:
    """The law of friction of a pressure that is the same everywhere on the footprint, or at all of its points.

    Parameters
    ----------
    footprint
        The footprint.
    coefficient
        Coefficient of friction mu.
    load
        Weight of the body (N).

    Returns
    -------
    Law
        The law of friction.
    """
    directions = direction_moments(footprint)
    scale = -coefficient * float(uniform(load_moments(footprint), load)[0])

    def law(v1: float, v2: float, w: float) -> tuple[float, float, float]:
        e1, e2, moment = directions(v1, v2, w)[0].tolist()
        return scale * e1, scale * e2, scale * moment

    return law


def balanced_pressure(footprint: Footprint, coefficient: float, load: float, height: float) -> Pressure:
    """The pressure that balances the moment of friction about the centre of mass; see `pressure.balanced`.

    Parameters
    ----------
    footprint
        The footprint.
    coefficient
        Coefficient of friction mu.
    load
        Weight of the body (N).
    height
        Height of the centre of mass above the plane (m).

    Returns
    -------
    Pressure
        The pressure as a function of velocity and spin. It is negative somewhere if the body would tip.
    """
    directions, loads = direction_moments(footprint), load_moments(footprint)
    return lambda v1, v2, w: balanced(loads, directions(v1, v2, w), coefficient, load, height)


def balanced_friction(footprint: Footprint, coefficient: float, load: float, height: float) -> Law:
    """The law of friction of a pressure that balances the moment of friction about the centre of mass.

    It can also be evaluated where the body would tip, because the trial stages of an integrator may reach such states.

    Parameters
    ----------
    footprint
        The footprint.
    coefficient
        Coefficient of friction mu.
    load
        Weight of the body (N).
    height
        Height of the centre of mass above the plane (m).

    Returns
    -------
    Law
        The law of friction.
    """
    directions, loads = direction_moments(footprint), load_moments(footprint)

    def law(v1: float, v2: float, w: float) -> tuple[float, float, float]:
        moments = directions(v1, v2, w)
        force = -coefficient * (balanced(loads, moments, coefficient, load, height) @ moments)
        return float(force[0]), float(force[1]), float(force[2])

    return law


def decoupled_friction(footprint: Footprint, coefficient: float, load: float) -> Law:
    """The book's law of friction: mu N against the velocity, and the torque of a pure spin against the spin [G, Example 2.2].

    It is not Coulomb friction for a body that slides and spins at once, since Coulomb friction couples the two. It does not
    depend on where the load is.

    Parameters
    ----------
    footprint
        The footprint.
    coefficient
        Coefficient of friction mu.
    load
        Weight N of the body (N).

    Returns
    -------
    Law
        The law of friction.
    """
    _, _, torque = uniform_friction(footprint, coefficient, load)(0.0, 0.0, 1.0)

    def law(v1: float, v2: float, w: float) -> tuple[float, float, float]:
        speed = math.hypot(v1, v2)
        force = -coefficient * load if speed else 0.0
        speed = speed or 1.0
        return force * (v1 / speed), force * (v2 / speed), math.copysign(1, w) * torque if w else 0.0

    return law
