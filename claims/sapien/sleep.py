"""SAPIEN: a slow body stops when it has been slow for 0.4 s."""

import warnings

warnings.simplefilter("ignore")
import sapien
from sapien import physx

physx.set_scene_config(gravity=[0, 0, 0])
STEP, SPEED = 0.002, 0.0005
scene = sapien.Scene([physx.PhysxCpuSystem()])
scene.physx_system.timestep = STEP
body, entity = physx.PhysxRigidDynamicComponent(), sapien.Entity()
body.mass, body.inertia = 1.0, [1.0, 1.0, 1.0]
entity.add_component(body)
scene.add_entity(entity)
body.linear_velocity = [SPEED, 0, 0]
steps = 0
while body.linear_velocity[0] and steps < 1000:
    scene.physx_system.step()
    steps += 1
print("time_to_sleep", steps * STEP)
