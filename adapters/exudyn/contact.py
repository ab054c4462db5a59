"""A brick that lies on a plane in Exudyn's `GeneralContact`: four spheres against a triangle, with springs and dampers.

The spheres have the height of the brick and touch the plane below its edges, so that the contacts are at its lower corners. A
contact is a linear spring with a damper, and its friction is Coulomb's, proportional to the velocity while this is small.
Exudyn has no default stiffness. Here the body's vertical motion is critically damped with a time constant of 3 ms, or of four
steps if they are longer, so that explicit solvers are stable. Under gravity g a brick sinks in by g times the square of the
time constant.
"""

import math
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.touching import lying_shape
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Body, Brick, Plane, Scene

#: The time constant (s) of the vertical motion on the contacts, and the least number of steps in it.
TIME_CONSTANT_S, STEPS_IN_TIME_CONSTANT = 3e-3, 4

#: The distance (m) from the origin to the nearest edge of the triangle.
GROUND_SIZE_M = 1e3


def brick(scene: Scene) -> Brick:
    """Return the shape of a brick that lies on the plane. Raises `SceneUnsupported` for other bodies."""
    shape = lying_shape(scene)
    if not isinstance(shape, Brick):
        raise SceneUnsupported(f"Exudyn's contacts are at corners, which {describe_shape(shape)} does not have")
    return shape


def add(system: "exudyn.MainSystem", number: Any, scene: Scene, plane: Plane, method: Method) -> "exudyn.GeneralContact":
    """Add to a system the plane under a body, given by its number, and the contacts between both; return the contacts.

    Raises `SceneUnsupported` for a body that is not a brick that lies flat.
    """
    shape, body = brick(scene), scene.body
    a, b, c = shape.semi_axes
    rate = 1 / max(TIME_CONSTANT_S, STEPS_IN_TIME_CONSTANT * method.timestep)
    # In a contact, the springs of the two objects are in series and their dampers are in parallel.
    stiffness, damping = 2 * body.mass * rate**2 / 4, body.mass * 2 * rate / 4 / 2
    common = {"contactStiffness": stiffness, "contactDamping": damping, "frictionMaterialIndex": 0}

    contact = system.AddGeneralContact()
    contact.SetFrictionPairings(plane.friction * np.eye(1))
    contact.SetSearchTreeCellSize(numberOfCells=[1, 1, 1])
    if method.option("settings") != "engine" and plane.friction:
        contact.frictionProportionalZone = proportional_zone(body, shape, plane.friction * scene.gravity, method.timestep)
    fixed = system.AddMarker(itemInterface.MarkerNodeRigid(nodeNumber=system.AddNode(itemInterface.NodePointGround())))
    corners = GROUND_SIZE_M * np.array([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]])
    contact.AddTrianglesRigidBodyBased(fixed, pointList=corners, triangleList=[[0, 1, 2]], **common)
    for x in (-a, a):
        for y in (-b, b):
            marker = system.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=number, localPosition=[x, y, 0.0]))
            contact.AddSphereWithMarker(marker, radius=c, **common)
    return contact


def proportional_zone(body: Body, shape: Brick, deceleration: float, timestep: float) -> float:
    """Return the speed (m/s) below which friction is proportional to the velocity, such that no step reverses the sliding.

    `deceleration` (m/s^2) is the deceleration of a sliding body by friction. In a pure spin a corner is decelerated by a
    multiple of it: the moment of inertia about the vertical of the body's mass, concentrated at the corner, divided by the
    body's own moment.
    """
    a, b, _ = shape.semi_axes
    ratio = max(1.0, body.mass * math.hypot(a, b) ** 2 / body.moments[2])
    return ratio * deceleration * timestep
