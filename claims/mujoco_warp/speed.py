"""Print the attitude error of MuJoCo Warp's RK4 (10 ms) after 5 s of NASA's tumbling brick, in flight and at rest."""

import mujoco
import mujoco_warp as mjw
import numpy as np

MODEL = """<mujoco><option timestep="0.01" integrator="RK4" gravity="0 0 {}"/><worldbody><body pos="0 0 9144">
<freejoint/><inertial pos="0 0 0" mass="{}" diaginertia="0.002568217474 0.008421011038 0.009754655939"/></body>
</worldbody></mujoco>"""
RATES = 0.17453292519943295, 0.3490658503988659, 0.5235987755982988


def attitude(mass, speed, gravity, engine):
    """Return the quaternion after 500 steps."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(gravity, mass))
    data = mujoco.MjData(model)
    data.qpos[3:], data.qvel = (0, 1, 0, 0), (0, -speed, 0, *RATES)
    if engine is mujoco:
        mujoco.mj_step(model, data, 500)
        return data.qpos[3:]
    model, data = mjw.put_model(model), mjw.put_data(model, data)
    for _ in range(500):
        mjw.step(model, data)
    return data.qpos.numpy()[0, 3:]


exact = attitude(2.0, 0.0, 0.0, mujoco)  # at rest MuJoCo's own RK4 is right to 1.1e-11 rad
for name, mass, speed in (("flight", 2.26796189585643, 465.76787589315), ("two_kg", 2.0, 465.76787589315), ("rest", 2.0, 0.0)):
    ended = attitude(mass, speed, -0.021 * speed, mjw).astype(float)
    print(name, 4 * np.arcsin(min(np.linalg.norm(ended - exact), np.linalg.norm(ended + exact)) / 2))
