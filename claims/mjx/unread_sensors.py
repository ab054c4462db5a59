"""The size of an accelerometer's reading on a falling pendulum, in MuJoCo and in MJX, without and with a limit of its hinge."""

import jax
import mujoco
import numpy as np
from mujoco import mjx

jax.config.update("jax_enable_x64", True)
MODEL = """<mujoco><worldbody><body><joint axis="0 1 0" damping="0.1" {}/>
<inertial pos="0 0 -0.5" mass="1" diaginertia="0.01 0.01 0.01"/><site name="imu" pos="0.1 0.05 -0.3"/></body></worldbody>
<sensor><accelerometer site="imu"/><gyro site="imu"/></sensor></mujoco>"""

for name, limit in (("free", ""), ("limited", 'limited="true" range="-90 90"')):
    model = mujoco.MjModel.from_xml_string(MODEL.format(limit))
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = 1.0, 2.0
    mujoco.mj_forward(model, data)
    start = mjx.make_data(model).replace(qpos=jax.numpy.array(data.qpos), qvel=jax.numpy.array(data.qvel))
    computed = jax.jit(mjx.forward)(mjx.put_model(model), start)
    for engine, readings in (("mujoco", data.sensordata), ("mjx", np.array(computed.sensordata))):
        print(f"{engine}_{name} {np.linalg.norm(readings[:3]):.6g}")
        print(f"{engine}_{name}_gyro {np.linalg.norm(readings[3:]):.6g}")
