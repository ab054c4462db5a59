"""Print how fast a block of 1 kg slips from two fingers that press it with 12 N each, in MuJoCo with steps of 2 ms."""

import mujoco
import numpy as np

FINGER = """<body pos="{} 0 0"><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="0.2" diaginertia="1e-4 1e-4 1e-4"/>
<geom name="{}" type="sphere" size="0.02"/></body>"""
PAIR = '<pair geom1="block" geom2="{}" condim="3" friction="0.5 0.5 0.005 0.0001 0.0001"/>'
MODEL = f"""<mujoco><option timestep="0.002" {{}}/><default><geom contype="0" conaffinity="0"/></default><worldbody>
<body><freejoint/><geom name="block" type="box" size="0.03 0.05 0.08" mass="1"/></body>
{FINGER.format(-0.05, "left")}{FINGER.format(0.05, "right")}</worldbody>
<contact>{PAIR.format("left")}{PAIR.format("right")}</contact></mujoco>"""

for name, chosen in {
    "pyramidal": "",
    "pyramidal_noslip": 'noslip_iterations="10"',
    "pyramidal_impratio_100": 'impratio="100"',
    "elliptic": 'cone="elliptic"',
    "elliptic_noslip": 'cone="elliptic" noslip_iterations="10"',
    "elliptic_impratio_100": 'cone="elliptic" impratio="100"',
}.items():
    model = mujoco.MjModel.from_xml_string(MODEL.format(chosen))
    data = mujoco.MjData(model)
    data.qfrc_applied[6:] = 12, -12
    heights = []
    for steps in (50, 100):  # from 0.1 s to 0.3 s, after the fingers have sunk into the contacts
        mujoco.mj_step(model, data, steps)
        heights.append(data.qpos[2])
    print(name, abs(np.subtract(*heights)) / 0.2)
