"""Print below which speed (m/s) a ball that rolls on level ground falls asleep in Rapier within 3 s."""

import rapier3d

STEP, RADIUS = 1 / 60, 0.1


def asleep(speed):
    world = rapier3d.PhysicsWorld(gravity=(0, 0, -9.81))
    world.integration_parameters.dt = STEP
    world.add_collider(rapier3d.Collider.halfspace((0, 0, 1)).friction(0.5))
    builder = rapier3d.RigidBody.dynamic().translation((0, 0, RADIUS)).linvel((speed, 0, 0)).angvel((0, speed / RADIUS, 0))
    builder = builder.additional_mass_properties(rapier3d.MassProperties((0, 0, 0), 1.0, (0.004, 0.004, 0.004)))
    shape = rapier3d.Collider.ball(RADIUS).density(0).friction(0.5)
    ball = world.rigid_bodies[world.add_body(builder, [shape])]
    _ = [world.step() for _ in range(180)]
    return ball.is_sleeping


low, high = 0.01, 1.0
while high - low > 1e-5:
    middle = (low + high) / 2
    low, high = (middle, high) if asleep(middle) else (low, middle)
print(f"speed {low}")
