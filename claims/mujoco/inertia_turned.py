"""Print the moments about the axes of the link that MuJoCo reads for moments (1, 2, 2.5) kg m² whose axes are turned by 90°."""

from pathlib import Path

import mujoco
import numpy as np

model = mujoco.MjModel.from_xml_path(str(Path(__file__).parents[1] / "robots" / "turned.urdf"))
turn = np.zeros(9)
mujoco.mju_quat2Mat(turn, model.body_iquat[-1])
moments = np.diag(turn.reshape(3, 3) @ np.diag(model.body_inertia[-1]) @ turn.reshape(3, 3).T)
for kind in ("lost", "kept"):
    print(f"x_{kind} {moments[0]}\ny_{kind} {moments[1]}")
