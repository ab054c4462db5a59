"""Print which part of balls with spin gets no friction in its first impact in SAPIEN, by the time step."""

import math
import warnings

import numpy as np

warnings.simplefilter("ignore")
from sapien import Entity, Pose, Scene, physx


def friction(fall, timestep):
    scene, surface = Scene([physx.PhysxCpuSystem()]), physx.PhysxMaterial(0.2, 0.2, 0.7)
    scene.physx_system.timestep = timestep
    ground, ball = physx.PhysxRigidStaticComponent(), physx.PhysxRigidDynamicComponent()
    ground.attach(physx.PhysxCollisionShapePlane(surface))
    ball.attach(physx.PhysxCollisionShapeSphere(0.1, surface))
    ball.mass, ball.inertia = 1.0, [0.004] * 3
    for body, pose in ((ground, Pose(q=(0.5**0.5, 0, -(0.5**0.5), 0))), (ball, Pose((0, 0, 0.1 + fall)))):
        scene.add_entity(Entity().add_component(body))
        body.entity.set_pose(pose)
    ball.linear_velocity, ball.angular_velocity = (2, 0.5, -1), (20, -40, 6)
    while ball.linear_velocity[2] < 0:
        scene.physx_system.step()
    return math.dist(ball.linear_velocity[:2], (2, 0.5)) / (0.2 * 1.7 * math.sqrt(1 + 2 * 9.81 * fall))  # of Coulomb's law


usual, finer, short = (np.array([friction(fall, h) for fall in np.linspace(0.3, 0.6, 100)]) for h in (0.01, 0.0025, 0.001))
error = (1 - friction(0.5, 0.0025)) * 0.2 * 1.7 * math.sqrt(1 + 2 * 9.81 * 0.5)
print(f"usual {np.mean(usual < 0.01)}\nfiner {np.mean(finer < 0.01)}\nleast {short.min()}\nerror {error}")
