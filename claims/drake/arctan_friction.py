"""The part of Coulomb's friction that a block lacks that slides down Drake's half space in hydroelastic contact, after 2 s."""

import math

import pydrake.all as drake

INCLINE, FRICTION, GRAVITY = 0.4676396037632291, 0.5, 9.81


def speeds(method):
    plant, _ = drake.AddMultibodyPlantSceneGraph(builder := drake.DiagramBuilder(), 0.0)
    turn = drake.RotationMatrix.MakeYRotation(INCLINE)
    block = plant.AddRigidBody("block", drake.SpatialInertia.SolidBoxWithMass(1.0, 0.2, 0.2, 0.1))
    for body, pose, shape in ((block, [], drake.Box(0.2, 0.2, 0.1)), (plant.world_body(), [turn], drake.HalfSpace())):
        material, friction = drake.ProximityProperties(), drake.CoulombFriction(FRICTION, FRICTION)
        drake.AddContactMaterial(friction=friction, properties=material)
        edge, add = ([], drake.AddRigidHydroelasticProperties) if pose else ([1, 1e7], drake.AddCompliantHydroelasticProperties)
        add(*edge, material)
        plant.RegisterCollisionGeometry(body, drake.RigidTransform(*pose), shape, "shape", material)
    plant.set_name("plant")
    plant.Finalize()
    context = plant.GetMyMutableContextFromRoot((simulator := drake.Simulator(builder.Build())).get_mutable_context())
    plant.SetPositions(context, [*turn.ToQuaternion().wxyz(), 0.05 * math.sin(INCLINE), 0, 0.05 * math.cos(INCLINE)])
    drake.ResetIntegratorFromFlags(simulator, method, 0.001).set_fixed_step_mode(True)
    return [math.hypot(*plant.GetVelocities(context)[3:]) for end in (2.0, 2.5) if simulator.AdvanceTo(end)]


for method, (before, after) in ((name, speeds(name)) for name in ("radau3", "cenic")):
    friction = (GRAVITY * math.sin(INCLINE) - (after - before) / 0.5) / (FRICTION * GRAVITY * math.cos(INCLINE))
    print(f"{method} {1 - friction:.4g}\narctan_{method} {1 - 2 / math.pi * math.atan((before + after) / 2 / 1e-4):.4g}")
