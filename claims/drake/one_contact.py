"""Print how many contacts a box on a ramp has in Drake at most, and how far (m) it is from its exact place after 1 s."""

import itertools

import numpy as np
import pydrake.all as drake

HALF, INCLINE, FRICTION, STEP = (0.1, 0.1, 0.05), 0.5, 0.3, 1e-3
TURN, START = drake.Quaternion(np.cos(INCLINE / 2), 0, np.sin(INCLINE / 2), 0), [0.02397127693021015, 0, 0.04387912809451864]
END = TURN.rotation() @ [9.81 * (np.sin(INCLINE) - FRICTION * np.cos(INCLINE)) / 2, 0, 0]
for name, shapes in (
    ("box", [(drake.Box(*(2 * half for half in HALF)), [0, 0, 0])]),
    ("points", [(drake.Sphere(0), corner) for corner in itertools.product(*((-half, half) for half in HALF))]),
):
    plant, _ = drake.AddMultibodyPlantSceneGraph(builder := drake.DiagramBuilder(), STEP)
    body = plant.AddRigidBody("box", drake.SpatialInertia.SolidBoxWithMass(1, *(2 * half for half in HALF)))
    on_plane = (plant.world_body(), drake.RigidTransform(TURN, [0, 0, 0]), drake.HalfSpace())
    for number, each in enumerate([on_plane, *((body, drake.RigidTransform(place), shape) for shape, place in shapes)]):
        own, friction = drake.ProximityProperties(), drake.CoulombFriction(FRICTION, FRICTION)
        drake.AddContactMaterial(friction=friction, properties=own)
        plant.RegisterCollisionGeometry(*each, f"shape {number}", own)
    plant.Finalize()
    simulator, contacts = drake.Simulator(builder.Build()), []
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetFreeBodyPose(context, body, drake.RigidTransform(TURN, START))
    for number in range(1000):
        simulator.AdvanceTo((number + 1) * STEP)
        contacts.append(plant.get_contact_results_output_port().Eval(context).num_point_pair_contacts())
    print(f"contacts_{name} {max(contacts)}\nerror_{name}", np.linalg.norm(plant.GetPositions(context)[4:] - START - END))
