"""Print which part of its rate a CoordinateLimitForce returns to a hinge, and what a stop that pulls, or only pushes, would."""

import math

import opensim

opensim.Logger.setLevelString("Off")
model, degree = opensim.Model(), math.pi / 180
model.setGravity(opensim.Vec3(0))
body = opensim.Body("arm", 1.0, opensim.Vec3(0), opensim.Inertia(0.01, 0.01, 0.01))
joint = opensim.PinJoint("pin", model.getGround(), body)
model.addBody(body)
model.addJoint(joint)
# 40 N m/rad on both sides, 0.3 N m s/rad, and a transition of a millionth of a degree.
sides = 0.1 / degree, 40 * degree, -1 / degree, 40 * degree
model.addForce(opensim.CoordinateLimitForce(joint.get_coordinates(0).getName(), *sides, 0.3 * degree, 1e-6))
state = model.initSystem()
state.updU().set(0, 2.0)
manager = opensim.Manager(model)
manager.setIntegratorAccuracy(1e-9)
manager.initialize(state)
print("returned", -manager.integrate(0.3).getU().get(0) / 2)
ratio = 0.15 / math.sqrt(40 * 0.01)
swing = ratio / math.sqrt(1 - ratio**2)
print("pulls", math.exp(-math.pi * swing))
print("pushes", math.exp(-swing * (math.pi - math.acos(1 - 2 * ratio**2))))
