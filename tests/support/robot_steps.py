"""States of a robot model a short time later, for central differences in the 80-bit type."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from bodycheck.reference.kinematics import about, multiply
from bodycheck.reference.robots.dynamics import velocity_labels
from bodycheck.reference.robots.model import RobotModel, Wide
from bodycheck.reference.robots.state import RobotState, Values


def array(model: RobotModel, values: Values) -> Wide:
    """Velocities, accelerations or efforts as an array, in the order of the file."""
    return np.array([values[name][part] for name, part in velocity_labels(model)], np.longdouble)


def by_name(model: RobotModel, values: Wide) -> Values:
    """The same by the names of joints. The numbers keep the 80-bit type."""
    found: dict[str, Any] = {}
    for (name, _), value in zip(velocity_labels(model), values, strict=True):
        found[name] = (*found.get(name, ()), value)
    return found


def later(model: RobotModel, state: RobotState, time: float, rates: Wide, changes: Wide) -> RobotState:
    """The state after a time (s), up to its square, from velocities and their derivatives (k,) in the order of the file."""
    wide_time = np.longdouble(time)
    mean = by_name(model, rates * wide_time + changes * wide_time**2 / 2)
    types: Mapping[str, str] = {joint.name: joint.type for joint in model.joints}
    positions = {name: _moved(types[name], position, mean[name]) for name, position in state.positions.items()}
    return replace(state, positions=positions, velocities=by_name(model, rates + changes * wide_time))


def _moved(type: str, position: tuple[float, ...], step: tuple[float, ...]) -> Any:
    if type not in ("spherical", "floating"):
        return tuple(np.add(position, step))
    turned = np.array(step[-3:])
    angle = np.sqrt((turned**2).sum())
    turn = about(turned / angle, angle[None]) if angle else np.array([[1, 0, 0, 0]], np.longdouble)
    quaternion = multiply(np.array([position[-4:]], np.longdouble), turn)[0]
    return (*np.add(position[:-4], step[:-3]), *quaternion)
