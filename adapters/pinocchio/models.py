"""Models of a scene in Pinocchio, from the smallest on: the joints that carry the body, and what a step computes besides."""

from typing import Any

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.pinocchio import joints as joints_of
from bodycheck.adapters.pinocchio.joints import UNIVERSE, Joints, Step
from bodycheck.adapters.pinocchio.schemes import SCHEMES
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Scene, Shape, Sphere
from bodycheck.reference.trajectory import Array

#: How far below the start a plane is that nothing ever touches (m).
FAR = 1e6

#: The models of a scene in flight in order of growth, and what each has that the one before it has not.
IN_FLIGHT = {
    "translation": "a translation joint",
    "rotation": "a spherical joint",
    "translation-and-rotation": "a translation joint and a spherical one; velocities linear in the world frame",
    "six-coordinates": "one free-flyer joint; velocities are the body twist",
    "far-geometry": "the body's shape and a half-space 1000 km below it, collision detection in every step",
    "everything": "energies, mass matrix, Jacobians and all other terms in every step",
}

#: The same for a body on a plane.
ON_PLANE = {
    "planar": "joints along x and y and about z; friction is a force from outside",
    "translation-and-rotation": "a translation joint and a spherical one",
    "six-coordinates": "one free-flyer joint; velocities are the body twist",
    "far-geometry": "the body's shape and a half-space 1000 km below it, collision detection in every step",
    "contact": "the half-space under the body, with rigid contacts solved by ADMM and gravity instead of the force",
    "everything": "energies, mass matrix, Jacobians and all other terms in every step",
}

JOINTS = {
    "translation": joints_of.translation,
    "rotation": joints_of.rotation,
    "translation-and-rotation": joints_of.apart,
    "six-coordinates": joints_of.free_flyer,
    "far-geometry": joints_of.free_flyer,
    "everything": joints_of.free_flyer,
}

JOINTS_ON_PLANE = JOINTS | {
    "planar": joints_of.on_axes,
    "planar-joint": joints_of.planar,
    "contact": joints_of.apart,
    "everything": joints_of.apart,
}


def in_flight(scene: Scene, integrator: str) -> tuple[str, ...]:
    """The models of a scene in flight on which an integrator remains the same scheme, the smallest first."""
    needs, (_, body_twist) = requirements(scene), SCHEMES[integrator]
    others = {"translation-and-rotation"} if body_twist else set()
    others |= {"rotation"} if needs.rotation == "none" else {"translation"}
    if needs.translation:
        others.add("rotation")
    if scene.body.shape is None:
        others.add("far-geometry")
    return tuple(name for name in IN_FLIGHT if name not in others)


def with_collision_detection(step: Step, joints: Joints, shape: Shape, depth: float) -> Step:
    """A step after which a body's shape is looked up against the half-space below a depth (m). Raises `SceneUnsupported`."""
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
    numbers = [geometry.addGeometryObject(placed(name, joint, part)) for name, joint, part in parts]
    geometry.addCollisionPair(pin.CollisionPair(*numbers))
    found = geometry.createData()

    def checked(q: Array, v: Array) -> tuple[Array, Array]:
        q, v = step(q, v)
        pin.computeCollisions(model, data, geometry, found, q, False)
        return q, v

    return checked


def placed(name: str, joint: int, solid: Any) -> pin.GeometryObject:
    """A solid that is fixed to a joint, in its frame."""
    try:
        return pin.GeometryObject(name, joint, pin.SE3.Identity(), solid)
    except TypeError:  # before Pinocchio 3 the solid comes first
        return pin.GeometryObject(name, joint, solid, pin.SE3.Identity())


def with_all_terms(step: Step, joints: Joints) -> Step:
    """A step after which everything is computed that Pinocchio has to tell of the state."""
    model, data = joints.model, joints.model.createData()
    # `computeAllTerms` has made both energies; before Pinocchio 3 nothing adds them up.
    mechanical_energy = getattr(pin, "computeMechanicalEnergy", lambda model, data: data.kinetic_energy + data.potential_energy)

    def told(q: Array, v: Array) -> tuple[Array, Array]:
        q, v = step(q, v)
        pin.computeAllTerms(model, data, q, v)
        mechanical_energy(model, data)
        return q, v

    return told
