"""Read MuJoCo Warp's sensors, in a simulation of their own. The sensors in the XML are those of the adapter of MuJoCo.

`mjw.step` computes sensors with the accelerations at the start of the step, and then moves on, as MuJoCo does. `mjw.forward`
computes them for the present state.
"""

from collections.abc import Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np

from bodycheck.adapters.contract import Method, SensingSimulation, Simulation
from bodycheck.adapters.mujoco_warp import graphs
from bodycheck.reference.sensors.sensor import Sensor, split
from bodycheck.reference.trajectory import Array


def reading(simulation: Simulation, model: Any, data: Any, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return a simulation and the function that reads its sensors, which are the only ones of its model."""
    data.sensordata.zero_()  # as after a reset, and not MuJoCo's own readings, which its data have at the start
    values = data.sensordata.numpy()  # a view of the array that is stepped
    forward = graphs.record(lambda: mjw.forward(model, data)) if method.option("sensors") == "forward" else None

    def read() -> tuple[Array, ...]:
        if forward is not None:
            graphs.replay(forward)
        return split(sensors, values[0].astype(np.float64))

    return SensingSimulation(simulation, read)
