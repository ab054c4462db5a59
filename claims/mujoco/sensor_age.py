"""The relative distance of MuJoCo's accelerometer after mj_step from that of mj_forward at the states before and after it."""

import mujoco
import numpy as np

MODEL = """<mujoco><option timestep="0.002"/><worldbody><body><joint axis="0 1 0"/><inertial pos="0 0 -0.5" mass="1"
diaginertia="0.01 0.01 0.01"/><site name="imu" pos="0.1 0.05 -0.3"/></body></worldbody>
<sensor><accelerometer site="imu"/></sensor></mujoco>"""
model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
data.qpos[0], data.qvel[0] = 1.0, 2.0
print(f"reset {np.linalg.norm(data.sensordata):.3g}")
mujoco.mj_forward(model, data)
before = data.sensordata.copy()
mujoco.mj_step(model, data)
stepped = data.sensordata.copy()
mujoco.mj_forward(model, data)
for name, reading in (("before", before), ("after", data.sensordata)):
    print(f"{name} {np.linalg.norm(stepped - reading) / np.linalg.norm(reading):.3g}")
