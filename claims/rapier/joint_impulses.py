"""Rapier's impulses over the time step (N, N m) in a joint that locks 2 kg, 0.3 m beside it, against their weight along z."""

import numpy as np
import rapier3d as r

for name, substeps in (("four", 4), ("one", 1)):
    world = r.PhysicsWorld(gravity=(0, 0, -9.81))
    world.integration_parameters.dt = 0.002
    world.integration_parameters.num_solver_iterations = substeps
    mass = r.MassProperties((0.3, 0, 0), 2.0, (0.002, 0.05, 0.05))
    arm = world.add_body(r.RigidBody.dynamic().additional_mass_properties(mass).can_sleep(False))
    here = r.Isometry3((0, 0, 0), r.Rotation3(1, 0, 0, 0))
    locked = r.GenericJoint.builder(r.JointAxesMask.LOCKED_FIXED_AXES).local_frame1(here).local_frame2(here)
    joint = world.impulse_joints.insert(world.add_body(r.RigidBody.fixed()), arm, locked, True)
    for _ in range(50):
        world.step()
    impulses = np.array(world.impulse_joints[joint].impulses) / 0.002
    print(f"along_z_{name} {impulses[2]:.5g}\nmoment_{name} {np.linalg.norm(impulses[3:]):.3g}")
