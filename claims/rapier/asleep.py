"""Print when a block that slides down a ramp falls asleep in Rapier, and how far it is behind after 4 s."""

import math

import rapier3d

INCLINE, G, FRICTION, STEP = 0.4676396037632291, 9.81, 0.5, 1 / 60
SIN, COS = math.sin(INCLINE), math.cos(INCLINE)
world = rapier3d.PhysicsWorld(gravity=(0, 0, -G))
world.integration_parameters.dt = STEP
world.add_collider(rapier3d.Collider.halfspace((SIN, 0, COS)).friction(FRICTION))
start = (0.05 * SIN, 0, 0.05 * COS)
pose = rapier3d.Isometry3(start, rapier3d.Rotation3(math.cos(INCLINE / 2), 0, math.sin(INCLINE / 2), 0))
moments = ((0.1**2 + 0.05**2) / 3, (0.1**2 + 0.05**2) / 3, 0.02 / 3)
builder = rapier3d.RigidBody.dynamic().position(pose)
builder = builder.additional_mass_properties(rapier3d.MassProperties((0, 0, 0), 1.0, moments))
shape = rapier3d.Collider.cuboid(0.1, 0.1, 0.05).density(0).friction(FRICTION)
block = world.rigid_bodies[world.add_body(builder, [shape])]
asleep = None
for step in range(240):
    world.step()
    if asleep is None and block.is_sleeping:
        asleep = (step + 1) * STEP
way = G * (SIN - FRICTION * COS) * 4**2 / 2
exact = (start[0] + way * COS, 0, start[2] - way * SIN)
print(f"asleep {asleep}\nway {way}\nbehind {math.dist(block.translation.to_tuple(), exact)}")
