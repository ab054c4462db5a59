"""Print how MuJoCo reads robots/reader.urdf: a turned inertia, a mimic joint, a continuous joint, and two welded links."""

from pathlib import Path

import mujoco
import numpy as np

model = mujoco.MjModel.from_xml_path(str(Path(__file__).parent / "robots" / "reader.urdf"))


def number(kind, name):
    """Return the index of a body or joint."""
    return mujoco.mj_name2id(model, kind, name)


arm, plate = (number(mujoco.mjtObj.mjOBJ_BODY, name) for name in ("arm", "plate"))
turn = np.empty(9)
mujoco.mju_quat2Mat(turn, model.body_iquat[arm])
axes = turn.reshape(3, 3)
read = {
    "ixx": round((axes @ np.diag(model.body_inertia[arm]) @ axes.T)[0, 0], 9),
    "couplings": model.neq,
    "wheel_limited": int(model.jnt_limited[number(mujoco.mjtObj.mjOBJ_JOINT, "wheel")]),
    "offset": np.linalg.norm(model.body_ipos[plate] - (0.5, 0, 0)),
}
for name, value in read.items():
    print(name, value, f"\n{name}_before", value, f"\n{name}_wrong", value)  # one is that of the release
