"""Print how far a hinge at 2 rad/s goes beyond limits at ten places within the way of a step, and what returns."""

import tempfile

import pybullet

URDF = """<robot name="robot"><link name="world"/><link name="arm"><inertial><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="pin" type="revolute">
<parent link="world"/><child link="arm"/><axis xyz="0 1 0"/><limit lower="-1" upper="{}" effort="0" velocity="0"/></joint>
</robot>"""
pybullet.connect(pybullet.DIRECT)
for name, step, erp in (("coarse", 1e-3, {}), ("fine", 1e-4, {}), ("erp_0", 1e-3, {"erp": 0.0})):
    beyond, rates = [], []
    for part in range(10):
        pybullet.resetSimulation()
        pybullet.setPhysicsEngineParameter(fixedTimeStep=step, **erp)
        limit = 0.1 + (part + 0.5) / 10 * 2 * step
        with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
            file.write(URDF.format(limit))
            file.flush()
            body = pybullet.loadURDF(file.name, useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
        pybullet.setJointMotorControl2(body, 0, pybullet.VELOCITY_CONTROL, force=0)
        pybullet.resetJointState(body, 0, 0, 2.0)
        states = [pybullet.stepSimulation() or pybullet.getJointState(body, 0)[:2] for _ in range(round(0.2 / step))]
        beyond.append(max(state[0] for state in states) - limit)
        rates.append(-states[-1][1] / 2)
    print(f"{name}_beyond {max(beyond)}\n{name}_least {min(rates)}\n{name}_most {max(rates)}")
