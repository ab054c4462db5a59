"""Print the kinetic energy after an elastic impact without friction of two equal boxes over the energy before it, in Bullet."""

from importlib.metadata import version

import numpy as np
import pybullet

HALF = np.array([0.1, 0.15, 0.2])  # half the lengths of the boxes (m); each has 1 kg
MOMENTS = (HALF @ HALF - HALF**2) / 3
CENTRED, ASIDE = (0.0, 0.0), (0.11, 0.07)  # displacements (m) in the plane of the faces
STEPS = (1 / 240, 0.001, 0.00025)


def energy(body):
    """Return the kinetic energy (J) of a body."""
    velocity, spin = pybullet.getBaseVelocity(body)
    axes = pybullet.getMatrixFromQuaternion(pybullet.getBasePositionAndOrientation(body)[1])
    return (np.dot(velocity, velocity) + MOMENTS @ (spin @ np.reshape(axes, (3, 3))) ** 2) / 2


def ratio(displacement, gap, timestep, **parameters):
    """Return the energy after the impact over the energy before it."""
    pybullet.resetSimulation()
    pybullet.setPhysicsEngineParameter(fixedTimeStep=timestep, **parameters)
    shape, bodies = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=HALF.tolist()), []
    for place, speed in (((0, 0, 0), 0), ((0.2 + gap, *displacement), -3)):
        bodies.append(body := pybullet.createMultiBody(1, shape, basePosition=place))
        pybullet.changeDynamics(body, -1, lateralFriction=0, restitution=1, linearDamping=0, angularDamping=0)
        pybullet.resetBaseVelocity(body, (speed, 0, 0), (0, 0, 0))
    before = sum(map(energy, bodies))
    for _ in range(round(0.15 / timestep)):
        pybullet.stepSimulation()
    return sum(map(energy, bodies)) / before


def show(words, displacement, **parameters):
    """Print the smallest and the largest ratio for several distances of the faces at the start, with several time steps."""
    cells = []
    for timestep in STEPS:
        ratios = [ratio(displacement, 0.05 + part * 3 * timestep, timestep, **parameters) for part in np.arange(0.05, 1, 0.1)]
        cells.append(f"{min(ratios):.4f} to {max(ratios):.4f}")
    print(f"{words:40}", "   ".join(cells))


pybullet.connect(pybullet.DIRECT)
print(f"pybullet {version('pybullet')}")
print(f"{'time step (s)':40}", "   ".join(f"{step:<16.5f}" for step in STEPS).rstrip())
show("centred", CENTRED)
show("aside", ASIDE)
show("aside, 1000 iterations", ASIDE, numSolverIterations=1000)
show("aside, no warm start", ASIDE, warmStartingFactor=0)
show("aside, split impulse", ASIDE, useSplitImpulse=1, contactSlop=0)
show("aside, restitutionVelocityThreshold 0", ASIDE, restitutionVelocityThreshold=0)
show("aside, contactERP 0", ASIDE, contactERP=0)
show("aside, contactERP 0.4", ASIDE, contactERP=0.4)
