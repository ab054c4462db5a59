"""Print by how much (m) the centre of mass of two links that are welded together is wrong when MuJoCo reads them."""

from pathlib import Path

import mujoco
import numpy as np

model = mujoco.MjModel.from_xml_path(str(Path(__file__).parents[1] / "robots" / "fused.urdf"))
arm, tool = np.array([0.1, 0.2, 0.3]), np.array([-0.2, 0.1 + 0.3, 0.3 + 0.5])  # the second link is turned by 90°
error = np.linalg.norm(model.body_ipos[-1] - (arm + tool) / 2)
print(f"wrong {error}\nright {error}")
