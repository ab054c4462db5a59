"""Print how far a hinge at 2 rad/s goes beyond its limit in MuJoCo, and which part of its rate the limit gives back."""

import math

import mujoco

MODEL = """<mujoco><compiler angle="radian"/><option timestep="{0}" gravity="0 0 0" integrator="RK4"/><worldbody><body>
<joint name="pin" axis="0 1 0" limited="true" range="-1 0.101" {1}/>
<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/></body></worldbody></mujoco>"""
#: A time constant of two steps of 2 ms, critical damping, and the largest impedance: rigid stops of a case without rebound.
STIFF = 'solreflimit="-62500 -500" solimplimit="0.9999 0.9999 0.001 0.5 1"'
print("law_overshoot", 2 * 0.02 / math.e)
print("law_rebound", math.exp(-2))
for name, step, limit in (("fine", 1e-5, ""), ("usual", 0.002, ""), ("stiff", 0.002, STIFF)):
    model = mujoco.MjModel.from_xml_string(MODEL.format(step, limit))
    data = mujoco.MjData(model)
    data.qvel[0] = 2
    farthest = 0.0
    for _ in range(round(0.3 / step)):
        mujoco.mj_step(model, data)
        farthest = max(farthest, data.qpos[0] - 0.101)
    print(f"{name}_overshoot", farthest)
    print(f"{name}_rebound", -data.qvel[0] / 2)
