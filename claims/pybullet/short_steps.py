"""Print which part of their velocity balls keep in PyBullet that fall by about half a metre and should keep 0.8 of it."""

import math

import pybullet

G, KEPT, FIRST = 9.81, 0.8, math.sqrt(2 * 0.5 / 9.81)  # the first impact of a fall of 0.5 m (s)


def drop(timestep, fall, **of_body):
    pybullet.resetSimulation()
    pybullet.setGravity(0, 0, -G)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=timestep, contactERP=0 if of_body else 0.08)
    shapes = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=(1e4, 1e4, 1)), pybullet.createCollisionShape(2, 0.1)
    for mass, shape, z in ((0, shapes[0], -1), (1, shapes[1], 0.1 + fall)):
        body = pybullet.createMultiBody(mass, shape, basePosition=(0, 0, z))
        pybullet.changeDynamics(body, -1, lateralFriction=0.5, restitution=math.sqrt(KEPT), **of_body)
    speeds, errors = [0], [0]
    for step in range(1, round(0.8 / timestep)):
        pybullet.stepSimulation()
        speeds.append(pybullet.getBaseVelocity(body)[0][2])
        exact = KEPT * G * FIRST * (late := step * timestep - FIRST) - G * late**2 / 2  # until the second impact
        errors += [abs(pybullet.getBasePositionAndOrientation(body)[0][2] - 0.1 - exact)] if step % 4 == 0 and late > 0 else []
    return -max(speeds) / min(speeds), max(errors)


pybullet.connect(pybullet.DIRECT)
usual, short = ([drop(h, 0.45 + 0.01 * n)[0] for n in range(11)] for h in (1 / 240, 0.0005))
print(f"least {min(usual)}\nmost {max(usual)}\nshort {max(short)}\nerror {drop(0.001, 0.5)[1]}")
print("remedied", drop(0.0005, 0.5, contactProcessingThreshold=0)[0])
