"""The axes along which a case is pushed: each takes a case and a value to the case that has it."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.casefile.case import Case
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Shape, Sphere, State, Vector
from bodycheck.running.simulation import DEFAULT_TIMESTEP

Axis = Callable[[Case, float], Case]


@dataclass(frozen=True)
class Point:
    """A case with one of its axes at a value, and the time step (s) with which it is run."""

    case: Case
    axis: str
    value: float
    timestep: float


def points(case: Case) -> Iterator[Point]:
    """Every value of every axis of a case, one axis at a time from the case as it stands.

    Spins and time steps, where a case has both, are taken together: every spin with every step.
    """
    values = dict(case.extremes)
    timesteps = values.pop("timestep", ())
    for name, tried in values.items():
        for value in tried:
            for timestep in (name == "spin" and timesteps) or (DEFAULT_TIMESTEP,):
                yield Point(AXES[name](case, value), name, value, timestep)
    if "spin" not in values:
        yield from (Point(case, "timestep", timestep, timestep) for timestep in timesteps)


def spin(case: Case, value: float) -> Case:
    """The initial angular velocity at this size (rad/s), its direction kept."""
    initial = case.scene.initial
    return _with_state(case, replace(initial, angular_velocity=_scaled(initial.angular_velocity, value)))


def speed(case: Case, value: float) -> Case:
    """The initial velocity at this size (m/s), its direction kept."""
    initial = case.scene.initial
    return _with_state(case, replace(initial, velocity=_scaled(initial.velocity, value)))


def steps(case: Case, value: float) -> Case:
    """As many steps of the default time step as this."""
    return replace(case, duration=round(value) * DEFAULT_TIMESTEP)


def distance(case: Case, value: float) -> Case:
    """The start moved away from the origin by this along x (m)."""
    initial = case.scene.initial
    x, y, z = initial.position
    return _with_state(case, replace(initial, position=(x + value, y, z)))


def gravity(case: Case, value: float) -> Case:
    """Another gravity (m/s^2)."""
    return replace(case, scene=replace(case.scene, gravity=value))


def friction(case: Case, value: float) -> Case:
    """Another coefficient of friction of the plane."""
    assert case.scene.plane is not None  # a case file that has this axis without a plane is refused
    return replace(case, scene=replace(case.scene, plane=replace(case.scene.plane, friction=value)))


def mass(case: Case, value: float) -> Case:
    """Another mass (kg) of the same shape: the moments in proportion."""
    body = case.scene.body
    return _with_body(case, replace(body, mass=value, moments=_times(body.moments, value / body.mass)))


def size(case: Case, value: float) -> Case:
    """All lengths of the body times this at the same density: its mass goes with the cube, its moments with the fifth power.

    A body on a plane still lies on it.
    """
    body, initial = case.scene.body, case.scene.initial
    shape = None if body.shape is None else _grown(body.shape, value)
    if case.scene.plane is not None:
        x, y, z = initial.position
        case = _with_state(case, replace(initial, position=(x, y, z * value)))
    return _with_body(case, Body(body.mass * value**3, _times(body.moments, value**5), shape, body.axes))


def moment_ratio(case: Case, value: float) -> Case:
    """The body stretched along its principal axis K until C / (A + B) is this: 1 for a disc across K, towards 0 for a needle.

    With the second moments S_x, S_y, S_z of the mass, A = S_y + S_z, B = S_x + S_z and C = S_x + S_y: a stretch changes S_z
    alone, and no value breaks A + B >= C. The shape, which free flight does not know, is dropped.
    """
    body = case.scene.body
    a, b, c = body.moments
    along = c / 2 * (1 / value - 1)
    return _with_body(case, replace(body, moments=((c + a - b) / 2 + along, (c + b - a) / 2 + along, c), shape=None))


def separatrix(case: Case, value: float) -> Case:
    """A spin of the same size about the axis of the middle moment, and a wobble of this part of it about that of the least.

    The closer to 0, the closer to the separatrix: the time between flips grows as ln(1 / value).
    """
    body, initial = case.scene.body, case.scene.initial
    least, middle, _ = sorted(range(3), key=body.moments.__getitem__)
    rates = np.zeros(3)
    rates[middle] = math.hypot(*initial.angular_velocity)
    rates[least] = value * rates[middle]
    x, y, z = rotate(np.array(body.axes), rates).tolist()
    return _with_state(case, replace(initial, angular_velocity=(x, y, z)))


#: All but the time step, which is none of a case but of a method.
AXES: dict[str, Axis] = {
    axis.__name__: axis for axis in (spin, steps, moment_ratio, mass, size, distance, gravity, friction, speed, separatrix)
}


def _with_state(case: Case, initial: State) -> Case:
    return replace(case, scene=replace(case.scene, initial=initial))


def _with_body(case: Case, body: Body) -> Case:
    return replace(case, scene=replace(case.scene, body=body))


def _scaled(vector: Vector, size: float) -> Vector:
    return _times(vector, size / math.hypot(*vector))


def _times(vector: Vector, factor: float) -> Vector:
    x, y, z = vector
    return x * factor, y * factor, z * factor


def _grown(shape: Shape, factor: float) -> Shape:
    match shape:
        case Brick(semi_axes):
            return Brick(_times(semi_axes, factor))
        case Ellipsoid(semi_axes):
            return Ellipsoid(_times(semi_axes, factor))
        case Cylinder(radius, half_length):
            return Cylinder(radius * factor, half_length * factor)
        case Sphere(radius):
            return Sphere(radius * factor)
