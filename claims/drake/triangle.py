"""Print the moments (kg m²) that Drake gives to a link whose stated moments no body can have, and those of a ball of water."""

from pathlib import Path

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

plant = MultibodyPlant(0.0)
Parser(plant).AddModels(str(Path(__file__).parents[1] / "robots" / "triangle.urdf"))
plant.Finalize()
inertia = plant.GetBodyByName("arm").default_spatial_inertia().Shift(np.array([0.1, 0.2, 0.3]))
print("moment", inertia.CalcRotationalInertia().get_moments()[0])
print("water", 0.4 * (3 / (4 * np.pi * 1000)) ** (2 / 3))
