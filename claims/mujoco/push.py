"""Print the least push at 60 degrees to an edge with which a box slides in MuJoCo, relative to friction times weight."""

import math

import mujoco
import numpy as np

MODEL = """<mujoco><option cone="{}"/><default><geom friction="0.5 0.005 0.0001"/></default><worldbody>
<geom type="plane" size="0 0 1"/><body pos="0 0 0.02"><freejoint/><geom type="box" size="0.1 0.1 0.02" mass="1"/></body>
</worldbody></mujoco>"""


def slides(cone, push):
    """Return whether the box gains speed from 4 s to 5 s under a push, given relative to friction times weight."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(cone))
    data = mujoco.MjData(model)
    data.xfrc_applied[1, :2] = np.array([math.cos(math.pi / 3), math.sin(math.pi / 3)]) * push * 0.5 * 9.81
    mujoco.mj_step(model, data, 2000)
    speed = np.linalg.norm(data.qvel[:2])
    mujoco.mj_step(model, data, 500)
    return np.linalg.norm(data.qvel[:2]) - speed > 1e-6


for cone in ("pyramidal", "elliptic"):
    held, sliding = 0.3, 1.5
    while sliding - held > 1e-4:
        middle = (held + sliding) / 2
        held, sliding = (held, middle) if slides(cone, middle) else (middle, sliding)
    print(cone, sliding)
