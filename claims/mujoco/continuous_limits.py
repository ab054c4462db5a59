"""Print whether MuJoCo limits the continuous joint of continuous_limits.urdf: 1 or 0."""

from pathlib import Path

import mujoco

model = mujoco.MjModel.from_xml_path(str(Path(__file__).with_suffix(".urdf")))
limited = int(model.jnt_limited[0])
print("before", limited, "\nsince", limited)  # one of both names is that of the release
