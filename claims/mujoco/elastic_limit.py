"""Print how far a hinge at 2 rad/s goes beyond an elastic limit in MuJoCo, and which part returns, by the impedance.

The limit is given as 40 N m/rad and 0.3 N m s/rad for an inertia of 0.01 kg m^2: both are divided by (1 - d) times the inertia.
"""

import math

import mujoco

MODEL = """<mujoco><compiler angle="radian"/><option timestep="1e-5" gravity="0 0 0" integrator="RK4"/><worldbody><body>
<joint name="pin" axis="0 1 0" limited="true" range="-1 0.1" solreflimit="{} {}" solimplimit="{} {} 0.001 0.5 1"/>
<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/></body></worldbody></mujoco>"""
ratio = 0.15 / math.sqrt(40 * 0.01)
swing = ratio / math.sqrt(1 - ratio**2)
print("law_beyond", 2 * math.sqrt(0.01 / 40) * math.exp(-swing * math.acos(ratio)))
print("law_returned", math.exp(-swing * (math.pi - math.acos(1 - 2 * ratio**2))))
for name, impedance in (("smallest", 1e-4), ("usual", 0.9)):
    scale = -(1 - impedance) / 0.01
    model = mujoco.MjModel.from_xml_string(MODEL.format(40 * scale, 0.3 * scale, impedance, impedance))
    data, beyond = mujoco.MjData(model), 0.0
    data.qvel[0] = 2
    for _ in range(40000):
        mujoco.mj_step(model, data)
        beyond = max(beyond, data.qpos[0] - 0.1)
    print(f"{name}_beyond {beyond}\n{name}_returned {-data.qvel[0] / 2}")
