"""The speed of a ball on Drake's half space, a ramp of 0.3 rad, after 1 s, over that of a ball that rolls without slip."""

import math

import pydrake.all as drake

INCLINE = 0.3


def ratio(hydroelastic, dissipation):
    plant, _ = drake.AddMultibodyPlantSceneGraph(builder := drake.DiagramBuilder(), 0.001)
    ball = plant.AddRigidBody("ball", drake.SpatialInertia.SolidSphereWithMass(1.0, 0.1))
    turn = drake.RigidTransform(drake.RotationMatrix.MakeYRotation(INCLINE))
    for body, pose, shape in ((ball, drake.RigidTransform(), drake.Sphere(0.1)), (plant.world_body(), turn, drake.HalfSpace())):
        material, friction = drake.ProximityProperties(), drake.CoulombFriction(0.3, 0.3)
        drake.AddContactMaterial(dissipation=dissipation, friction=friction, properties=material)
        if hydroelastic and body is ball:
            drake.AddCompliantHydroelasticProperties(0.02, 1e7, material)
        elif hydroelastic:
            drake.AddRigidHydroelasticProperties(material)
        plant.RegisterCollisionGeometry(body, pose, shape, "shape", material)
    plant.Finalize()
    context = plant.GetMyMutableContextFromRoot((simulator := drake.Simulator(builder.Build())).get_mutable_context())
    plant.SetPositions(context, [1, 0, 0, 0, 0.1 * math.sin(INCLINE), 0, 0.1 * math.cos(INCLINE)])
    simulator.AdvanceTo(1.0)
    return math.hypot(*plant.GetVelocities(context)[3:]) / (5 / 7 * 9.81 * math.sin(INCLINE))


for name, contact in (("point", (False, 50.0)), ("hydroelastic", (True, 50.0)), ("undamped", (True, 0.0))):
    print(f"{name} {ratio(*contact):.5g}")
