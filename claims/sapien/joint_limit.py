"""Print how far a hinge at 2 rad/s goes beyond its limit of 0.101 rad in SAPIEN with steps of 1 ms, and its rate afterwards."""

import warnings

warnings.simplefilter("ignore")
import sapien
from sapien import physx

for name, tgs in (("tgs", True), ("pgs", False)):
    physx.set_scene_config(gravity=[0, 0, 0], enable_tgs=tgs)
    scene = sapien.Scene([physx.PhysxCpuSystem()])
    scene.physx_system.timestep = 1e-3
    builder = scene.create_articulation_builder()
    base = builder.create_link_builder()
    base.set_mass_and_inertia(1.0, sapien.Pose(), [1.0, 1.0, 1.0])
    arm = builder.create_link_builder(base)
    arm.set_mass_and_inertia(1.0, sapien.Pose(), [0.01, 0.01, 0.01])
    arm.set_joint_properties("revolute", [[-1.0, 0.101]], sapien.Pose(), sapien.Pose())
    robot = builder.build(fix_root_link=True)
    robot.set_qvel([2.0])
    angles = [scene.physx_system.step() or float(robot.qpos[0]) for _ in range(300)]
    print(f"{name}_beyond {max(angles) - 0.101}\n{name}_rate {float(robot.qvel[0])}")
