"""The total impulse over the time step (N) of Rapier's contacts of a sliding box of 1 kg with a plane, and its friction (N)."""

import rapier3d as r

world = r.PhysicsWorld(gravity=(0, 0, -9.81))
world.integration_parameters.dt = 0.002
world.add_collider(r.Collider.halfspace((0, 0, 1)))
mass = r.MassProperties((0, 0, 0), 1.0, (0.01, 0.01, 0.01))
builder = r.RigidBody.dynamic().translation((0, 0, 0.1)).additional_mass_properties(mass).linvel((1, 0, 0)).can_sleep(False)
box = world.add_body(builder, [r.Collider.cuboid(0.1, 0.1, 0.1).density(0).friction(0.3)])
for _ in range(50):
    before = world.rigid_bodies[box].linvel.to_tuple()[0]
    world.step()
(pair,) = world.narrow_phase.contact_pairs()
x, y, z = (component / 0.002 for component in pair.total_impulse().to_tuple())
print(f"along {abs(x):.4g}\nupward {z:.4g}\nbraking {(before - world.rigid_bodies[box].linvel.to_tuple()[0]) / 0.002:.4g}")
