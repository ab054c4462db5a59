"""Models of a scene in Pinocchio, from the smallest to the largest: the joints of the body, and additional computations."""

from typing import Any

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.pinocchio import coordinates
from bodycheck.adapters.pinocchio import joints as scene_joints
from bodycheck.adapters.pinocchio.joints import UNIVERSE, Joints, Step
from bodycheck.adapters.pinocchio.schemes import SCHEMES
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Scene, Shape, Sphere
from bodycheck.reference.trajectory import Array

#: Depth below the origin (m) of a half-space that no body ever touches.
FAR_PLANE_DEPTH_M = 1e6

#: The models of a scene in flight, from the smallest to the largest, each with a description of what it adds to the model
#: before.
IN_FLIGHT = {
    "translation": "a translation joint",
    "rotation": "a spherical joint",
    "translation-and-rotation": "a translation joint and a spherical one; velocities linear in the world frame",
    "six-coordinates": "one free-flyer joint; velocities are the body twist",
    "far-geometry": "the body's shape and a half-space 1000 km below it, collision detection in every step",
    "everything": "energies, mass matrix, Jacobians and all other terms in every step",
}

#: The models of a scene with a plane, in the same form.
ON_PLANE = {
    "planar": "joints along x and y and about z; friction is an external force",
    "translation-and-rotation": "a translation joint and a spherical one",
    "six-coordinates": "one free-flyer joint; velocities are the body twist",
    "far-geometry": "the body's shape and a half-space 1000 km below it, collision detection in every step",
    "contact": "the half-space under the body, with rigid contacts solved by ADMM and gravity instead of the force",
    "everything": "energies, mass matrix, Jacobians and all other terms in every step",
}

#: The functions that build the joints of each model in flight.
JOINTS = {
    "translation": scene_joints.translation,
    "rotation": scene_joints.rotation,
    "translation-and-rotation": scene_joints.translation_and_rotation,
    "six-coordinates": scene_joints.free_flyer,
    "far-geometry": scene_joints.free_flyer,
    "everything": scene_joints.free_flyer,
}

#: The coordinates of each model in flight that contains only the joints of the body.
COORDINATES = {
    "translation": coordinates.TRANSLATION,
    "rotation": coordinates.ROTATION,
    "translation-and-rotation": coordinates.TRANSLATION_AND_ROTATION,
    "six-coordinates": coordinates.FREE_FLYER,
}

#: The functions that build the joints of each model of a body of links. The origin of the first link may be anywhere.
OF_LINKS = {
    "translation-and-rotation": scene_joints.translation_and_rotation,
    "six-coordinates": scene_joints.free_flyer,
}

#: The functions that build the joints of each model on a plane.
JOINTS_ON_PLANE = JOINTS | {
    "planar": scene_joints.prismatic_and_revolute,
    "planar-joint": scene_joints.planar_joint,
    "contact": scene_joints.translation_and_rotation,
    "everything": scene_joints.translation_and_rotation,
}


def in_flight(scene: Scene, integrator: str) -> tuple[str, ...]:
    """Return the models of a scene in flight for which an integrator is the same scheme, the smallest first."""
    needs, (_, body_twist) = requirements(scene), SCHEMES[integrator]
    others = {"translation-and-rotation"} if body_twist else set()
    others |= {"rotation"} if needs.rotation == "none" else {"translation"}
    if needs.translation:
        others.add("rotation")
    if scene.body.shape is None:
        others.add("far-geometry")
    return tuple(name for name in IN_FLIGHT if name not in others)


def with_collision_detection(step: Step, joints: Joints, shape: Shape, depth: float) -> Step:
    """Return a step that is followed by collision detection between the body's shape and a half-space.

    Parameters
    ----------
    step
        The step to extend.
    joints
        The joints of the body.
    shape
        The shape of the body.
    depth
        The depth (m) of the half-space's surface below z = 0.

    Raises
    ------
    SceneUnsupported
        If the installed Pinocchio has no collision detection.
    """
    library = getattr(pin, "coal", None) or getattr(pin, "hppfcl", None)
    if library is None:
        raise SceneUnsupported(f"collision detection: Pinocchio {pin.__version__} was built without it")
    match shape:
        case Brick((a, b, c)):
            solid = library.Box(2 * a, 2 * b, 2 * c)
        case Ellipsoid(semi_axes):
            solid = library.Ellipsoid(*semi_axes)
        case Cylinder(radius, half_length):
            solid = library.Cylinder(radius, 2 * half_length)
        case Sphere(radius):
            solid = library.Sphere(radius)
    ground = library.Halfspace(np.array([0.0, 0.0, 1.0]), -depth)
    model, data, geometry = joints.model, joints.model.createData(), pin.GeometryModel()
    parts = (("body", joints.joint, solid), ("ground", UNIVERSE, ground))
    numbers = [geometry.addGeometryObject(geometry_object(name, joint, part)) for name, joint, part in parts]
    geometry.addCollisionPair(pin.CollisionPair(*numbers))
    results = geometry.createData()

    def checked(q: Array, v: Array) -> tuple[Array, Array]:
        q, v = step(q, v)
        pin.computeCollisions(model, data, geometry, results, q, False)
        return q, v

    return checked


def geometry_object(name: str, joint: int, solid: Any) -> pin.GeometryObject:
    """Return a geometry object: a solid that is fixed to a joint, in the joint's frame."""
    try:
        return pin.GeometryObject(name, joint, pin.SE3.Identity(), solid)
    except TypeError:  # before Pinocchio 3 the solid was the third argument
        return pin.GeometryObject(name, joint, solid, pin.SE3.Identity())


def with_all_terms(step: Step, joints: Joints) -> Step:
    """Return a step that is followed by the computation of all quantities that Pinocchio offers for a state."""
    model, data = joints.model, joints.model.createData()
    # `computeAllTerms` computes both energies; releases before Pinocchio 3 have no function that adds them.
    mechanical_energy = getattr(pin, "computeMechanicalEnergy", lambda model, data: data.kinetic_energy + data.potential_energy)

    def with_terms(q: Array, v: Array) -> tuple[Array, Array]:
        q, v = step(q, v)
        pin.computeAllTerms(model, data, q, v)
        mechanical_energy(model, data)
        return q, v

    return with_terms
