"""Build the scene of a case from the tables of its file."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from bodycheck.casefile import grammar
from bodycheck.casefile.toml_positions import Path
from bodycheck.reference.inertia import MassProperties, composite, particles, principal_axes, principal_moments, solid
from bodycheck.reference.kinematics import body_rates, euler_from_quaternion, normalise, quaternion_from_euler
from bodycheck.reference.planar import resting_height
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Plane, Scene, Shape, Sphere, State

#: Smallest allowed ratio of the principal moments of particles or parts; a smaller ratio is rounding error.
MIN_MOMENT_RATIO = 1e-15


class Inconsistent(Exception):
    """Every key is allowed, but their combination is not. `faults` contains pairs of path and message."""

    def __init__(self, *faults: tuple[Path, str]) -> None:
        super().__init__(*faults)
        self.faults = faults


def build_scene(table: grammar.CaseTable) -> Scene:
    """Return the scene of a case. Raises `Inconsistent` for particles or parts that lie on a line."""
    body = _body(table.body)
    return Scene(
        body=body,
        initial=_state(table.initial, body, table.scene.plane is not None),
        gravity=table.scene.gravity,
        plane=Plane(**table.scene.plane.model_dump()) if table.scene.plane else None,
        drag=table.scene.drag.quadratic if table.scene.drag else 0.0,
    )


def _body(table: grammar.AnyBody) -> Body:
    if isinstance(table, grammar.ShapelessTable) and table.inertia is None:
        made = _composed(table)
        moments, axes = principal_axes(made.inertia)
        if not min(moments) > MIN_MOMENT_RATIO * max(moments):
            slender = (
                f"its principal moments are {moments}; a body on a line has no moment about that line, and cannot be simulated"
            )
            raise Inconsistent((("body",), slender))
        return Body(made.mass, moments, None, axes)
    shape = _shape(table)
    assert table.mass is not None  # the grammar requires a mass unless the body is composed
    if table.inertia is None:
        assert shape is not None
        return Body(table.mass, principal_moments(shape, table.mass), shape)
    inertia = np.array(table.inertia)
    moments, axes = principal_axes(np.diag(inertia) if inertia.ndim == 1 else inertia)
    return Body(table.mass, moments, shape, axes)


def _shape(table: grammar.AnyBody | grammar.PartTable) -> Shape | None:
    match table:
        case grammar.BrickTable(semi_axes=semi_axes) | grammar.PartTable(shape="brick", semi_axes=tuple(semi_axes)):
            return Brick(semi_axes)
        case grammar.EllipsoidTable(semi_axes=semi_axes) | grammar.PartTable(shape="ellipsoid", semi_axes=tuple(semi_axes)):
            return Ellipsoid(semi_axes)
        case (
            grammar.CylinderTable(radius=radius, half_length=half_length)
            | grammar.PartTable(shape="cylinder", radius=float(radius), half_length=float(half_length))
        ):
            return Cylinder(radius, half_length)
        case grammar.SphereTable(radius=radius) | grammar.PartTable(shape="sphere", radius=float(radius)):
            return Sphere(radius)
        case _:
            return None


def _composed(table: grammar.ShapelessTable) -> MassProperties:
    if table.particles is not None:
        return particles([particle.mass for particle in table.particles], [particle.position for particle in table.particles])
    solids = [
        solid(shape, part.mass, part.position, _attitude(part).astype(float))
        for part in table.parts or ()
        if (shape := _shape(part)) is not None
    ]
    return composite(solids)


def _attitude(table: grammar.InitialTable | grammar.PartTable) -> NDArray[np.longdouble]:
    """Return the unit quaternion from a quaternion or Euler angles, in extended precision."""
    if table.quaternion is not None:
        return normalise(np.array(table.quaternion, dtype=np.longdouble))
    return quaternion_from_euler(*_widened(table.euler_zxz or (0.0, 0.0, 0.0)))


def _state(table: grammar.InitialTable, body: Body, on_plane: bool) -> State:
    """Return the initial state, computed in extended precision so that its doubles are the closest to the file's values.

    If no position is given, a body with a flat face lies on the plane.
    """
    lying = on_plane and isinstance(body.shape, Brick | Cylinder)
    position = table.position or (0.0, 0.0, resting_height(body.shape) if lying else 0.0)
    rates = table.angular_velocity or (0.0, 0.0, 0.0)
    if table.euler_rates is not None:
        _, theta, psi = euler_from_quaternion(_attitude(table)) if table.quaternion else _widened(table.euler_zxz or (0, 0, 0))
        x, y, z = body_rates(theta, psi, *_widened(table.euler_rates)).tolist()
        rates = float(x), float(y), float(z)
    w, x, y, z = _attitude(table).astype(float).tolist()
    return State(position, (w, x, y, z), table.velocity, rates)


def _widened(values: Sequence[float]) -> Iterator[NDArray[np.longdouble]]:
    return (np.asarray(np.longdouble(value)) for value in values)
