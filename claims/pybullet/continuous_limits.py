"""PyBullet: `getJointInfo` has limits of a continuous joint that stop nothing; those of a revolute joint stop it."""

import tempfile

import pybullet as p

INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
LINKS = "".join(f'<link name="{name}"><inertial><mass value="1"/>{INERTIA}</inertial></link>' for name in ("base", "arm"))

p.connect(p.DIRECT)
for name, kind, limit in (("zero", "continuous", 0), ("turn", "continuous", 6.28), ("revolute", "revolute", 1)):
    bounds = f'<limit lower="{-limit}" upper="{limit}" effort="1" velocity="10"/>'
    joint = f'<joint name="joint" type="{kind}"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>{bounds}</joint>'
    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(f'<robot name="robot">{LINKS}{joint}</robot>')
        file.flush()
        body = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE)
    for link in (-1, 0):
        p.changeDynamics(body, link, linearDamping=0, angularDamping=0)
    p.setJointMotorControl2(body, 0, p.VELOCITY_CONTROL, force=0)
    p.resetJointState(body, 0, 0, 5)
    for _ in range(480):  # of 1/240 s, which is the default
        p.stepSimulation()
    print(f"{name}_told", p.getJointInfo(body, 0)[9])
    print(f"{name}_position", p.getJointState(body, 0)[0])
    p.resetSimulation()
