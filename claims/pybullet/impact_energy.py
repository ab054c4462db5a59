"""Print the relative change of the kinetic energy of two equal boxes in an elastic impact without friction, in Bullet."""

import numpy as np
import pybullet

HALF = np.array([0.1, 0.15, 0.2])  # half the lengths of the boxes (m); each has 1 kg


def largest(timestep=0.002, **parameters):
    changes, energy = [], 0.0
    for gap in (0.05, 0.0517, 0.0535):  # the impact is at other instants within a step
        pybullet.resetSimulation()
        pybullet.setPhysicsEngineParameter(fixedTimeStep=timestep, **parameters)
        for place, speed in (((0, 0, 0), 0), ((0.2 + gap, 0.11, 0.07), -3)):
            box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=HALF.tolist())
            body = pybullet.createMultiBody(1, box, basePosition=place)
            pybullet.changeDynamics(body, -1, lateralFriction=0, restitution=1, linearDamping=0, angularDamping=0)
            pybullet.resetBaseVelocity(body, (speed, 0, 0), (0, 0, 0))
        _ = [pybullet.stepSimulation() for _ in range(round(0.1 / timestep))]
        for body in range(2):
            velocity, spin = pybullet.getBaseVelocity(body)
            axes = pybullet.getMatrixFromQuaternion(pybullet.getBasePositionAndOrientation(body)[1])
            energy += (np.dot(velocity, velocity) + (HALF @ HALF - HALF**2) / 3 @ (spin @ np.reshape(axes, (3, 3))) ** 2) / 2
        changes, energy = [*changes, energy / 4.5 - 1], 0.0
    return max(changes, key=abs)


pybullet.connect(pybullet.DIRECT)
print(f"gain {largest()}\nfiner {largest(0.00025)}\nwithout_correction {largest(contactERP=0)}")
print(f"iterations {largest(numSolverIterations=1000)}\ncold {largest(warmStartingFactor=0)}")
