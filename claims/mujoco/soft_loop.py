"""Print by how much the loop of a slider crank comes apart in 4 s in MuJoCo, for three values of solref."""

import mujoco
import numpy as np

MODEL = """<mujoco><option timestep="{}" integrator="{}"/><worldbody>
<body><joint axis="0 -1 0"/><inertial pos="0.3 0 0" mass="1" diaginertia="0.001 0.03 0.03"/>
<body pos="0.6 0 0"><joint axis="0 -1 0"/><inertial pos="0.5 0 0" mass="0.8" diaginertia="0.001 0.07 0.07"/>
<site name="end" pos="1 0 0"/></body></body>
<body><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
<site name="pin"/></body></worldbody><equality><connect site1="end" site2="pin" solref="{}"/></equality></mujoco>"""

for name, step, integrator, solref in (
    ("RK4", 1e-3, "RK4", "0.02 1"),
    ("half_step", 5e-4, "RK4", "0.02 1"),
    ("Euler", 1e-3, "Euler", "0.02 1"),
    ("shorter", 1e-3, "RK4", "0.008 1"),
    ("stiff", 1e-3, "RK4", "-1e6 -2e3"),
):
    data = mujoco.MjData(model := mujoco.MjModel.from_xml_string(MODEL.format(step, integrator, solref)))
    data.qpos, data.qvel, gap = (1.5707963267948966, -2.214297435588181, 0.8), (5, -5, -3), 0.0
    for _ in range(100):  # the instants of the case
        mujoco.mj_step(model, data, round(0.04 / step))
        crank, rod, slider = data.qpos
        gap = max(gap, abs(0.6 * np.exp(1j * crank) + np.exp(1j * (crank + rod)) - slider))
    print(name, gap)
