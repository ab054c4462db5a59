"""Print the part of a finger's force on one of its four corners in Bullet, and the error of a block that slips, after 0.3 s."""

import numpy as np
import pybullet

LINK = """<link name="{0}"><inertial><mass value="{1}"/><inertia ixx="{2}" iyy="{3}" izz="{4}" ixy="0" ixz="0" iyz="0"/>
</inertial><collision><geometry><box size="{5}"/></geometry></collision></link>"""
JOINT = """<joint name="joint{0}" type="prismatic"><parent link="world"/><child link="{0}"/><origin xyz="{1} 0 0"/>
<axis xyz="{0} 0 0"/><limit lower="0" upper="-1" effort="0" velocity="0"/></joint>"""
SIDES = [LINK.format(side, 0.2, 1e-4, 1e-4, 1e-4, "0.02 0.06 0.08") + JOINT.format(side, -0.04 * side) for side in (1, -1)]
BLOCK = LINK.format(0, 1, 0.0089 / 3, 0.0073 / 3, 0.0034 / 3, "0.06 0.1 0.16")
pybullet.connect(pybullet.DIRECT)
for name, mixing in (("", 0), ("_mixed", 0.001)):
    pybullet.resetSimulation()
    pybullet.setPhysicsEngineParameter(fixedTimeStep=0.001, globalCFM=mixing)
    pybullet.setGravity(0, 0, -9.81)
    for body, text in enumerate((BLOCK, '<link name="world"/>' + "".join(SIDES))):
        with open(f"{body}.urdf", "w") as file:
            file.write(f'<robot name="body">{text}</robot>')
        pybullet.loadURDF(f"{body}.urdf", useFixedBase=body, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
        _ = [pybullet.changeDynamics(body, link, lateralFriction=0.5**0.5) for link in ([-1], [0, 1])[body]]
    pybullet.setJointMotorControlArray(1, (0, 1), pybullet.VELOCITY_CONTROL, forces=(0, 0))
    for step in range(300):
        pybullet.setJointMotorControlArray(1, (0, 1), pybullet.TORQUE_CONTROL, forces=(8, 8))
        pybullet.stepSimulation()
        loads = [point[9] for point in pybullet.getContactPoints(0, 1, -1, 0)]
        print(f"share{name} {max(loads) / sum(loads)}\n" if step == 0 else "", end="")
    print(f"error{name}", np.linalg.norm(np.add(pybullet.getBasePositionAndOrientation(0)[0], (0, 0, (9.81 - 8) * 0.3**2 / 2))))
