"""Print the force of friction on a box that slides in several directions, over that of Coulomb's law, in Bullet."""

from math import cos, radians, sin

import numpy as np
import pybullet


def force(direction, turned, **parameters):
    pybullet.resetSimulation()
    pybullet.setGravity(0, 0, -9.81)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=0.002, **parameters)
    boxes = [pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half) for half in ((99, 99, 1), (0.2, 0.2, 0.05))]
    ground = pybullet.createMultiBody(0, boxes[0], basePosition=(0, 0, -1))
    attitude = pybullet.getQuaternionFromEuler((0, 0, direction if turned else 0))
    box = pybullet.createMultiBody(1, boxes[1], basePosition=(0, 0, 0.05), baseOrientation=attitude)
    for body, friction in ((ground, 1), (box, 0.5)):
        pybullet.changeDynamics(body, -1, lateralFriction=friction, linearDamping=0, angularDamping=0)
    start, along = 2 * np.array([cos(direction), sin(direction), 0]), np.array([cos(direction), sin(direction), 0])
    pybullet.resetBaseVelocity(box, start.tolist(), (0, 0, 0))
    for _ in range(30):
        pybullet.stepSimulation()
    change = pybullet.getBaseVelocity(box)[0] - start
    return -change @ along / (0.5 * (9.81 * 0.06 + change[2]))


pybullet.connect(pybullet.DIRECT)
print("along_edge", force(0, False), "\nacross_world", force(radians(45), False), "\nturned", force(radians(45), True))
print("turned_iterations", force(radians(45), True, numSolverIterations=1000))
