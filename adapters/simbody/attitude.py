"""The coordinates of Simbody's free joint: a quaternion or three angles, then the position of the centre of mass.

A state has seven coordinates in either case; with angles the last one is not used.
"""

import ctypes
from typing import Any

import numpy as np
import opensim

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.simbody.libraries import function
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.scene import Quaternion, State
from bodycheck.reference.trajectory import Array

#: The number of coordinates of a free joint.
COORDINATES = 7

#: C++ functions of Simbody, by their names in its libraries: `SimbodyMatterSubsystem::setUseEulerAngles(State&, bool) const`
#: and `System::realizeModel(State&) const`.
USE_ANGLES = ("libSimTKsimbody", "_ZNK5SimTK22SimbodyMatterSubsystem17setUseEulerAnglesERNS_5StateEb")
REALIZE = ("libSimTKcommon", "_ZNK5SimTK6System12realizeModelERNS_5StateE")


def use_quaternions(model: Any, state: Any) -> None:
    """Switch a state of a model, which OpenSim has just made, from angles to quaternions.

    Raises `SceneUnsupported` if the release of OpenSim lacks the function.
    """
    use_angles = function(*USE_ANGLES, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_bool))
    realize = function(*REALIZE, (ctypes.c_void_p, ctypes.c_void_p))
    if use_angles is None or realize is None:
        text = "quaternions: this release of OpenSim lacks Simbody's function that switches them on; settings=engine has angles"
        raise SceneUnsupported(text)
    use_angles(int(model.getMatterSubsystem().this), int(state.this), False)
    realize(int(model.getMultibodySystem()), int(state.this))


def angles(quaternion: Quaternion) -> list[float]:
    """Return the angles (rad) of rotations about the x, y and z axes of a body, in this order, that make up a quaternion."""
    turns = opensim.Rotation(opensim.Quaternion(*quaternion)).convertRotationToBodyFixedXYZ()
    return [turns.get(axis) for axis in range(3)]


def coordinates(initial: State, quaternions: bool) -> list[float]:
    """Return the seven coordinates of a state, with a quaternion or with angles."""
    if quaternions:
        return [*initial.quaternion, *initial.position]
    return [*angles(initial.quaternion), *initial.position, 0.0]


def poses(seen: Array, quaternions: bool) -> tuple[Array, Array]:
    """Return positions (n, 3) and quaternions (n, 4), of any norm, from coordinates (n, 7)."""
    if quaternions:
        return seen[:, 4:], seen[:, :4]
    turns = np.zeros((3, len(seen), 4))
    for axis in range(3):
        turns[axis, :, 0], turns[axis, :, 1 + axis] = np.cos(seen[:, axis] / 2), np.sin(seen[:, axis] / 2)
    about_x, about_y, about_z = turns
    return seen[:, 3:6], multiply(multiply(about_x, about_y), about_z)
