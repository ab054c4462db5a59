"""The reaction on a link of 2 kg that a joint holds, turned by 1 rad about the y axis, in OpenSim (N), against gravity."""

import math

import opensim

model = opensim.Model()
model.setGravity(opensim.Vec3(0, 0, -9.81))
link = opensim.Body("link", 2.0, opensim.Vec3(0.3, 0, 0), opensim.Inertia(0.02, 0.2, 0.2))
turned = opensim.Vec3(0, 1.0, 0)
origin = opensim.Vec3(0)
joint = opensim.WeldJoint("joint", model.getGround(), origin, turned, link, origin, opensim.Vec3(0))
model.addBody(link)
model.addJoint(joint)
state = model.initSystem()
model.realizeAcceleration(state)
force = joint.calcReactionOnChildExpressedInGround(state).get(1).to_numpy()
print(f"along_x {abs(force[0]):.4g}\nalong_z {force[2]:.5g}\nlink_z {2 * 9.81 * math.cos(1.0):.5g}")
names = [name for name in dir(joint) if name.startswith("calcReaction")]
print(f"others {sum('Ground' not in name for name in names)}")
