"""Build worlds of Rapier and free bodies in them, and read their states."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import rapier3d

from bodycheck.adapters.contract import EngineReset, Method, SceneUnsupported, states
from bodycheck.adapters.touching import Coefficients
from bodycheck.reference.kinematics import conjugate, normalise, rotate
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Body, Brick, Cylinder, Quaternion, Shape, Sphere, State
from bodycheck.reference.trajectory import Array

#: The largest number in single precision, by which Rapier says that there is no limit.
NO_LIMIT = float(np.finfo(np.float32).max)


@dataclass(frozen=True, eq=False)
class World:
    """A world of Rapier, and Rapier's view of the body in this world."""

    world: rapier3d.PhysicsWorld
    body: rapier3d.RigidBody


def new_world(gravity: float, method: Method) -> rapier3d.PhysicsWorld:
    """Return an empty world with gravity (m/s^2) and the settings of a method."""
    world = rapier3d.PhysicsWorld(gravity=(0, 0, -gravity))
    world.integration_parameters.dt = method.timestep
    if method.option("settings") != "engine":
        switch_off(world.integration_parameters)
    if method.option("friction") == "coulomb":
        world.integration_parameters.friction_model = rapier3d.FrictionModel.COULOMB
    return world


def unlimited(body: rapier3d.RigidBodyBuilder, method: Method) -> rapier3d.RigidBodyBuilder:
    """Return the builder of a body without sleeping and rotation limit, unless a method keeps Rapier's settings."""
    return body if method.option("settings") == "engine" else body.can_sleep(False).allow_fast_rotation(True)


def switch_off(parameters: rapier3d.IntegrationParameters) -> None:
    """Switch off substeps, the speed limit and continuous collision detection; see the docstring of the package."""
    parameters.num_internal_pgs_iterations *= parameters.num_solver_iterations
    parameters.num_internal_stabilization_iterations *= parameters.num_solver_iterations
    parameters.num_solver_iterations = 1
    parameters.normalized_max_linear_velocity = NO_LIMIT
    parameters.max_ccd_substeps = 0


def add_plane(world: rapier3d.PhysicsWorld, incline: float, coefficients: Coefficients) -> Any:
    """Add a half-space whose face is turned about y by an incline (rad) to a world, and return the handle of its collider."""
    half_space = rapier3d.Collider.halfspace((math.sin(incline), 0, math.cos(incline)))
    return world.add_collider(with_coefficients(half_space, coefficients))


def with_coefficients(shape: rapier3d.ColliderBuilder, coefficients: Coefficients) -> rapier3d.ColliderBuilder:
    """Return the builder of a shape with coefficients of friction and restitution."""
    return shape.friction(coefficients.friction).restitution(coefficients.restitution)


def collider(shape: Shape, axes: Quaternion, coefficients: Coefficients) -> rapier3d.ColliderBuilder:
    """Return a massless shape in the frame of principal axes, whose attitude in the frame of the shape is `axes`.

    Raises `SceneUnsupported`.
    """
    turn = rapier3d.Rotation3(*axes).inverse()
    match shape:
        case Brick():
            of_shape = rapier3d.Collider.cuboid(*shape.semi_axes)
        case Cylinder():
            # The axis of Rapier's cylinders is y.
            of_shape = rapier3d.Collider.cylinder(shape.half_length, shape.radius)
            turn = turn * rapier3d.Rotation3.from_scaled_axis((math.pi / 2, 0, 0))
        case Sphere():
            of_shape = rapier3d.Collider.ball(shape.radius)
        case _:
            raise SceneUnsupported(f"{describe_shape(shape)}, which is none of Rapier's shapes")
    return with_coefficients(of_shape.rotation(turn.scaled_axis).density(0), coefficients)


def moving(body: Body, initial: State) -> rapier3d.RigidBodyBuilder:
    """Return the builder of a body without a shape, from the initial state of its principal axes."""
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity)).tolist()
    return (
        rapier3d.RigidBody.dynamic()
        .position(rapier3d.Isometry3(initial.position, rapier3d.Rotation3(*initial.quaternion)))
        .linvel(initial.velocity)
        .angvel(spin)
        .additional_mass_properties(rapier3d.MassProperties((0, 0, 0), body.mass, body.moments))
    )


def rows(seen: Array) -> Array:
    """Return the rows (n, 13) of states from rows (n, 13) of `seen`. Quaternions may have any norm, which they keep."""
    quaternion = seen[:, [6, 3, 4, 5]]
    return states(seen[:, :3], quaternion, seen[:, 7:10], rotate(conjugate(normalise(quaternion)), seen[:, 10:]))


def seen(world: World) -> Array:
    """Return position, quaternion x y z w, velocity and angular velocity (13,), all in the world frame."""
    body = world.body
    vectors = (body.translation, body.linvel, body.angvel)
    position, velocity, angular_velocity = (vector.to_tuple() for vector in vectors)
    return np.array([*position, *body.rotation.quaternion, *velocity, *angular_velocity])


def check(world: World) -> None:
    """Raise `EngineReset` if Rapier has taken the body out of the simulation."""
    if not world.body.is_enabled:
        raise EngineReset("Rapier quarantined the body, because its state is no longer finite, and put it back")
