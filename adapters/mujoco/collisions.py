"""The first contact that MuJoCo's collision detection finds along a given motion of a robot model.

Contacts are those of the file: its shapes, margins aside, its contact pairs and exclusions, and MuJoCo's own rule that a body
does not touch its parent. A shape of a mesh is its convex hull.
"""

from collections.abc import Collection, Mapping, Sequence

import mujoco
import numpy as np

from bodycheck.adapters.mujoco.robot_joints import body_name, columns, joints_of
from bodycheck.adapters.mujoco.robots import loaded
from bodycheck.adapters.mujoco.stepping import quiet
from bodycheck.adapters.robot_numbers import values_of
from bodycheck.adapters.robot_reading import ModelRefused, RobotFile, Touch, Touches
from bodycheck.reference.robots.state import COORDINATES, RobotState
from bodycheck.reference.trajectory import Array

#: The largest distance (m) between a centre of mass of MuJoCo's model and that of the motion.
ROUNDING_M = 1e-6


def touches(file: RobotFile, states: Sequence[RobotState], centres: Mapping[str, Array], absent: Mapping[str, str]) -> Touches:
    """Return the first contact in states of a robot, and the shapes that were left out.

    Parameters
    ----------
    file
        The file.
    states
        n states; joints that they do not have keep MuJoCo's default positions. A free joint has the position and the attitude
        of its child in the world.
    centres
        The centres of mass (n, 3) of bodies in these states, by their names (m, world).
    absent
        The names of meshes in the file that stand in for others, each with the reason. Shapes of these meshes are left out.

    Raises
    ------
    ModelRefused
        MuJoCo refuses the file, or has a body elsewhere than the motion.
    """
    model = loaded(file.path)
    left_out = {geom: mesh for geom in range(model.ngeom) if (mesh := _mesh(model, geom)) in absent}
    unseen = {_place(model, geom): absent[mesh] for geom, mesh in left_out.items() if _may_touch(model, geom)}
    return Touches(_first(model, file.format, states, centres, left_out), unseen)


def _first(
    model: mujoco.MjModel, format: str, states: Sequence[RobotState], centres: Mapping[str, Array], left_out: Collection[int]
) -> Touch | None:
    """Return the first contact in states of a robot; None if nothing touches in any of them. left_out: shapes, by index."""
    data = mujoco.MjData(model)
    with quiet():
        positions, *_ = columns(model, format, states)
        free = [joint for joint in joints_of(model, format) if joint.type == "floating"]
        for index, qpos in enumerate(positions):
            data.qpos[:] = qpos
            for joint in free:
                if (pose := values_of(states[index].positions, joint.name, COORDINATES["floating"])) is not None:
                    data.qpos[joint.qpos : joint.qpos + len(pose)] = pose
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            _check(model, data, {name: centre[index] for name, centre in centres.items()})
            mujoco.mj_collision(model, data)
            touching = [
                contact.geom
                for contact in data.contact[: data.ncon]
                if contact.dist <= 0 and not any(int(geom) in left_out for geom in contact.geom)
            ]
            if touching:
                pairs = [(_place(model, int(one)), _place(model, int(other))) for one, other in touching]
                return Touch(index, tuple(dict.fromkeys(pairs)))
    return None


def _mesh(model: mujoco.MjModel, geom: int) -> str:
    """Return the name of the mesh of a shape; empty if it is of another type."""
    is_mesh = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH
    return str(model.mesh(int(model.geom_dataid[geom])).name) if is_mesh else ""


def _may_touch(model: mujoco.MjModel, geom: int) -> bool:
    of_pairs = geom in model.pair_geom1 or geom in model.pair_geom2
    return bool(model.geom_contype[geom] or model.geom_conaffinity[geom] or of_pairs)


def _check(model: mujoco.MjModel, data: mujoco.MjData, centres: Mapping[str, Array]) -> None:
    """Raise `ModelRefused` if a body is not where the motion has it: then the motion is not one of this model."""
    for body in range(1, model.nbody):
        name = body_name(model, body)
        if name in centres and not np.abs(data.xipos[body] - centres[name]).max() <= ROUNDING_M:
            raise ModelRefused(f"MuJoCo has the centre of mass of {name} elsewhere")


def _place(model: mujoco.MjModel, geom: int) -> str:
    """Return the name of the body of a shape; in the world, that of the shape."""
    body = int(model.geom_bodyid[geom])
    return body_name(model, body) if body else str(model.geom(geom).name) or "the world"
