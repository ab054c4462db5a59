"""Print the kinetic energy after an elastic, frictionless impact of two equal bodies over the energy before it, in Rapier."""

from importlib.metadata import version

import numpy as np
import rapier3d

HALF = np.array([0.1, 0.15, 0.2])  # half the lengths of the boxes (m); each has 1 kg
MOMENTS = (HALF @ HALF - HALF**2) / 3
CENTRED, ASIDE = (0.0, 0.0), (0.11, 0.07)  # displacements (m) in the plane of the faces


def energy(body):
    """Return the kinetic energy (J) of a body."""
    w, vector = body.rotation.quaternion[3], -np.array(body.rotation.quaternion[:3])
    spin = np.array(body.angvel.to_tuple())
    spin = spin + 2 * np.cross(vector, np.cross(vector, spin) + w * spin)  # along the axes of the body
    return (np.sum(np.square(body.linvel.to_tuple())) + MOMENTS @ spin**2) / 2


def ratio(displacement, timestep, shape=lambda: rapier3d.Collider.cuboid(*HALF.tolist()), **parameters):
    """Return the energy after the impact over the energy before it."""
    world, bodies = rapier3d.PhysicsWorld(gravity=(0, 0, 0)), []
    world.integration_parameters.dt = timestep
    for name, value in parameters.items():
        setattr(world.integration_parameters, name, value)
    for place, speed in (((0, 0, 0), 0), ((0.45, *displacement), -3)):
        body = rapier3d.RigidBody.dynamic().translation(place).linvel((speed, 0, 0)).can_sleep(False)
        body = body.additional_mass_properties(rapier3d.MassProperties((0, 0, 0), 1.0, tuple(MOMENTS.tolist())))
        collider = shape().friction(0).restitution(1).density(0)
        bodies.append(world.rigid_bodies[world.add_body(body, [collider])])
    before = sum(map(energy, bodies))
    for _ in range(round(0.15 / timestep)):
        world.step()
    return sum(map(energy, bodies)) / before


def show(words, displacement, **options):
    """Print the ratios with several time steps."""
    print(f"{words:48}", *(f"{ratio(displacement, step, **options):7.4f}" for step in (1 / 60, 0.004, 0.001, 0.00025)))


print(f"rapier3d {version('rapier3d')}")
print(f"{'time step (s)':48}", *(f"{step:7.5f}" for step in (1 / 60, 0.004, 0.001, 0.00025)))
show("balls", CENTRED, shape=lambda: rapier3d.Collider.ball(0.1))
show("boxes, centred", CENTRED)
show("boxes, aside", ASIDE)
show("boxes, aside, 20 internal PGS iterations", ASIDE, num_internal_pgs_iterations=20)
show("boxes, aside, 20 stabilization iterations", ASIDE, num_internal_stabilization_iterations=20)
show("boxes, aside, 20 solver iterations", ASIDE, num_solver_iterations=20)
show("boxes, aside, 1 solver iteration", ASIDE, num_solver_iterations=1)
show("boxes, aside, no warm start", ASIDE, warmstart_coefficient=0.0)
show("boxes, aside, no contact recycling", ASIDE, contact_recycling=False)
show("boxes, aside, no corrective velocity", ASIDE, normalized_max_corrective_velocity=0.0)
