"""PyBullet: the friction of a joint in a URDF is told by `getJointInfo`, and brakes nothing; its damping brakes."""

import tempfile

import pybullet as p

INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
LINKS = "".join(f'<link name="{name}"><inertial><mass value="1"/>{INERTIA}</inertial></link>' for name in ("base", "arm"))
JOINT = '<joint name="joint" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>{}</joint>'

p.connect(p.DIRECT)
for name, damping, friction in (("none", 0, 0), ("friction", 0, 0.2), ("damping", 0.05, 0)):
    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        dynamics = f'<dynamics damping="{damping}" friction="{friction}"/>'
        file.write(f'<robot name="robot">{LINKS}{JOINT.format(dynamics)}</robot>')
        file.flush()
        body = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE)
    for link in (-1, 0):
        p.changeDynamics(body, link, linearDamping=0, angularDamping=0)
    p.setJointMotorControl2(body, 0, p.VELOCITY_CONTROL, force=0)
    p.resetJointState(body, 0, 0, 5)
    for _ in range(240):  # 1 s
        p.stepSimulation()
    print(f"{name}_told", p.getJointInfo(body, 0)[7])
    print(f"{name}_velocity", p.getJointState(body, 0)[1])
    p.resetSimulation()
