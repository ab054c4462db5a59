"""Print the relative change of the kinetic energy of two equal bodies in an elastic impact without friction, in Rapier."""

import numpy as np
import rapier3d

HALF = np.array([0.1, 0.15, 0.2])  # half the lengths of the boxes (m); each has 1 kg
MOMENTS = (HALF @ HALF - HALF**2) / 3


def largest(displacement, timestep=0.002, shape=lambda: rapier3d.Collider.cuboid(*HALF.tolist())):
    changes = []
    for gap in (0.05, 0.0517, 0.0535):  # the impact is at other instants within a step
        world, bodies, energy = rapier3d.PhysicsWorld(gravity=(0, 0, 0)), [], 0.0
        world.integration_parameters.dt = timestep
        for place, speed in (((0, 0, 0), 0), ((0.2 + gap, *displacement), -3)):
            body = rapier3d.RigidBody.dynamic().translation(place).linvel((speed, 0, 0)).can_sleep(False)
            body = body.additional_mass_properties(rapier3d.MassProperties((0, 0, 0), 1.0, tuple(MOMENTS.tolist())))
            bodies.append(world.add_body(body, [shape().friction(0).restitution(1).density(0)]))
        for _ in range(round(0.1 / timestep)):
            world.step()
        for body in (world.rigid_bodies[handle] for handle in bodies):
            w, q, spin = body.rotation.quaternion[3], -np.array(body.rotation.quaternion[:3]), [*body.angvel.to_tuple()]
            spin = spin + 2 * np.cross(q, np.cross(q, spin) + w * np.array(spin))  # along the axes of the body
            energy += (np.sum(np.square(body.linvel.to_tuple())) + MOMENTS @ spin**2) / 2
        changes.append(energy / 4.5 - 1)
    return max(changes, key=abs)


print(f"aside {largest((0.11, 0.07))}\naside_finer {largest((0.11, 0.07), 0.00025)}\ncentred_lost {-largest((0, 0))}")
print("balls", largest((0, 0), shape=lambda: rapier3d.Collider.ball(0.1)))
