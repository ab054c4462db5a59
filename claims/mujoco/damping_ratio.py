"""Print the damping of a servo with a ratio of 1 at the shoulder of an arm, and that for a loose and a held elbow."""

import math

import mujoco

MODEL = """<mujoco><worldbody><body><joint name="shoulder" axis="0 1 0"/>
<inertial pos="0.2 0 0" mass="1" diaginertia="0.01 0.01 0.01"/><body pos="0.4 0 0"><joint name="elbow" axis="0 1 0"/>
<inertial pos="0.2 0 0" mass="1" diaginertia="0.01 0.01 0.01"/></body></body></worldbody>
<actuator><position joint="shoulder" kp="100" dampratio="1"/></actuator></mujoco>"""
model = mujoco.MjModel.from_xml_string(MODEL)
# Two links of 1 kg and 0.4 m along x, each with 0.01 kg m^2 about its centre.
far = 0.01 + 0.2**2
held = 2 * far + 0.4**2 + 2 * 0.4 * 0.2
loose = held - (far + 0.4 * 0.2) ** 2 / far
print("damping_new", -model.actuator_biasprm[0, 2])
print("damping_old", -model.actuator_biasprm[0, 2])
print("held", 2 * math.sqrt(100 * held))
print("loose", 2 * math.sqrt(100 * loose))
