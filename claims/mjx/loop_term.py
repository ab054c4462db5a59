"""Print what the loop of a slider crank asks for in MJX and in the MuJoCo beside it: the reference acceleration (m/s^2)."""

import jax
import mujoco
from mujoco import mjx

jax.config.update("jax_enable_x64", True)
MODEL = """<mujoco><worldbody><body><joint axis="0 -1 0"/><inertial pos="0.3 0 0" mass="1" diaginertia="0.001 0.03 0.03"/>
<body pos="0.6 0 0"><joint axis="0 -1 0"/><inertial pos="0.5 0 0" mass="0.8" diaginertia="0.001 0.07 0.07"/>
<site name="end" pos="1 0 0"/></body></body>
<body><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
<site name="pin"/></body></worldbody><equality><connect site1="end" site2="pin"/></equality></mujoco>"""

model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
data.qpos, data.qvel = (1.5707963267948966, -2.214297435588181, 0.8), (5, -5, -3)
mujoco.mj_forward(model, data)
print("mujoco", data.efc_aref[2], "\nmujoco_acceleration", data.qacc[0])  # 0.6 m (5 rad/s)^2 = 15 m/s^2 is the term dJ/dt v
start = mjx.make_data(model).replace(qpos=jax.numpy.array(data.qpos), qvel=jax.numpy.array(data.qvel))
data = jax.jit(mjx.forward)(mjx.put_model(model), start)
print("mjx", round(float(data._impl.efc_aref[2]), 9), "\nmjx_acceleration", float(data.qacc[0]))
