"""The sum of the impulses over the time step (N) of SAPIEN's contacts of a sliding box of 1 kg, and its friction (N)."""

import numpy as np
import sapien
from sapien import physx

config = physx.PhysxSceneConfig()
config.gravity = np.array([0, 0, -9.81])
physx.set_scene_config(config)
physx.set_default_material(0.3, 0.3, 0.0)
system = physx.PhysxCpuSystem()
system.set_timestep(0.002)
scene = sapien.Scene([system])
scene.add_ground(0.0, render=False)
builder = scene.create_actor_builder()
builder.add_box_collision(half_size=[0.1, 0.1, 0.1], density=125.0)
box = builder.build(name="box")
box.set_pose(sapien.Pose([0, 0, 0.1]))
body = box.find_component_by_type(physx.PhysxRigidDynamicComponent)
body.set_linear_velocity([1, 0, 0])
for _ in range(50):
    before = body.linear_velocity[0]
    system.step()
total = sum(np.array(point.impulse) for contact in system.get_contacts() for point in contact.points) / 0.002
print(f"along {abs(total[0]):.4g}\nupward {abs(total[2]):.4g}\nbraking {(before - body.linear_velocity[0]) / 0.002:.4g}")
