"""Print the force of friction on a box that slides at 45 degrees to the axes of the world over Coulomb's, in MuJoCo."""

import mujoco
import numpy as np

MODEL = """<mujoco><option timestep="0.002" cone="{}"/><worldbody><geom type="plane" size="0 0 1" friction="0.5"/>
<body pos="0 0 0.05"><freejoint/><geom type="box" size="0.2 0.2 0.05" mass="1" friction="0.5"/></body></worldbody></mujoco>"""

for cone in ("pyramidal", "elliptic"):
    model = mujoco.MjModel.from_xml_string(MODEL.format(cone))
    for name, angle in (("along", 0), ("thirty", 30), ("diagonal", 45)):
        data, along = mujoco.MjData(model), np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0])
        data.qvel[:3] = 2 * along
        for _ in range(30):
            mujoco.mj_step(model, data)
        change = data.qvel[:3] - 2 * along
        print(f"{name}_{cone}", -change @ along / (0.5 * (9.81 * 0.06 + change[2])))
