"""Print the friction of a ball with spin in an impact in Rapier, over that of Coulomb's law."""

import math

import numpy as np
import rapier3d

FRICTION, G, FALL = 0.2, 9.81, 0.5


def impact(restitution, timestep):
    world = rapier3d.PhysicsWorld(gravity=(0, 0, -G))
    world.integration_parameters.dt = timestep
    world.add_collider(rapier3d.Collider.halfspace((0, 0, 1)).friction(FRICTION).restitution(restitution))
    mass = rapier3d.MassProperties((0, 0, 0), 1.0, (0.004, 0.004, 0.004))
    builder = rapier3d.RigidBody.dynamic().translation((0, 0, 0.1 + FALL)).linvel((2, 0.5, -1)).angvel((20, -40, 6))
    shape = rapier3d.Collider.ball(0.1).density(0).friction(FRICTION).restitution(restitution)
    ball = world.rigid_bodies[world.add_body(builder.additional_mass_properties(mass), [shape])]
    for _ in range(round(0.3 / timestep)):
        world.step()  # the ball has bounced once, at 0.233 s
    change = np.array(ball.linvel.to_tuple())[:2] - (2, 0.5)
    speed, slip = math.sqrt(1 + 2 * G * FALL), np.array((2 + 0.1 * 40, 0.5 + 0.1 * 20))
    exact = -FRICTION * (1 + restitution) * speed * slip / math.hypot(*slip)
    return math.hypot(*change) / math.hypot(*exact), math.dist(change, exact)


print(f"usual {impact(0.7, 1 / 60)[0]}\nshort {impact(0.7, 0.001)[0]}\nerror {impact(0.7, 0.001)[1]}")
