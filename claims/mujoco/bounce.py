"""Print which part of its velocity a ball keeps in MuJoCo after a fall of 1 m, for coefficients of friction 0, 0.5 and 1."""

import mujoco

MODEL = """<mujoco><option timestep="0.002"/><default><geom friction="{} 0.005 0.0001"/></default><worldbody>
<geom type="plane" size="0 0 1"/><body pos="0 0 1.1"><freejoint/><geom type="sphere" size="0.1" mass="1"/></body>
</worldbody></mujoco>"""

for name, friction in (("no_friction", 0.0), ("half", 0.5), ("one", 1.0)):
    model = mujoco.MjModel.from_xml_string(MODEL.format(friction))
    data = mujoco.MjData(model)
    speeds = []
    for _ in range(350):
        mujoco.mj_step(model, data)
        speeds.append(data.qvel[2])
    print(name, -max(speeds) / min(speeds))
