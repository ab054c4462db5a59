"""Print how far (m) a ball on a ramp is from its exact place at most in 2 s, on Exudyn's contact of a sphere."""

import exudyn as exu
import numpy as np

exu.config.printToConsole = False
system = (container := exu.SystemContainer()).AddSystem()
cos, sin, zeros, time_constant = np.cos(0.3), np.sin(0.3), [0.0] * 6, 3e-3
start = [0.1 * sin, 0, 0.1 * cos, 0, 0, 0]
ball = {"referenceCoordinates": zeros, "initialCoordinates": start, "initialVelocities": zeros}
node = system.AddNode(exu.itemInterface.NodeRigidBodyRotVecLG(**ball))
ball = {"nodeNumber": node, "mass": 1, "inertia": [0.004, 0.004, 0.004, 0, 0, 0], "centerOfMass": [0, 0, 0]}
body = system.AddObject(exu.itemInterface.ObjectRigidBody(**ball))
weight = system.AddMarker(exu.itemInterface.MarkerBodyMass(bodyNumber=body))
system.AddLoad(exu.itemInterface.LoadMassProportional(markerNumber=weight, loadVector=[0, 0, -9.81]))
ground = system.AddMarker(exu.itemInterface.MarkerNodeRigid(nodeNumber=system.AddNode(exu.itemInterface.NodePointGround())))
plane = exu.Vector3DList([[x * cos, y, -x * sin] for x, y in ((-1e3, -1e3), (3e3, -1e3), (-1e3, 3e3))])
law = {"contactStiffness": 1 / time_constant**2, "contactDamping": 2 / time_constant, "dynamicFriction": 0.3}
pair = [system.AddMarker(exu.itemInterface.MarkerBodyRigid(bodyNumber=body)), ground]
data = system.AddNode(exu.itemInterface.NodeGenericData(initialCoordinates=[0] * 4, numberOfDataCoordinates=4))
of = {"markerNumbers": pair, "nodeNumber": data, "sphereRadius": 0.1, "trianglePoints": plane}
system.AddObject(exu.itemInterface.ObjectContactSphereTriangle(**of, **law))
place = {"storeInternal": True, "outputVariableType": exu.OutputVariableType.Position}
seen = system.AddSensor(exu.itemInterface.SensorNode(nodeNumber=node, **place))
system.Assemble()
(settings := exu.SimulationSettings()).solution.file.write = settings.timeIntegration.newton.useModifiedNewton = False
(steps := settings.timeIntegration).numberOfSteps, steps.endTime, steps.generalizedAlpha.spectralRadius = 1000, 2, 1
settings.solution.sensors.writePeriod, way = 0.002, system.SolveDynamic(settings) and system.GetSensorStoredData(seen)
exact = start[:3] + 5 / 14 * 9.81 * sin * way[:, :1] ** 2 * [cos, 0, -sin]
print("error", np.linalg.norm(way[:, 1:] - exact, axis=1)[::2].max())
