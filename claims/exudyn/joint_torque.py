"""Exudyn's force and torque in a hinge along z that holds 2 kg, 0.3 m beside it along x, against their weight along z."""

import exudyn as exu
import numpy as np
from exudyn import itemInterface, utilities

exu.config.printToConsole = False
system = exu.SystemContainer().AddSystem()
ground = system.AddObject(itemInterface.ObjectGround())
node = system.AddNode(itemInterface.NodeRigidBodyRotVecLG(referenceCoordinates=[0] * 6))
inertia = utilities.RigidBodyInertia(2.0, np.diag([0.02, 0.05, 0.06]), [0.3, 0, 0], inertiaTensorAtCOM=True)
arguments = {"mass": 2.0, "inertia": inertia.GetInertia6D(), "centerOfMass": inertia.COM()}
arm = system.AddObject(itemInterface.ObjectRigidBody(nodeNumber=node, **arguments))
weight = system.AddMarker(itemInterface.MarkerBodyMass(bodyNumber=arm))
system.AddLoad(itemInterface.LoadMassProportional(markerNumber=weight, loadVector=[0, 0, -9.81]))
markers = [system.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=body)) for body in (ground, arm)]
hinge = system.AddObject(itemInterface.ObjectJointRevoluteZ(markerNumbers=markers))
kinds = exu.OutputVariableType.ForceLocal, exu.OutputVariableType.TorqueLocal
sensor = itemInterface.SensorObject
sensors = [system.AddSensor(sensor(objectNumber=hinge, outputVariableType=kind, writeToFile=False)) for kind in kinds]
system.Assemble()
settings = exu.SimulationSettings()
settings.solution.file.write = False
system.SolveDynamic(settings)
for name, number in zip(("force", "torque"), sensors, strict=True):
    for axis, value in zip("xyz", system.GetSensorValues(number), strict=True):
        print(f"{name}_{axis} {value + 0.0:.5g}")
