"""Print which part of its speed a ball keeps in an impact at 1 m/s in PyBullet that should keep half of it.

There is neither gravity nor friction. The ball begins at four distances from the plane, so that the impact is at four instants
within a step.
"""

import math
from statistics import fmean

import pybullet

SPEED, KEPT, STEP, RADIUS, SIZE = 1, 0.5, 1 / 240, 0.1, (1e4, 1e4, 1)


def rebound(steps_away):
    pybullet.resetSimulation()
    pybullet.setPhysicsEngineParameter(fixedTimeStep=STEP)
    shapes = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=SIZE), pybullet.createCollisionShape(2, RADIUS)
    for mass, shape, z in ((0, shapes[0], -1), (1, shapes[1], RADIUS + steps_away * SPEED * STEP)):
        body = pybullet.createMultiBody(mass, shape, basePosition=(0, 0, z))
        pybullet.changeDynamics(body, -1, lateralFriction=0, restitution=math.sqrt(KEPT))
    pybullet.resetBaseVelocity(body, (0, 0, -SPEED))
    speeds = [pybullet.getBaseVelocity(body)[0][2] for _ in range(72) if pybullet.stepSimulation() is not None]
    return max(speeds) / SPEED


pybullet.connect(pybullet.DIRECT)
parts = [max(0, rebound(away)) for away in (2.1, 2.35, 2.6, 2.85)]
print(f"least {min(parts)}\nmost {max(parts)}\nmean {fmean(parts)}")
