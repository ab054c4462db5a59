"""Print how far a joint of MuJoCo is from the rule by which it follows another, under a load, at two time steps."""

import mujoco

MODEL = """<mujoco><option timestep="{0}" integrator="RK4"/><worldbody>
<body><joint name="leader" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="0.02 0.025 0.03"/></body>
<body><joint name="follower" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="0.02 0.025 0.03"/></body></worldbody>
<equality><joint joint1="follower" joint2="leader" polycoef="0 2 0 0 0"/></equality></mujoco>"""
for name, step in (("coarse", 0.002), ("fine", 0.0005)):
    model = mujoco.MjModel.from_xml_string(MODEL.format(step))
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 0.3
    mujoco.mj_step(model, data, round(0.5 / step))
    print(name, abs(data.qpos[1] - 2 * data.qpos[0]))
