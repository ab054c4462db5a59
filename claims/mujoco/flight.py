"""Print the error of MuJoCo's RK4 (10 ms) in the rates (deg/s) of NASA's tumbling brick after 30 s, in flight and at rest."""

import mujoco
import numpy as np

MODEL = """<mujoco><option timestep="0.01" integrator="RK4" gravity="0 0 {}"/><worldbody><body pos="0 0 9144"><freejoint/>
<inertial pos="0 0 0" mass="{}" diaginertia="0.0025682174740883053 0.008421011037627346 0.009754655939231735"/>
</body></worldbody></mujoco>"""
RATES = 0.17453292519943295, 0.3490658503988659, 0.5235987755982988
EXACT = 12.618390775914, -17.397474761611, 31.119588886944  # the elliptic functions of the closed form, to 1.6e-13 deg/s

for name, mass, speed, gravity in (
    ("flight", 2.2679618958564325, 465.76787589315, -9.786072158),
    ("two_kg", 2.0, 465.76787589315, -9.786072158),
    ("rest", 2.2679618958564325, 0.0, 0.0),
):
    model = mujoco.MjModel.from_xml_string(MODEL.format(gravity, mass))
    data = mujoco.MjData(model)
    data.qpos[3:], data.qvel = (0, 1, 0, 0), (0, -speed, 0, *RATES)
    mujoco.mj_step(model, data, 3000)
    print(name, np.linalg.norm(np.degrees(data.qvel[3:]) - EXACT))
