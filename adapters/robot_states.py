"""States of robots for engines that ignore where a floating joint is."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bodycheck.adapters.robot_files import Place
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.robots.state import RobotState, Values


def on_root(state: RobotState, places: Mapping[str, Place]) -> RobotState:
    """Return a state in which floating joints have their coordinates in the frame of the root.

    The angular velocities remain those along the axes of the child.

    Parameters
    ----------
    state
        The state.
    places
        The places of floating joints in the frame of the root, by the names of the joints.
    """
    positions = dict(state.positions)
    for name, (origin, turn) in places.items():
        if name in positions:
            held = np.array(positions[name])
            positions[name] = (*(origin + rotate(turn, held[:3])).tolist(), *multiply(turn, held[3:]).tolist())

    def along_root(values: Values) -> Values:
        made = dict(values)
        for name, (_, turn) in places.items():
            if name in made:
                made[name] = (*rotate(turn, np.array(made[name][:3])).tolist(), *made[name][3:])
        return made

    moved = (along_root(values) for values in (state.velocities, state.accelerations, state.efforts))
    return replace(state, positions=positions, **dict(zip(("velocities", "accelerations", "efforts"), moved, strict=True)))
