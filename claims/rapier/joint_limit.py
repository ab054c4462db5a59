"""Print how far a hinge at 2 rad/s goes beyond its limit in Rapier, its rate afterwards, and what a motor of a joint has.

The limits lie at ten places within the way of one step of 1 ms.
"""

import math

import rapier3d

beyond, rates = [], []
for part in range(10):
    world, limit = rapier3d.PhysicsWorld(gravity=(0.0, 0.0, 0.0)), 0.1 + (part + 0.5) / 10 * 2e-3
    world.integration_parameters.dt = 1e-3
    properties = rapier3d.MassProperties((0, 0, 0), 1.0, (0.01, 0.01, 0.01))
    ground = world.add_body(rapier3d.RigidBody.fixed())
    arm = world.add_body(rapier3d.RigidBody.dynamic().angvel((2.0, 0.0, 0.0)).additional_mass_properties(properties))
    joint = rapier3d.GenericJoint.builder(rapier3d.JointAxesMask.LOCKED_REVOLUTE_AXES)
    world.impulse_joints.insert(ground, arm, joint.limits(rapier3d.JointAxis.ANG_X, -1.0, limit), True)
    body = world.rigid_bodies[arm]
    turns = [world.step() or body.rotation.quaternion for _ in range(300)]
    beyond.append(max(2 * math.atan2(x, w) for x, _, _, w in turns) - limit)
    rates.append(abs(body.angvel.x))
print("beyond", max(beyond))
print("rate", max(rates))
print("motor", ",".join(name for name in dir(rapier3d.JointMotor) if not name.startswith("_")))
