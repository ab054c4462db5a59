"""Print how far (m) a cube slides within a minute in MuJoCo, on a ramp at 0.99 of the slope that friction holds."""

import mujoco
import numpy as np

SLOPE = np.arctan(0.99 * 0.5)
MODEL = """<mujoco><option gravity="{} 0 {}" {}/><default><geom friction="0.5 0.005 0.0001"/></default><worldbody>
<geom type="plane" size="0 0 1"/><body pos="0 0 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1" mass="1"/></body>
</worldbody></mujoco>"""
OPTIONS = {
    "default": "",
    "elliptic": 'cone="elliptic"',
    "noslip": 'cone="elliptic" noslip_iterations="10"',
    "impratio10": 'cone="elliptic" impratio="10"',
    "impratio100": 'cone="elliptic" impratio="100"',
}
for name, options in OPTIONS.items():
    model = mujoco.MjModel.from_xml_string(MODEL.format(9.81 * np.sin(SLOPE), -9.81 * np.cos(SLOPE), options))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 30000)
    print(name, np.linalg.norm(data.qpos[:2]))
