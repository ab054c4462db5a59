"""Print how far a block creeps in a minute on a slope of 0.99 of its friction in MuJoCo, with steps of 2 ms."""

import math

import mujoco
import numpy as np

ANGLE = math.atan(0.99 * 0.5)
TURN = f"{math.cos(ANGLE / 2)} 0 {math.sin(ANGLE / 2)} 0"
MODEL = f"""<mujoco><option timestep="0.002" {{}}/><default><geom friction="0.5 0.005 0.0001"/></default><worldbody>
<geom type="plane" size="0 0 1" quat="{TURN}"/>
<body pos="{0.1 * math.sin(ANGLE)} 0 {0.1 * math.cos(ANGLE)}" quat="{TURN}"><freejoint/>
<geom type="box" size="0.1 0.1 0.1" mass="1"/></body></worldbody></mujoco>"""

for name, chosen in {
    "pyramidal": "",
    "pyramidal_noslip": 'noslip_iterations="10"',
    "elliptic": 'cone="elliptic"',
    "elliptic_noslip": 'cone="elliptic" noslip_iterations="10"',
    "impratio_10": 'cone="elliptic" impratio="10"',
    "impratio_100": 'cone="elliptic" impratio="100"',
}.items():
    model = mujoco.MjModel.from_xml_string(MODEL.format(chosen))
    data = mujoco.MjData(model)
    start = data.qpos[:3].copy()
    mujoco.mj_step(model, data, 30000)
    print(name, np.linalg.norm(data.qpos[:3] - start) / 60, "\n" + name + "_way", np.linalg.norm(data.qpos[:3] - start))
