"""Print how many constraints MuJoCo reads from a robot with one <mimic>."""

from pathlib import Path

import mujoco

model = mujoco.MjModel.from_xml_path(str(Path(__file__).parents[1] / "robots" / "mimic.urdf"))
print(f"ignored {model.neq}\nread {model.neq}")
