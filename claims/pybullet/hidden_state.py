"""Print how far a stack of three boxes, restarted from its poses and velocities, comes from one that runs on, in Bullet."""

import numpy as np
import pybullet

pybullet.connect(pybullet.DIRECT)


def stack(states):
    pybullet.resetSimulation()
    pybullet.setPhysicsEngineParameter(fixedTimeStep=0.002)
    pybullet.setGravity(0, 0, -9.81)
    shapes = [pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=h) for h in ((99, 99, 1), (0.2, 0.15, 0.05))]
    pybullet.createMultiBody(0, shapes[0], basePosition=(0, 0, -1))
    for place, quaternion, *velocities in states:
        pybullet.resetBaseVelocity(pybullet.createMultiBody(1, shapes[1], -1, place, quaternion), *velocities)
    for body in range(pybullet.getNumBodies()):
        pybullet.changeDynamics(body, -1, lateralFriction=0.4**0.5, linearDamping=0, angularDamping=0)


def after(steps):
    for _ in range(steps):
        pybullet.stepSimulation()
    return [(*pybullet.getBasePositionAndOrientation(body), *pybullet.getBaseVelocity(body)) for body in (1, 2, 3)]


stack([((x, 0, z), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)) for x, z in ((0, 0.05), (0.05, 0.15), (-0.03, 0.25))])
states, on = after(20), after(100)
stack(states)
print("difference", max(np.abs(np.subtract(a, b)).max() for a, b in zip(sum(on, ()), sum(after(100), ()), strict=True)))
