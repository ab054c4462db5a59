"""A ball with restitution that is dropped on DART's plane: its depth at the samples of `dropped-ball`, and its last rebound."""

import itertools
import math
import sys

import dartpy as dart
import numpy as np


def add(world, skeleton, body, shape):
    aspect = (node := body.createShapeNode(shape)).createDynamicsAspect()
    node.createCollisionAspect()
    aspect.setFrictionCoeff(0.3)
    aspect.setRestitutionCoeff(math.sqrt(0.8))
    world.addSkeleton(skeleton)


world, ball, ground = dart.simulation.World(), dart.dynamics.Skeleton("ball"), dart.dynamics.Skeleton("ground")
world.setTimeStep(0.001)
body = ball.createFreeJointAndBodyNodePair()[1]
body.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], np.eye(3) * 0.004))
ball.setPositions([0.0, 0.0, 0.0, 0.0, 0.0, 0.6])
add(world, ball, body, dart.dynamics.SphereShape(0.1))
add(world, ground, ground.createWeldJointAndBodyNodePair()[1], dart.dynamics.PlaneShape([0.0, 0.0, 1.0], 0.0))
motion = [(ball.getPositions()[5], ball.getVelocities()[5]) for _ in range(4000) if world.step() is None]
if "trajectory" in sys.argv:
    print(*(f"{0.001 * step:.3f},{z!r},{v!r}" for step, (z, v) in enumerate(motion, 1)), sep="\n")
print(f"penetration {0.1 - min(z for z, _ in motion[3::4]):.12g}")
print(f"last_rebound {[v for (_, before), (_, v) in itertools.pairwise(motion) if before < -0.05 < 0.05 < v][-1]:.5g}")
