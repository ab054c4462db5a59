"""Print the mean speed (m/s) from 1 s to 2 s of a box in Drake on a ramp where nine tenths of its friction should hold it."""

import math

import numpy as np
import pydrake.all as drake

HALF, FRICTION, STEP = 0.1, 0.5, 1e-3
INCLINE = math.atan(0.9 * FRICTION)
TURN = drake.Quaternion(math.cos(INCLINE / 2), 0, math.sin(INCLINE / 2), 0)
START = [HALF * math.sin(INCLINE), 0, HALF * math.cos(INCLINE)]
plant, _ = drake.AddMultibodyPlantSceneGraph(builder := drake.DiagramBuilder(), STEP)
box = plant.AddRigidBody("box", drake.SpatialInertia.SolidBoxWithMass(1, 2 * HALF, 2 * HALF, 2 * HALF))
on_plane = (plant.world_body(), drake.RigidTransform(TURN, [0, 0, 0]), drake.HalfSpace())
for number, each in enumerate([on_plane, (box, drake.RigidTransform(), drake.Box(2 * HALF, 2 * HALF, 2 * HALF))]):
    own, friction = drake.ProximityProperties(), drake.CoulombFriction(FRICTION, FRICTION)
    drake.AddContactMaterial(friction=friction, properties=own)
    plant.RegisterCollisionGeometry(*each, f"shape {number}", own)
plant.Finalize()
simulator = drake.Simulator(builder.Build())
context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
plant.SetFreeBodyPose(context, box, drake.RigidTransform(TURN, START))
seen = [plant.GetPositions(context)[4:].copy() for time in (1, 2) if simulator.AdvanceTo(time) is not None]
print(f"creep {np.linalg.norm(seen[1] - seen[0])}")
