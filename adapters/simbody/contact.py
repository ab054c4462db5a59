"""Model the contact of a brick with the plane z = 0 by spheres at its lower corners, with OpenSim's Hunt-Crossley force.

Between a sphere of radius R and the plane the force is N = 4/3 E sqrt(R) d^1.5 (1 + 1.5 D v), where d is the depth and v its
rate (Hunt and Crossley, J. Appl. Mech. 42, 1975). OpenSim's stiffness is the stiffness of each of the two surfaces, which is
2^1.5 times the modulus E of the pair.
"""

import math
from typing import Any

import opensim

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.touching import lying_shape
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Brick, Plane, Scene

#: The depth to which a sphere sinks in under the weight at rest, and its radius, both in half-heights of the body.
SINKING, RADIUS = 1e-2, 0.1


def add_contact(model: Any, body: Any, scene: Scene, plane: Plane) -> None:
    """Add the plane, the spheres and their force to a model.

    Parameters
    ----------
    model, body
        OpenSim's model and the body in it.
    scene, plane
        The scene and its plane.

    Raises
    ------
    SceneUnsupported
        If the body does not lie flat, has no corners, or has no weight.
    """
    shape = lying_shape(scene)
    if not isinstance(shape, Brick):
        raise SceneUnsupported(f"contact at corners, which {describe_shape(shape)} does not have")
    if not scene.gravity:
        raise SceneUnsupported("contact without a weight")
    force = opensim.HuntCrossleyForce()
    force.setName("contact")
    # The half-space is on the side to which the x axis of its frame points.
    downwards = opensim.Vec3(0.0, math.pi / 2, 0.0)
    model.addContactGeometry(opensim.ContactHalfSpace(opensim.Vec3(0.0), downwards, model.getGround(), "plane"))
    force.addGeometry("plane")
    a, b, c = shape.semi_axes
    radius = RADIUS * c
    for number, (x, y) in enumerate((x, y) for x in (-a, a) for y in (-b, b)):
        centre = opensim.Vec3(x, y, radius - c)
        model.addContactGeometry(opensim.ContactSphere(radius, centre, body, f"corner_{number}"))
        force.addGeometry(f"corner_{number}")
    stiffness, dissipation = hardness(scene.body.mass * scene.gravity / 4, scene.gravity, SINKING * c, radius)
    force.setStiffness(stiffness)
    force.setDissipation(dissipation)
    force.setStaticFriction(plane.friction)
    force.setDynamicFriction(plane.friction)
    force.setViscousFriction(0.0)
    model.addForce(force)


def hardness(load: float, gravity: float, depth: float, radius: float) -> tuple[float, float]:
    """Return OpenSim's stiffness (Pa) and dissipation (s/m) of spheres that bear a load.

    Linearized at rest, a body on such spheres oscillates at the frequency w = sqrt(1.5 g / d), and the dissipation
    D = 2 w / (1.5 g) damps it critically.

    Parameters
    ----------
    load
        The load on one sphere (N).
    gravity
        The gravitational acceleration (m/s^2).
    depth
        The depth under the load (m).
    radius
        The radius of a sphere (m).
    """
    modulus = load / (4 / 3 * math.sqrt(radius) * depth**1.5)
    return 2**1.5 * modulus, 2 * math.sqrt(1.5 * gravity / depth) / (1.5 * gravity)
