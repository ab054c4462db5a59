"""Rapier's substeps, its limits of speed, and its sleeping, by its default parameters."""

import rapier3d


def world_and_body(step, gravity=0.0, **motion):
    world = rapier3d.PhysicsWorld(gravity=(0.0, 0.0, -gravity))
    world.integration_parameters.dt = step
    builder = rapier3d.RigidBody.dynamic().additional_mass_properties(rapier3d.MassProperties((0, 0, 0), 1.0, (1.0, 1.0, 1.0)))
    for name, value in motion.items():
        builder = getattr(builder, name)(value)
    return world, world.rigid_bodies[world.add_body(builder)]


world, body = world_and_body(0.01, 9.81)
world.step()
print(f"fall_in_a_step_over_g_h2 {-body.translation.z / 9.81 / 0.01**2:.6g}")
world, body = world_and_body(0.01, linvel=(1000.0, 0.0, 0.0))
world.step()
print(f"largest_speed {body.linvel.x:.6g}")
world, body = world_and_body(0.002, angvel=(1000.0, 0.0, 0.0))
world.step()
print(f"largest_spin {body.angvel.x:.6g}")
for name, speed in (("below", 0.099), ("above", 0.101)):
    world, body = world_and_body(0.002, linvel=(speed, 0.0, 0.0))
    awake = next((number for number in range(1, 2000) if world.step() or body.is_sleeping), 0)
    print(f"asleep_after_{name} {awake * 0.002:.6g}")
