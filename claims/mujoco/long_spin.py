"""Print when MuJoCo resets a brick that spins at 10 rad/s, with default settings, and its energy over the initial energy."""

import mujoco
import numpy as np

MODEL = """<mujoco><option gravity="0 0 0"/><worldbody><body><freejoint/>
<geom type="box" size="0.1 0.3 0.2" mass="1"/></body></worldbody></mujoco>"""
model = mujoco.MjModel.from_xml_string(MODEL)
data, moments, warnings = mujoco.MjData(model), np.array([13, 5, 10]) / 300, mujoco.mjtWarning
data.qvel[3:] = 0.1, 0, 10
first = moments @ data.qvel[3:] ** 2
for step in range(1, 1000001):
    before = data.time
    mujoco.mj_step(model, data)
    if step in (1000, 10000, 100000):
        print(f"energy_{step}", moments @ data.qvel[3:] ** 2 / first)
    if data.warning[warnings.mjWARN_BADQACC].number or data.warning[warnings.mjWARN_BADQVEL].number:
        print("reset", before, "\nwarning", "BADQACC" if data.warning[warnings.mjWARN_BADQACC].number else "BADQVEL")
        break
