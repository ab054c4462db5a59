"""Drive the joints of an OpenSim model by actuators whose efforts are set, and stop them by OpenSim's elastic limits.

An effort is the overriding value of a `CoordinateActuator`, which is a part of the state: the manager begins anew at the state
with the new effort. A limit is a `CoordinateLimitForce`, whose stiffness begins within the smallest transition, and whose
damper also pulls a joint that returns; a stop of a case never pulls.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import opensim

from bodycheck.adapters.contract import Method
from bodycheck.adapters.mechanisms import bounds, stops_of
from bodycheck.reference.mechanisms.mechanism import Joint
from bodycheck.reference.trajectory import Array

#: A coordinate (rad or m) that no joint reaches, for the side on which a joint has no stop.
FAR = 1e6

#: The way (m or degrees) on which the stiffness of a limit begins.
TRANSITION = 1e-6


def add_actuator(model: Any, coordinate: Any) -> Any:
    """Add an actuator of a coordinate to a model, and return it."""
    actuator = opensim.CoordinateActuator(coordinate.getName())
    actuator.setName(f"actuator_{coordinate.getName()}")
    actuator.setOptimalForce(1.0)
    model.addForce(actuator)
    return actuator


def add_stops(model: Any, joint: Joint, engine_joint: Any, method: Method) -> None:
    """Add the stops of a joint to a model. OpenSim's numbers of an angle are in degrees."""
    stops = stops_of(joint, method)
    if stops is None:
        return
    degree = math.pi / 180 if joint.type == "revolute" else 1.0
    lower, upper = bounds(stops, FAR)
    stiffness = stops.stiffness * degree
    limit = opensim.CoordinateLimitForce(
        engine_joint.get_coordinates(0).getName(),
        *(upper / degree, stiffness, lower / degree, stiffness, stops.damping * degree, TRANSITION),
    )
    limit.setName(f"stops_{joint.child}")
    model.addForce(limit)


def overridden(first: Any, state: Any, actuators: Sequence[Any], efforts: Array) -> Any:
    """Return a copy of a state in which actuators exert efforts.

    first: a state of the model of which no poses were computed. OpenSim keeps poses in a state and tells by the number of its
    changes whether they are valid; in a copy, which counts anew, those of another time would become valid again.
    """
    copy = opensim.State(first)
    copy.setTime(state.getTime())
    copy.setY(state.getY())
    for actuator, effort in zip(actuators, efforts.tolist(), strict=True):
        actuator.overrideActuation(copy, True)
        actuator.setOverrideActuation(copy, effort)
    return copy


def motion(state: Any, coordinates: Sequence[Any]) -> tuple[Array, Array]:
    """Return the values and speeds (j,) of coordinates in a state."""
    values = [(coordinate.getValue(state), coordinate.getSpeedValue(state)) for coordinate in coordinates]
    position, velocity = np.array(values).T
    return position, velocity
