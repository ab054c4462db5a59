"""The deceleration of a box that slides on a plane in DART, over the coefficient of friction times g, by the direction."""

import math

import dartpy as dart

SPEED, FRICTION, GRAVITY, STEP, DURATION = 2.0, 0.5, 9.81, 0.001, 0.2


def add(world, name, size, height):
    skeleton = dart.dynamics.Skeleton(name)
    fixed = name == "ground"
    make = skeleton.createWeldJointAndBodyNodePair if fixed else skeleton.createFreeJointAndBodyNodePair
    node = make()[1].createShapeNode(dart.dynamics.BoxShape(size))
    node.createCollisionAspect()
    node.createDynamicsAspect().setFrictionCoeff(FRICTION)
    node.setRelativeTranslation([0.0, 0.0, height if fixed else 0.0])
    world.addSkeleton(skeleton)
    return skeleton


for degrees in (0, 15, 30, 45):
    world, angle = dart.simulation.World(), math.radians(degrees)
    world.setTimeStep(STEP)
    world.getConstraintSolver().setCollisionDetector(dart.collision.BulletCollisionDetector())
    _, box = add(world, "ground", [20.0, 20.0, 2.0], -1.0), add(world, "box", [0.2, 0.4, 0.1], 0.0)
    box.setPositions([0.0, 0.0, 0.0, 0.0, 0.0, 0.05])
    box.setVelocities([0.0, 0.0, 0.0, SPEED * math.cos(angle), SPEED * math.sin(angle), 0.0])
    _ = [world.step() for _ in range(round(DURATION / STEP))]
    print(f"ratio_{degrees} {(SPEED - math.hypot(*box.getVelocities()[3:5])) / (FRICTION * GRAVITY * DURATION):.5g}")
