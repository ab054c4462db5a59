"""Print how far a stack of three boxes, restarted from its poses and velocities, comes from one that runs on, in PhysX."""

import numpy as np
import sapien
from sapien import physx

config = physx.PhysxSceneConfig()
config.enable_tgs, config.gravity = True, np.array([0, 0, -9.81])
physx.set_scene_config(config)


def stack(states):
    system, rough, bodies = physx.PhysxCpuSystem(), physx.PhysxMaterial(0.4, 0.4, 0.0), []
    system.timestep, scene = 0.002, sapien.Scene([system])
    scene.add_ground(0, render=False, material=rough)
    for pose, velocity, spin in states:
        bodies.append(body := physx.PhysxRigidDynamicComponent())
        body.attach(physx.PhysxCollisionShapeBox((0.2, 0.15, 0.05), rough))
        body.mass, body.inertia, entity = 1, np.array([0.025, 0.0425, 0.0625]) / 3, sapien.Entity()
        entity.add_component(body), scene.add_entity(entity), entity.set_pose(pose)
        body.linear_velocity, body.angular_velocity = velocity, spin
    while True:
        yield [(body.entity.pose, body.linear_velocity, body.angular_velocity) for body in bodies]
        system.step()


places = [sapien.Pose((x, 0, z)) for x, z in ((0, 0.05), (0.05, 0.15), (-0.03, 0.25))]
states = [state for state, _ in zip(stack([(place, *np.zeros((2, 3))) for place in places]), range(121), strict=False)]
*_, (again, _) = zip(stack(states[20]), range(101), strict=False)
print("difference", max(np.abs(a[part] - b[part]).max() for a, b in zip(again, states[120], strict=True) for part in (1, 2)))
