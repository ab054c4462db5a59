"""Print the largest error of the slide of a slider-crank within 4 s in Exudyn, with the spectral radii 0.9 (default) and 1."""

import exudyn as exu
import numpy as np
from exudyn.itemInterface import MarkerKinematicTreeRigid, NodeGenericODE2, ObjectKinematicTree, SensorNode, SphericalJoint


def slide(step, radius):
    """Return the position of the slide every 40 ms."""
    mbs, settings = exu.SystemContainer().AddSystem(), exu.SimulationSettings()
    start = {"initialCoordinates": [-np.pi / 2, np.pi - np.arctan2(4, 3), 0.8], "initialCoordinates_t": [-5.0, 5.0, -3.0]}
    node = mbs.AddNode(NodeGenericODE2(referenceCoordinates=[0.0] * 3, numberOfODE2Coordinates=3, **start))
    inertias = exu.Matrix3DList([np.diag(m) for m in ([0.001, 0.03, 0.03], [0.001, 0.07, 0.07], [0.001] * 3)])
    masses = {"linkMasses": [1.0, 0.8, 0.5], "linkCOMs": exu.Vector3DList([[0.3, 0, 0], [0.5, 0, 0], [0, 0, 0]])}
    origins = {"jointOffsets": exu.Vector3DList([[0, 0, 0], [0.6, 0, 0], [0, 0, 0]]), "linkParents": [-1, 0, -1]}
    turns = {"jointTransformations": exu.Matrix3DList([np.eye(3)] * 3), "linkInertiasCOM": inertias, "gravity": [0, 0, -9.81]}
    kinds = [exu.JointType.RevoluteY, exu.JointType.RevoluteY, exu.JointType.PrismaticX]
    tree = mbs.AddObject(ObjectKinematicTree(nodeNumber=node, jointTypes=kinds, **origins, **masses, **turns))
    ends = [MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=n, localPosition=[2 - n, 0, 0]) for n in (1, 2)]
    mbs.AddObject(SphericalJoint(markerNumbers=[mbs.AddMarker(end) for end in ends], constrainedAxes=[1, 0, 1]))
    kind = exu.OutputVariableType.Coordinates
    sensor = mbs.AddSensor(SensorNode(nodeNumber=node, outputVariableType=kind, storeInternal=True, writeToFile=False))
    settings.solution.file.write, settings.solution.sensors.writePeriod, time = False, 0.04, settings.timeIntegration
    time.endTime, time.numberOfSteps, time.generalizedAlpha.spectralRadius, _ = 4.0, round(4 / step), radius, mbs.Assemble()
    return mbs.SolveDynamic(settings) and mbs.GetSensorStoredData(sensor)[:, 3]


exact = (4 * slide(2.5e-4, 0.9) - slide(5e-4, 0.9)) / 3
print(*(f"error_{1e3 * step:.0f}ms {np.abs(slide(step, 0.9) - exact).max()}" for step in (2e-3, 1e-3)), sep="\n")
print("radius_1", "fails" if np.abs(slide(1e-3, 1.0) - exact).max() > 1 else "passes")
