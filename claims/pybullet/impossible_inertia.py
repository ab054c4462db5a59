"""PyBullet: an inertia that no body can have becomes zero, with a warning."""

import tempfile

import pybullet as p

INERTIA = '<inertia ixx="{}" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
LINK = '<link name="{}"><inertial><mass value="1"/>' + INERTIA + "</inertial></link>"
JOINT = '<joint name="joint" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>'

p.connect(p.DIRECT)
for name, moment in (("possible", 0.15), ("impossible", 1.0)):
    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(f'<robot name="robot">{LINK.format("base", 0.1)}{LINK.format("arm", moment)}{JOINT}</robot>')
        file.flush()
        body = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE)
    mass, _, moments, *_ = p.getDynamicsInfo(body, 0)
    print(f"{name}_mass", mass)
    print(f"{name}_moment", max(moments))
