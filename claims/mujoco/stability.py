"""Print how far a brick may turn in a step of MuJoCo such that its energy stays below twice the first for 100 turns."""

import math

import mujoco
import numpy as np

MODEL = """<mujoco><option integrator="{}" timestep="{}" gravity="0 0 0"/><worldbody>
<body><freejoint/><geom type="box" size="0.1 0.3 0.2" mass="1"/></body></worldbody></mujoco>"""


def stable(integrator, angle, spin=10.0):
    """Return whether the energy stays below twice its initial value in 100 turns with steps of an angle (rad)."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(integrator, angle / spin))
    data = mujoco.MjData(model)
    data.qvel[3:] = np.array([0.01, 0.0, 1.0]) * spin / math.hypot(0.01, 1.0)
    first = model.body_inertia[1] @ data.qvel[3:] ** 2
    for _ in range(math.ceil(200 * math.pi / angle)):
        mujoco.mj_step(model, data)
        if not model.body_inertia[1] @ data.qvel[3:] ** 2 < 2 * first or data.time == 0.0:
            return False
    return True


for integrator, good, bad in (("Euler", 0.015, 0.03), ("RK4", 2.5, 4.0)):
    while bad / good > 1.002:
        middle = math.sqrt(good * bad)
        good, bad = (middle, bad) if stable(integrator, middle) else (good, middle)
    print(integrator, good)
