"""PyBullet's force (N) and moment (N m) in a hinge that holds 2 kg, 0.3 m beside it, of an arm with oblique principal axes."""

import math
import tempfile
from pathlib import Path

import pybullet as p

INERTIA = '<inertia ixx="0.02" iyy="0.05" izz="0.06" ixy="0" ixz="0" iyz="0"/></inertial></link>'
ROBOT = f"""<robot name="r"><link name="w"><inertial><mass value="1"/>{INERTIA}<link name="a"><inertial>
<origin xyz="0.3 0 0" rpy="0.3 0.2 0.1"/><mass value="2"/>{INERTIA}<joint name="j" type="continuous">
<parent link="w"/><child link="a"/><axis xyz="0 1 0"/></joint></robot>"""
path = Path(tempfile.mkdtemp()) / "r.urdf"
path.write_text(ROBOT, "utf-8")
p.connect(p.DIRECT)
p.setGravity(0, 0, -9.81)
for name, mode in (("usual", 0), ("joint", p.JOINT_FEEDBACK_IN_JOINT_FRAME)):
    p.setPhysicsEngineParameter(jointFeedbackMode=mode)
    arm = p.loadURDF(str(path), useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE)
    p.setJointMotorControl2(arm, 0, p.VELOCITY_CONTROL, force=0)
    p.enableJointForceTorqueSensor(arm, 0, True)
    p.setJointMotorControl2(arm, 0, p.TORQUE_CONTROL, force=-2 * 9.81 * 0.3)
    p.stepSimulation()
    *force, tx, ty, tz = p.getJointState(arm, 0)[2]
    print(f"up_{name} {force[2]:.5g}\nforce_{name} {math.hypot(*force):.5g}\nmoment_{name} {math.hypot(tx, ty, tz) + 0.0:.5g}")
