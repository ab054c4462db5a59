"""SAPIEN: angular damping of 0.05 per second, a limit of 100 rad/s, and a speed of sleep that grows with the step."""

import warnings

warnings.simplefilter("ignore")
import sapien
from sapien import physx

physx.set_scene_config(gravity=[0, 0, 0])


def ran(velocity, spin, step, duration):
    """Return the position along x and the angular velocity about x of a free body after a time."""
    scene = sapien.Scene([physx.PhysxCpuSystem()])
    scene.physx_system.timestep = step
    body, entity = physx.PhysxRigidDynamicComponent(), sapien.Entity()
    body.mass, body.inertia = 1.0, [1.0, 1.0, 1.0]
    entity.add_component(body)
    scene.add_entity(entity)
    body.linear_velocity, body.angular_velocity = [velocity, 0, 0], [spin, 0, 0]
    for _ in range(round(duration / step)):
        scene.physx_system.step()
    return float(entity.pose.p[0]) / (velocity * duration), float(body.angular_velocity[0])


print("spin_after_1_s", ran(1, 1.0, 0.002, 1)[1])
print("largest_spin", ran(1, 300.0, 0.002, 0.002)[1])
for name, step, slow, fast in (("short", 0.002, 0.0009, 0.0011), ("long", 0.01, 0.0045, 0.0055)):
    print(f"{name}_step_slow", ran(slow, 0, step, 4)[0])
    print(f"{name}_step_fast", ran(fast, 0, step, 4)[0])
