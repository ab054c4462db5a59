"""DART's wrenches in a hinge that holds 2 kg, 0.3 m beside it, and the acceleration of the link when it falls."""

import dartpy as dart
import numpy as np

world = dart.simulation.World()
world.setGravity([0, 0, -9.81])
arm = dart.dynamics.Skeleton("arm")
joint, link = arm.createRevoluteJointAndBodyNodePair(None)
joint.setAxis([0, 1, 0])
link.setInertia(dart.dynamics.Inertia(2.0, [0.3, 0, 0], np.diag([0.02, 0.05, 0.06])))
world.addSkeleton(arm)
joint.setCommand(0, -2 * 9.81 * 0.3)
world.step(False)
print(f"body_force {link.getBodyForce()[5]:.5g}\nto_child {joint.getWrenchToChildBodyNode()[5]:.5g}")
point = dart.dynamics.SimpleFrame(link, "imu", dart.math.Isometry3())
ground = dart.dynamics.Frame.World()
print(f"at_rest {np.linalg.norm(point.getLinearAcceleration(ground, point)):.5g}")
