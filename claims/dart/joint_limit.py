"""Print how far a hinge at 2 rad/s goes beyond its limit of 0.101 rad in DART with steps of 1 ms, and its rate afterwards."""

import dartpy as dart

world, skeleton = dart.simulation.World(), dart.dynamics.Skeleton("robot")
world.setGravity([0, 0, 0])
world.setTimeStep(1e-3)
joint, body = skeleton.createRevoluteJointAndBodyNodePair(None)
joint.setAxis([0, 1, 0])
body.setInertia(dart.dynamics.Inertia(1.0, [0, 0, 0], [[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]]))
joint.setPositionLowerLimit(0, -1.0)
joint.setPositionUpperLimit(0, 0.101)
joint.setLimitEnforcement(True)
joint.setVelocities([2.0])
world.addSkeleton(skeleton)
angles = [world.step() or joint.getPositions()[0] for _ in range(300)]
print("beyond", max(angles) - 0.101)
print("rate", joint.getVelocities()[0])
