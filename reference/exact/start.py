"""The start of the rotation of a scene, along the principal axes of its body, in exact arithmetic."""

import functools
from dataclasses import dataclass, replace

from bodycheck.reference.exact.axes import principal_axes
from bodycheck.reference.exact.inertia import mass_properties
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Quaternion4, Real, Vector3, doubles, vector
from bodycheck.reference.exact.rotations import IDENTITY, attitude, body_rates, conjugate, matrix, multiply, turned, unit
from bodycheck.reference.scene import Attitude, Body, Definition, EulerRates, Given, Nearest, Scene, Shape, State, Vector, valid


@dataclass(frozen=True, eq=False)
class Inertia:
    """Mass (kg), principal moments A, B, C (kg m^2), and the unit quaternion from the principal axes to the body frame."""

    mass: Real
    moments: Vector3
    axes: Quaternion4


@dataclass(frozen=True, eq=False)
class Start:
    """A body and the start of its rotation, along its principal axes.

    Attributes
    ----------
    moments
        Principal moments A, B, C (kg m^2).
    axes
        Unit quaternion (w, x, y, z) that rotates components along the principal axes to components in the body frame.
    attitude
        Unit quaternion (w, x, y, z) that rotates components along the principal axes to world components at t = 0.
    rates
        Angular velocity along the principal axes at t = 0 (rad/s).
    """

    moments: Vector3
    axes: Quaternion4
    attitude: Quaternion4
    rates: Vector3


@functools.lru_cache(maxsize=64)
def start(scene: Scene) -> Start:
    """The start of the rotation of a scene.

    The parts of the scene's definition that are valid are used (see `scene.valid`). Otherwise the doubles of the scene are
    taken as exact, and only the direction of a quaternion counts.
    """
    body, initial, definition, holds = scene.body, scene.initial, scene.definition, valid(scene)
    if definition is not None and holds.inertia:
        inertia = defined_inertia(definition.inertia)
    else:
        w, x, y, z = body.axes
        inertia = Inertia(MP.mpf(body.mass), vector(body.moments), unit((MP.mpf(w), MP.mpf(x), MP.mpf(y), MP.mpf(z))))
    turn, rates = attitude(initial.quaternion), vector(initial.angular_velocity)
    if definition is not None:
        exact_turn, exact_rates = defined_rotation(definition.attitude, definition.rotation)
        turn = exact_turn if holds.attitude else turn
        rates = exact_rates if holds.rotation else rates
    if inertia.axes == IDENTITY:
        return Start(inertia.moments, IDENTITY, turn, rates)
    return Start(inertia.moments, inertia.axes, multiply(turn, inertia.axes), _along(inertia.axes, rates))


def defined_scene(definition: Definition, shape: Shape | None) -> Scene:
    """The scene with the body and the initial rotation of a definition, in the nearest doubles, and nothing else.

    shape: the shape that the body has for contact, if any.
    """
    inertia = defined_inertia(definition.inertia)
    turn, rates = defined_rotation(definition.attitude, definition.rotation)
    (a, b, c), (p, q, r) = doubles(inertia.moments), doubles(rates)
    (aw, ax, ay, az), (w, x, y, z) = doubles(inertia.axes), doubles(turn)
    return Scene(
        body=Body(float(inertia.mass), (a, b, c), shape, (aw, ax, ay, az)),
        initial=State(quaternion=(w, x, y, z), angular_velocity=(p, q, r)),
        definition=replace(definition, nearest=Nearest((a, b, c), (aw, ax, ay, az), (w, x, y, z), (p, q, r))),
    )


@functools.lru_cache(maxsize=64)
def defined_inertia(definition: Given) -> Inertia:
    """The inertia of a body as a file defines it."""
    properties = mass_properties(definition)
    moments, axes = principal_axes(properties.tensor)
    return Inertia(properties.mass, moments, axes)


def defined_rotation(orientation: Attitude, rotation: Vector | EulerRates) -> tuple[Quaternion4, Vector3]:
    """The unit quaternion of an attitude and the angular velocity in the body frame (rad/s) that a file gives."""
    rates = body_rates(orientation, rotation) if isinstance(rotation, EulerRates) else vector(rotation)
    return attitude(orientation), rates


def _along(axes: Quaternion4, rates: Vector3) -> Vector3:
    """The components of an angular velocity along the principal axes; rounding errors of zero are set to zero.

    A component along an axis of the body frame is exact, and is kept however small it is.
    """
    rows = matrix(conjugate(axes))
    limit = NEGLIGIBLE * max(abs(rate) for rate in rates)
    exact = [sum(bool(part) for part in row) == 1 for row in rows]
    x, y, z = (
        rate if is_exact or abs(rate) > limit else MP.mpf(0) for rate, is_exact in zip(turned(rows, rates), exact, strict=True)
    )
    return x, y, z
