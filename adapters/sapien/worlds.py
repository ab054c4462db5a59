"""Build scenes of SAPIEN and free bodies in them, and read their states."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import sapien
from sapien import physx

from bodycheck.adapters.contract import Method, SceneUnsupported, states
from bodycheck.adapters.sapien.links import place, switch_off
from bodycheck.adapters.touching import Coefficients
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Body, Brick, Cylinder, Quaternion, Shape, Sphere, State
from bodycheck.reference.trajectory import Array

#: The rotation that turns the x axis, which is the normal of PhysX's planes and the axis of its cylinders, to the z axis.
X_TO_Z = (math.sqrt(0.5), 0.0, -math.sqrt(0.5), 0.0)


@dataclass(frozen=True, eq=False)
class World:
    """A scene of SAPIEN, the PhysX scene in it, and its body, which is the component of an entity."""

    scene: sapien.Scene
    system: physx.PhysxCpuSystem
    entity: sapien.Entity
    body: physx.PhysxRigidDynamicComponent


def new_system(gravity: float, method: Method) -> Any:
    """Return a PhysX scene with gravity (m/s^2). SAPIEN's settings of new scenes are global, and are restored afterwards."""
    former = physx.get_scene_config()
    config = physx.PhysxSceneConfig()
    config.gravity = np.array([0, 0, -gravity])
    config.enable_tgs = method.integrator == "TGS"
    if (threshold := method.option("bounce_threshold")) is not None:
        config.bounce_threshold = float(threshold)
    physx.set_scene_config(config)
    try:
        system = physx.PhysxCpuSystem()
    finally:
        physx.set_scene_config(former)
    system.set_timestep(method.timestep)
    return system


def add_plane(whole: Any, incline: float, coefficients: Coefficients) -> Any:
    """Add a plane through the origin that is turned about y by an incline (rad) to a scene, and return its component."""
    ground = physx.PhysxRigidStaticComponent()
    ground.attach(physx.PhysxCollisionShapePlane(material(coefficients)))
    entity = sapien.Entity()
    entity.add_component(ground)
    turn = np.array([math.cos(incline / 2), 0.0, math.sin(incline / 2), 0.0])
    entity.set_pose(sapien.Pose((0, 0, 0), multiply(turn, np.array(X_TO_Z))))
    whole.add_entity(entity)
    return ground


def collision_shape(shape: Shape, axes: Quaternion, coefficients: Coefficients) -> Any:
    """Return a shape in the frame of principal axes, whose attitude in the frame of the shape is `axes`.

    Raises `SceneUnsupported`.
    """
    turn, surface = conjugate(np.array(axes)), material(coefficients)
    match shape:
        case Brick():
            of_shape = physx.PhysxCollisionShapeBox(shape.semi_axes, surface)
        case Cylinder():
            of_shape = physx.PhysxCollisionShapeCylinder(shape.radius, shape.half_length, surface)
            turn = multiply(turn, np.array(X_TO_Z))
        case Sphere():
            of_shape = physx.PhysxCollisionShapeSphere(shape.radius, surface)
        case _:
            raise SceneUnsupported(f"{describe_shape(shape)}, which is none of SAPIEN's shapes")
    of_shape.set_local_pose(sapien.Pose((0, 0, 0), turn))
    return of_shape


def material(coefficients: Coefficients) -> Any:
    """Return a material with the same coefficient of friction for bodies that stick and bodies that slide."""
    return physx.PhysxMaterial(coefficients.friction, coefficients.friction, coefficients.restitution)


def moving(whole: Any, given: Body, initial: State, shape: Any, method: Method) -> tuple[Any, Any]:
    """Add a body to a scene of SAPIEN, from the initial state of its principal axes, and return its entity and its component.

    shape: the shape of the body; None if it touches nothing.
    """
    body = physx.PhysxRigidDynamicComponent()
    if shape is not None:
        body.attach(shape)
    body.set_mass(given.mass)
    body.set_cmass_local_pose(sapien.Pose())
    body.set_inertia(np.array(given.moments))
    entity = sapien.Entity()
    entity.add_component(body)
    whole.add_entity(entity)
    if method.option("settings") != "engine":
        switch_off(entity)
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity))
    place(entity, sapien.Pose(initial.position, initial.quaternion), initial.velocity, spin)
    return entity, body


def rows(seen: Array) -> Array:
    """Return the rows (n, 13) of states from rows (n, 13) of `seen`. Quaternions may have any norm, which they keep."""
    spin = rotate(conjugate(normalise(seen[:, 3:7])), seen[:, 10:])
    return states(seen[:, :3], seen[:, 3:7], seen[:, 7:10], spin)


def seen(world: World) -> Array:
    """Return position, quaternion w x y z, velocity and angular velocity (13,), all in the world frame."""
    pose, body = world.entity.pose, world.body
    return np.concatenate([pose.p, pose.q, body.linear_velocity, body.angular_velocity], dtype=np.float64)
