"""Take the steps of a model of Drake."""

import re
from collections.abc import Callable

from bodycheck.adapters.contract import EngineDiverged
from bodycheck.adapters.drake.models import Model

#: The kinetic energy (J) above which the next acceleration may overflow. Integrators that iterate end the process there.
LARGEST_ENERGY_J = 1e200


def stepper(model: Model, timestep: float) -> Callable[[int], int]:
    """Return a function that takes a time step of a model, and returns the number of steps taken from that before it.

    It raises `EngineDiverged`.
    """
    simulator, plant, context = model.simulator, model.plant, model.context

    def step(taken: int) -> int:
        if not plant.CalcKineticEnergy(context) < LARGEST_ENERGY_J:
            raise EngineDiverged(f"Drake's accelerations overflow at t = {context.get_time():.6g} s")
        try:
            simulator.AdvanceTo((taken + 1) * timestep)
        except RuntimeError as error:
            # Drake counts the sources of poses in a process.
            words = re.sub(r" with source id \d+", "", " ".join(str(error).split()))
            raise EngineDiverged(f"Drake at t = {context.get_time():.6g} s: {words}") from error
        return taken + 1

    return step
