"""Build physics servers of PyBullet and free bodies in them, and read their states."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pybullet

from bodycheck.adapters.contract import Method, SceneUnsupported, states
from bodycheck.adapters.pybullet.links import BASE
from bodycheck.adapters.pybullet.mechanisms import switched_off
from bodycheck.adapters.touching import Coefficients
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Quaternion, Shape, Sphere, State
from bodycheck.reference.trajectory import Array

#: Half the length of the ground (m), which is much longer than any slide, and half its height (m).
GROUND_HALF_LENGTH_M, GROUND_HALF_HEIGHT_M = 1e4, 1.0


@dataclass(frozen=True, eq=False)
class World:
    """A physics server and the body in it; the server ends with this object.

    Parameters
    ----------
    client
        The number of the connection to the server.
    body
        The number of the body.
    """

    client: int
    body: int


def connected(gravity: float, method: Method) -> int:
    """Return the connection to a new physics server with gravity (m/s^2). Raises `SceneUnsupported`."""
    client: int = pybullet.connect(pybullet.DIRECT)
    if client < 0:
        raise SceneUnsupported("PyBullet starts no further physics server in this process")
    pybullet.setTimeStep(method.timestep, physicsClientId=client)
    pybullet.setGravity(0, 0, -gravity, physicsClientId=client)
    return client


def add_ground(client: int, maximal: bool, plane: Plane, coefficients: Coefficients) -> int:
    """Add a box whose upper face is the plane, with its own coefficients, and return its number."""
    size = (GROUND_HALF_LENGTH_M, GROUND_HALF_LENGTH_M, GROUND_HALF_HEIGHT_M)
    shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=size, physicsClientId=client)
    turn = (0, math.sin(plane.incline / 2), 0, math.cos(plane.incline / 2))
    centre = (-GROUND_HALF_HEIGHT_M * math.sin(plane.incline), 0, -GROUND_HALF_HEIGHT_M * math.cos(plane.incline))
    ground: int = pybullet.createMultiBody(
        0, shape, basePosition=centre, baseOrientation=turn, useMaximalCoordinates=maximal, physicsClientId=client
    )
    pybullet.changeDynamics(ground, BASE, physicsClientId=client, **named(coefficients))
    return ground


def named(coefficients: Coefficients) -> dict[str, float]:
    """Return the arguments of `changeDynamics` that set the coefficients of a body."""
    return {"lateralFriction": coefficients.friction, "restitution": coefficients.restitution}


def collision_shape(shape: Shape, axes: Quaternion) -> dict[str, object]:
    """Return the arguments of `createCollisionShape` for a shape in the frame of principal axes. Raises `SceneUnsupported`.

    axes: the attitude of the principal axes in the frame of the shape.
    """
    w, x, y, z = axes
    turned = {"collisionFrameOrientation": (-x, -y, -z, w)}
    match shape:
        case Brick():
            return {"shapeType": pybullet.GEOM_BOX, "halfExtents": shape.semi_axes, **turned}
        case Cylinder():
            height = 2 * shape.half_length
            return {"shapeType": pybullet.GEOM_CYLINDER, "radius": shape.radius, "height": height, **turned}
        case Sphere():
            return {"shapeType": pybullet.GEOM_SPHERE, "radius": shape.radius}
    raise SceneUnsupported(f"{describe_shape(shape)}, which is none of Bullet's shapes")


def set_properties(world: World, body: Body, arguments: Mapping[str, float], method: Method) -> None:
    """Set the inertia of a body and further `arguments` of `changeDynamics`.

    Damping and limits are switched off unless the method keeps them.
    """
    pybullet.changeDynamics(
        world.body,
        BASE,
        mass=body.mass,
        localInertiaDiagonal=body.moments,
        physicsClientId=world.client,
        **switched_off(method),
        **arguments,
    )


def set_state(world: World, initial: State) -> None:
    """Set the pose and the velocities of Bullet's frame of a body. The pose is set first, because this stops all motion."""
    w, x, y, z = initial.quaternion
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity)).tolist()
    pybullet.resetBasePositionAndOrientation(world.body, initial.position, (x, y, z, w), physicsClientId=world.client)
    pybullet.resetBaseVelocity(world.body, initial.velocity, spin, physicsClientId=world.client)


def seen(world: World) -> Array:
    """Return position, quaternion x y z w, velocity and angular velocity (13,), all in the world frame."""
    position, quaternion = pybullet.getBasePositionAndOrientation(world.body, physicsClientId=world.client)
    velocity, angular_velocity = pybullet.getBaseVelocity(world.body, physicsClientId=world.client)
    return np.array([*position, *quaternion, *velocity, *angular_velocity])


def rows(seen: Array) -> Array:
    """Return the rows (n, 13) of states of Bullet's frame of a body, from rows (n, 13) of `seen`."""
    quaternion = seen[:, [6, 3, 4, 5]]
    return states(seen[:, :3], quaternion, seen[:, 7:10], rotate(conjugate(quaternion), seen[:, 10:]))
