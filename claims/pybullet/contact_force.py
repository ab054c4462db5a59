"""PyBullet's contact forces on a sliding box along its way (N), over the force that brakes it, by where the ground stands."""

import numpy as np
import pybullet as p


def body(mass, half_extents, height):
    shape = p.createCollisionShape(p.GEOM_BOX, halfExtents=half_extents)
    number = p.createMultiBody(mass, shape, basePosition=(0, 0, height))
    p.changeDynamics(number, -1, lateralFriction=0.3 if mass else 1.0, linearDamping=0, angularDamping=0)
    return number


p.connect(p.DIRECT)
for name in ("ground_first", "ground_last"):
    p.resetSimulation()
    p.setGravity(0, 0, -9.81)
    p.setTimeStep(0.001)
    makers = [lambda: body(0, [9, 9, 1], -1), lambda: body(2, [0.1, 0.1, 0.05], 0.05)]
    box = makers[1]() if name == "ground_last" else (makers[0](), makers[1]())[1]
    _ = makers[0]() if name == "ground_last" else None
    p.resetBaseVelocity(box, (1, 0, 0))
    for _ in range(20):
        before = p.getBaseVelocity(box)[0][0]
        p.stepSimulation()
    acting = 2 * (p.getBaseVelocity(box)[0][0] - before) / 0.001
    points = p.getContactPoints(bodyA=box)
    force = sum(q[9] * np.array(q[7]) + q[10] * np.array(q[11]) + q[12] * np.array(q[13]) for q in points)
    print(f"{name} {force[0] / acting:.4g}\nupward_{name} {np.sign(force[2]):.0f}")
