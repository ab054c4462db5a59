"""The first contact that MuJoCo's collision detection finds along a given motion of a robot model.

Contacts are those of the file: its shapes, margins aside, its contact pairs and exclusions, and MuJoCo's own rule that a body
does not touch its parent. A shape of a mesh is its convex hull.
"""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from bodycheck.adapters.mujoco.robot_joints import body_name, columns, joints_of
from bodycheck.adapters.mujoco.robots import loaded
from bodycheck.adapters.mujoco.stepping import quiet
from bodycheck.adapters.robot_numbers import values_of
from bodycheck.adapters.robot_reading import ModelRefused, RobotFile, Touch
from bodycheck.reference.robots.state import COORDINATES, RobotState
from bodycheck.reference.trajectory import Array

#: The largest distance (m) between a centre of mass of MuJoCo's model and that of the motion.
ROUNDING_M = 1e-6


def first_touch(file: RobotFile, states: Sequence[RobotState], centres: Mapping[str, Array]) -> Touch | None:
    """Return the first contact in states of a robot; None if nothing touches in any of them.

    Parameters
    ----------
    file
        The file.
    states
        n states; joints that they do not have keep MuJoCo's default positions. A free joint has the position and the attitude
        of its child in the world.
    centres
        The centres of mass (n, 3) of bodies in these states, by their names (m, world).

    Raises
    ------
    ModelRefused
        MuJoCo refuses the file, or has a body elsewhere than the motion.
    """
    model = loaded(file.path)
    data = mujoco.MjData(model)
    with quiet():
        positions, *_ = columns(model, file.format, states)
        free = [joint for joint in joints_of(model, file.format) if joint.type == "floating"]
        for index, qpos in enumerate(positions):
            data.qpos[:] = qpos
            for joint in free:
                if (pose := values_of(states[index].positions, joint.name, COORDINATES["floating"])) is not None:
                    data.qpos[joint.qpos : joint.qpos + len(pose)] = pose
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            _check(model, data, {name: centre[index] for name, centre in centres.items()})
            mujoco.mj_collision(model, data)
            touching = [contact.geom for contact in data.contact[: data.ncon] if contact.dist <= 0]
            if touching:
                pairs = [(_place(model, int(one)), _place(model, int(other))) for one, other in touching]
                return Touch(index, tuple(dict.fromkeys(pairs)))
    return None


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
