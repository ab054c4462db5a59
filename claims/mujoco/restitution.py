"""Print which part of its speed a ball keeps when it falls by 1 m in MuJoCo, with a friction of 0.5 and of 1."""

import mujoco

MODEL = """<mujoco><option timestep="0.002"/><default><geom friction="{} 0.005 0.0001"/></default><worldbody>
<geom type="plane" size="0 0 1"/><body pos="0 0 1.1"><freejoint/><geom size="0.1" mass="1"/></body></worldbody></mujoco>"""
for name, friction in (("half", 0.5), ("one", 1.0)):
    data = mujoco.MjData(model := mujoco.MjModel.from_xml_string(MODEL.format(friction)))
    velocities = []
    for _ in range(350):
        mujoco.mj_step(model, data)
        velocities.append(data.qvel[2])
    print(name, -max(velocities) / min(velocities))
