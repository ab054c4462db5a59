"""Print by how much the loop of a slider crank comes apart in 4 s in MuJoCo (RK4, 1 ms), and what the loop asks for."""

import mujoco
import numpy as np

MODEL = """<mujoco><option timestep="0.001" integrator="RK4"/><worldbody>
<body><joint axis="0 -1 0"/><inertial pos="0.3 0 0" mass="1" diaginertia="0.001 0.03 0.03"/>
<body pos="0.6 0 0"><joint axis="0 -1 0"/><inertial pos="0.5 0 0" mass="0.8" diaginertia="0.001 0.07 0.07"/>
<site name="end" pos="1 0 0"/></body></body>
<body><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
<site name="pin"/></body></worldbody><equality><connect site1="end" site2="pin"/></equality></mujoco>"""

model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
data.qpos = 1.5707963267948966, -2.214297435588181, 0.8
mujoco.mj_forward(model, data)
print("stiffness", data.efc_KBIP[0, 0], "\ndamping", data.efc_KBIP[0, 1], "\nregularisation", data.efc_R[0])
print("acceleration_at_rest", data.qacc[0])
data.qvel = 5, -5, -3
mujoco.mj_forward(model, data)
print("reference", data.efc_aref[2])  # the pin of the crank has the centripetal acceleration 0.6 m (5 rad/s)^2 = 15 m/s^2
gap = 0.0
for step in range(1, 4001):
    mujoco.mj_step(model, data)
    if step % 40 == 0:  # the instants of the case
        crank, rod, slider = data.qpos
        gap = max(gap, abs(0.6 * np.exp(1j * crank) + np.exp(1j * (crank + rod)) - slider))
print("gap", gap, "\ngap_before", gap)  # of the release that runs: before or from 3.7.0 on
