"""SAPIEN: a follower beside its leader has the inverse multiplier; a follower on the child of its leader is right."""

import tempfile
import warnings

warnings.simplefilter("ignore")
import sapien
from sapien import physx

physx.set_scene_config(gravity=[0, 0, 0])
INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
LINKS = "".join(f'<link name="{name}"><inertial><mass value="1"/>{INERTIA}</inertial></link>' for name in "zhab")
LIMIT = '<axis xyz="0 0 1"/><limit lower="-30" upper="30" effort="10" velocity="10"/>'
JOINT = '<joint name="{1}" type="revolute"><parent link="{0}"/><child link="{1}"/>' + LIMIT + "{2}</joint>"
for kind, parent in (("siblings", "h"), ("chain", "a")):
    for name, multiplier in (("two", 2), ("half", 0.5)):
        rule = f'<mimic joint="a" multiplier="{multiplier}"/>'
        joints = "".join(JOINT.format(*one) for one in (("z", "h", ""), ("h", "a", ""), (parent, "b", rule)))
        scene = sapien.Scene([physx.PhysxCpuSystem()])
        scene.physx_system.timestep = 0.001
        with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
            file.write(f'<robot name="robot">{LINKS}{joints}</robot>')
            file.flush()
            robot = scene.create_urdf_loader().load(file.name)
        for _ in range(1000):
            robot.set_qf([0.5 if joint.name == "a" else 0.0 for joint in robot.active_joints])
            scene.physx_system.step()
        place = {joint.name: float(at) for joint, at in zip(robot.active_joints, robot.qpos, strict=True)}
        print(f"{kind}_{name}", place["b"] / place["a"])
