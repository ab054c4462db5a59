"""A ball that is dropped on Drake's half space with the dissipation of a restitution of 0.8: its depth, rebound and energy."""

import pydrake.all as drake


def motion(step, method=""):
    plant, _ = drake.AddMultibodyPlantSceneGraph(builder := drake.DiagramBuilder(), step)
    inertia = drake.SpatialInertia.SolidSphereWithMass(1.0, 0.1)
    for body, shape in ((plant.AddRigidBody("ball", inertia), drake.Sphere(0.1)), (plant.world_body(), drake.HalfSpace())):
        material, friction = drake.ProximityProperties(), drake.CoulombFriction(0.3, 0.3)
        drake.AddContactMaterial(dissipation=0.1191364139378417, friction=friction, properties=material)
        plant.RegisterCollisionGeometry(body, drake.RigidTransform(), shape, "shape", material)
    plant.set_name("plant")
    plant.Finalize()
    simulator, states = drake.Simulator(builder.Build()), []
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetPositions(context, [1, 0, 0, 0, 0, 0, 0.6])
    if method:
        drake.ResetIntegratorFromFlags(simulator, method, 0.1)
        simulator.get_mutable_integrator().set_target_accuracy(1e-3)
    simulator.set_monitor(lambda _: states.append(plant.GetPositionsAndVelocities(context)[[6, 12]]))
    simulator.AdvanceTo(4.0)
    return states


for name, step in (("coarse", 1e-3), ("fine", 1e-4)):
    states = motion(step)
    print(f"penetration_{name} {0.1 - min(z for z, _ in states[:: round(0.004 / step)]):.12g}")
    print(f"rebound_{name} {next(v for z, v in states if z > 0.1 and v > 0) / 3.1321:.4g}")
print(f"energy_cenic {max(v * v / 2 + 9.81 * (z - 0.1) for z, v in motion(0.0, 'cenic')) / 4.905:.4g}")
