"""Print the time and the name of the warning with which MuJoCo resets a brick that spins too fast, with steps of 2 ms."""

from pathlib import Path

import mujoco
import numpy as np

MODEL = """<mujoco><option integrator="{}" timestep="0.002" gravity="0 0 0"/><worldbody>
<body><freejoint/><geom type="box" size="0.1 0.3 0.2" mass="1"/></body></worldbody></mujoco>"""
WARNINGS = ("BADQPOS", "BADQVEL", "BADQACC")

Path("MUJOCO_LOG.TXT").unlink(missing_ok=True)
for integrator, spin in (("Euler", 300.0), ("Euler", 1e3), ("Euler", 1e4), ("RK4", 1e4)):
    model = mujoco.MjModel.from_xml_string(MODEL.format(integrator))
    data = mujoco.MjData(model)
    data.qvel[3:] = np.array([0.01, 0.0, 1.0]) * spin / np.hypot(0.01, 1.0)
    given: list[str] = []
    while not given:
        time = data.time
        mujoco.mj_step(model, data)  # prints a warning before it resets the state
        given = [name for name in WARNINGS if data.warning[getattr(mujoco.mjtWarning, f"mjWARN_{name}")].number]
    print(f"{integrator}_{spin:g} MuJoCo reset itself after {given[0]} at t = {time:g} s")
print("logged", sum("unstable" in line for line in Path("MUJOCO_LOG.TXT").read_text("utf-8").splitlines()))
