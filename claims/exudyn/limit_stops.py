"""Print which part of its rate a limit stop of Exudyn returns, and what a stop that pulls, or only pushes, would return."""

import math

import exudyn as exu
from exudyn.itemInterface import CoordinateSpringDamperExt, MarkerNodeCoordinate, Mass1D, Node1D, NodeGenericData
from exudyn.itemInterface import NodePointGround as Ground


def returned(step):
    mbs, settings = exu.SystemContainer().AddSystem(), exu.SimulationSettings()
    node = mbs.AddNode(Node1D(referenceCoordinates=[0.0], initialCoordinates=[0.0], initialVelocities=[2.0]))
    mbs.AddObject(Mass1D(nodeNumber=node, mass=0.01))
    ground = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(Ground()), coordinate=0))
    ends = [ground, mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=0))]
    data = mbs.AddNode(NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3))
    stop = {"useLimitStops": True, "limitStopsUpper": 0.1, "limitStopsLower": -1.0, "frictionProportionalZone": 1.0}
    law = {"limitStopsStiffness": 40.0, "limitStopsDamping": 0.3}
    mbs.AddObject(CoordinateSpringDamperExt(markerNumbers=ends, nodeNumber=data, **stop, **law))
    mbs.Assemble()
    settings.solution.file.write, time = False, settings.timeIntegration
    time.endTime, time.numberOfSteps = 0.3, round(0.3 / step)
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
    return -mbs.systemData.GetODE2Coordinates_t()[0] / 2


ratio = 0.15 / math.sqrt(40 * 0.01)
swing = ratio / math.sqrt(1 - ratio**2)
print(f"returned {returned(1e-5)}\npulls {math.exp(-math.pi * swing)}")
print("pushes", math.exp(-swing * (math.pi - math.acos(1 - 2 * ratio**2))))
