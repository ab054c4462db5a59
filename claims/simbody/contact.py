"""Print how far (m) a ball on a ramp is from its exact place at most in 2 s, on OpenSim's contact of Hunt and Crossley."""

import numpy as np
import opensim as osim

osim.Logger.setLevelString("Off")
incline, radius, gravity, mass, h = 0.3, 0.1, 9.81, 1.0, 0.002
model, zero = osim.Model(), osim.Vec3(0)
model.setGravity(osim.Vec3(0, 0, -gravity))
model.addBody(ball := osim.Body("ball", mass, zero, osim.Inertia(0.004, 0.004, 0.004)))
model.addJoint(joint := osim.FreeJoint("joint", model.getGround(), ball))
model.addContactGeometry(osim.ContactSphere(radius, zero, ball, "sphere"))
model.addContactGeometry(osim.ContactHalfSpace(zero, osim.Vec3(0, np.pi / 2 + incline, 0), model.getGround(), "plane"))
depth, force = 0.01 * radius, osim.HuntCrossleyForce()
force.setStiffness(2**1.5 * mass * gravity / (4 / 3 * radius**0.5 * depth**1.5))
force.setDissipation(2 * (1.5 * gravity / depth) ** 0.5 / (1.5 * gravity))
force.setStaticFriction(0.3), force.setDynamicFriction(0.3), force.setViscousFriction(0)
force.addGeometry("plane"), force.addGeometry("sphere"), model.addForce(force)
state, normal = model.initSystem(), np.array([np.sin(incline), 0, np.cos(incline)])
for axis in range(3):
    joint.get_coordinates(3 + axis).setValue(state, radius * normal[axis], False)
manager = osim.Manager(model)
manager.setIntegratorMethod(osim.Manager.IntegratorMethod_RungeKuttaMerson)
manager.setIntegratorFixedStepSize(h)
manager.initialize(state)
seen = [ball.getPositionInGround(manager.integrate(number * h * 10)).to_numpy() for number in range(1, 101)]
way = 5 / 14 * gravity * np.sin(incline) * (np.arange(1, 101) * h * 10) ** 2
exact = radius * normal + way[:, None] * [np.cos(incline), 0, -np.sin(incline)]
print("error", np.linalg.norm(seen - exact, axis=1).max())
