"""Let a body that lies flat touch the plane z = 0 by Drake's contact: the geometries and their properties.

Stiffness, modulus, dissipation and relaxation time are Drake's defaults. The plane and the body have the same coefficient of
friction, static and dynamic, because Drake takes the harmonic mean of the two.
"""

from typing import Any

from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Box,
    HalfSpace,
    ProximityProperties,
    SceneGraphConfig,
    Sphere,
)
from pydrake.geometry import Cylinder as CylinderGeometry
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction

from bodycheck.adapters.contract import Kind, Method, Option, SceneUnsupported, choice
from bodycheck.adapters.touching import lying_shape
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Plane, Scene, Shape

#: Contact options have an effect only in scenes with a plane.
ON_PLANE: frozenset[Kind] = frozenset({"plane", "contact"})

#: The contact options; see the package's docstring.
OPTIONS: dict[str, Option] = {
    "contact": choice("hydroelastic", "points", kinds=ON_PLANE),
    "settings": choice("engine", kinds=ON_PLANE),
}

#: Length (m) of the edges of a hydroelastic mesh of a round body in radii, the smallest ones.
EDGE_IN_RADII = 0.2


def contact_of(method: Method, usual: str = "hydroelastic") -> str:
    """Return the model of contact with the plane: hydroelastic, points or engine, or the usual one without an option.

    Raises `SceneUnsupported` for a method that selects two of them.
    """
    chosen, settings = method.option("contact"), method.option("settings")
    if chosen and settings:
        raise SceneUnsupported(f"contact={chosen} together with settings={settings}, which choose the contact themselves")
    return settings or chosen or usual


def add_contact(plant: Any, body: Any, scene: Scene, plane: Plane, contact: str) -> None:
    """Add the geometries of the plane and of a body that lies on it to a plant that is not finalized.

    Parameters
    ----------
    plant, body
        Drake's plant, which is registered with a scene graph, and the body in it.
    scene, plane
        The scene and its plane.
    contact
        The model of contact, as `contact_of` returns it.

    Raises
    ------
    SceneUnsupported
        If the body does not lie flat, or has no corners where it touches the plane by points.
    """
    shape = lying_shape(scene)
    on_plane, on_body = properties(plane.friction), properties(plane.friction)
    if contact == "hydroelastic":
        rigid(on_plane)
        compliant(on_body, shape)
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "plane", on_plane)
    for number, (geometry, pose) in enumerate(_geometries(shape, contact)):
        plant.RegisterCollisionGeometry(body, RigidTransform(pose), geometry, f"body {number}", on_body)


def properties(friction: float, dissipation: float | None = None) -> Any:
    """Return the properties of a geometry with a coefficient of friction, and with a dissipation (s/m) in place of Drake's."""
    result = ProximityProperties()
    AddContactMaterial(properties=result, friction=CoulombFriction(friction, friction), dissipation=dissipation)
    return result


def rigid(on_plane: Any) -> None:
    """Make a geometry with these properties rigid in hydroelastic contact."""
    AddRigidHydroelasticProperties(on_plane)


def compliant(on_body: Any, shape: Shape) -> None:
    """Make a geometry with these properties compliant in hydroelastic contact, with Drake's modulus.

    The mesh of a brick does not depend on the length of its edges.
    """
    modulus = SceneGraphConfig().default_proximity_properties.hydroelastic_modulus
    match shape:
        case Brick():
            edge = 1.0
        case Ellipsoid(half):
            edge = EDGE_IN_RADII * min(half)
        case _:
            edge = EDGE_IN_RADII * shape.radius
    AddCompliantHydroelasticProperties(edge, modulus, on_body)


def _geometries(shape: Brick | Cylinder, contact: str) -> list[tuple[Any, list[float]]]:
    """Return the geometries of a body, each with the position (m) of its centre in the body's frame."""
    if contact == "points":
        if not isinstance(shape, Brick):
            raise SceneUnsupported(f"contact=points has points at corners, which {describe_shape(shape)} does not have")
        a, b, c = shape.semi_axes
        return [(Sphere(0.0), [x, y, -c]) for x in (-a, a) for y in (-b, b)]
    match shape:
        case Brick((a, b, c)):
            return [(Box(2 * a, 2 * b, 2 * c), [0.0, 0.0, 0.0])]
        case Cylinder(radius, half_length):
            return [(CylinderGeometry(radius, 2 * half_length), [0.0, 0.0, 0.0])]
