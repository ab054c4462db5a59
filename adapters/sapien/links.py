"""Load links into SAPIEN from a URDF file, from which SAPIEN reads inertia tensors, and set their state.

A single link is an entity with a rigid body, as in other scenes. Several links are an articulation of PhysX, in reduced
coordinates, with fixed joints. SAPIEN diagonalises the tensors.
"""

from collections.abc import Sequence
from typing import Any

from sapien import Pose, Scene, physx

from bodycheck.adapters.links import Link, file_of, urdf

#: The limit of speed that means no limit: PhysX's default for the velocity, whose square PhysX computes in single precision.
NO_LIMIT = 1e16


def load(scene: "Scene", links: Sequence[Link]) -> Any:
    """Load links into a scene of SAPIEN, and return the entity of a single link, or the articulation of several links."""
    loader = scene.create_urdf_loader()
    loader.fix_root_link = False
    with file_of(urdf(links)) as file:
        articulations, entities = loader.load_multiple(file)
    return (articulations or entities)[0]


def first_link(loaded: Any) -> Any:
    """Return the component of the first link, which is a rigid body."""
    if isinstance(loaded, physx.PhysxArticulation):
        return loaded.root
    return loaded.find_component_by_type(physx.PhysxRigidDynamicComponent)


def switch_off(loaded: Any) -> None:
    """Switch off the damping, the limits and the sleep of an entity with a body, or of an articulation.

    Only an articulation has linear damping and a limit of speed.
    """
    articulated = isinstance(loaded, physx.PhysxArticulation)
    sleeper = loaded if articulated else first_link(loaded)
    sleeper.set_sleep_threshold(0.0)
    for link in loaded.links if articulated else [sleeper]:
        link.set_angular_damping(0.0)
        link.set_max_angular_velocity(NO_LIMIT)
        if articulated:
            link.set_linear_damping(0.0)
            link.set_max_linear_velocity(NO_LIMIT)


def place(loaded: Any, pose: "Pose", velocity: Any, spin: Any) -> None:
    """Set the pose of the first link's frame, and the velocity of its centre of mass and its angular velocity (world frame)."""
    if isinstance(loaded, physx.PhysxArticulation):
        loaded.set_root_pose(pose)
        loaded.set_root_linear_velocity(velocity)
        loaded.set_root_angular_velocity(spin)
        return
    loaded.set_pose(pose)
    body = first_link(loaded)
    body.set_linear_velocity(velocity)
    body.set_angular_velocity(spin)
