"""Print whether a joint follows another in SAPIEN, for a leader that is its neighbour and for one that is far away."""

import warnings
from pathlib import Path

warnings.simplefilter("ignore")
import sapien
from sapien import physx

physx.set_scene_config(gravity=[0, 0, 0])
for name, file in (("neighbour", "mimic"), ("far", "far_mimic")):
    scene = sapien.Scene([physx.PhysxCpuSystem()])
    scene.physx_system.timestep, loader = 0.001, scene.create_urdf_loader()
    loader.fix_root_link = True
    robot = loader.load(str(Path(__file__).parents[1] / "robots" / f"{file}.urdf"))
    for _ in range(1000):
        robot.set_qf([0.1 if joint.name == "leader" else 0.0 for joint in robot.active_joints])
        scene.physx_system.step()
    angles = {joint.name: float(angle) for joint, angle in zip(robot.active_joints, robot.qpos, strict=True)}
    print(name, "follows" if abs(angles["follower"] / angles["leader"] - 2) < 1e-3 else "does not follow")
