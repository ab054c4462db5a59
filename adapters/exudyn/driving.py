"""Drive the coordinates of a kinematic tree in Exudyn, and stop them by Exudyn's elastic limit stops.

Held efforts are in the `jointForceVector` of the tree, which may change between steps. A law is the tree's user function of
forces, which the solvers evaluate with the accelerations, at each stage of an explicit solver. The implicit solvers carry the
acceleration at the end of a step into the next, so that a jump of an effort costs them an error of first order. A limit stop is
a spring with a damper that also pulls a joint that returns; a stop of a case never pulls.
"""

from collections.abc import Sequence

import exudyn
import numpy as np
from exudyn import itemInterface
from numpy.typing import NDArray

from bodycheck.adapters.contract import Law, Method
from bodycheck.adapters.mechanisms import bounds, stops_of
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reference.trajectory import Array

#: A coordinate (rad or m) that no joint reaches, for the side on which a joint has no stop.
FAR = 1e9


class Actuated:
    """The driven coordinates of a tree.

    Parameters
    ----------
    system
        The system with the tree.
    acting
        The joint of each coordinate of the tree.
    mechanism
        The mechanism, whose driven joints have one coordinate each.
    """

    def __init__(self, system: "exudyn.MainSystem", acting: Sequence[Joint], mechanism: Mechanism) -> None:
        names = [joint.name for joint in acting]
        driven = [names.index(mechanism.joints[index].name) for index in mechanism.driven]
        self.system, self.places = system, np.array(driven, dtype=np.int64)
        self.constant = np.array([joint.effort for joint in acting])
        self.tree: object = None
        self.law: Law | None = None

    def state(self) -> tuple[Array, Array]:
        """Return the coordinates and velocities (j,) of the joints."""
        data = self.system.systemData
        return np.array(data.GetODE2Coordinates())[self.places], np.array(data.GetODE2Coordinates_t())[self.places]

    def apply(self, efforts: Array) -> None:
        """Exert efforts (j,) from now on, in addition to the constant ones and to those of the law."""
        self.system.SetObjectParameter(self.tree, "jointForceVector", self._forces(self.constant, efforts).tolist())

    def obey(self, law: Law) -> None:
        """Exert from now on the efforts of a law."""
        self.law = law

    def force(self, _system: object, time: float, _item: object, q: Sequence[float], v: Sequence[float]) -> list[float]:
        """Return the efforts of the law, as a user function of a tree."""
        if self.law is None:
            return [0.0] * len(self.constant)
        efforts = self.law(time, np.array(q)[self.places], np.array(v)[self.places])
        return [float(effort) for effort in self._forces(np.zeros(len(self.constant)), efforts)]

    def _forces(self, others: Array, efforts: Array) -> NDArray[np.float64]:
        forces = others.copy()
        forces[self.places] += efforts
        return forces


def follows(mechanism: Mechanism, method: Method) -> bool:
    """Return whether a law with a state drives joints: a continuous controller, or elastic stops as efforts."""
    return any(each.rate is None for each in mechanism.controllers) or method.option("limits") == "effort"


def add_stops(system: "exudyn.MainSystem", acting: Sequence[Joint], node: object, method: Method) -> None:
    """Add to a system the stops of the coordinates of a tree."""
    stopped = [(number, stops) for number, joint in enumerate(acting) if (stops := stops_of(joint, method)) is not None]
    if not stopped:
        return
    point = system.AddNode(itemInterface.NodePointGround())
    ground = system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=point, coordinate=0))
    for number, stops in stopped:
        coordinate = system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=node, coordinate=number))
        state = system.AddNode(itemInterface.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3))
        lower, upper = bounds(stops, FAR)
        system.AddObject(
            itemInterface.CoordinateSpringDamperExt(
                markerNumbers=[ground, coordinate],
                nodeNumber=state,
                useLimitStops=True,
                limitStopsLower=lower,
                limitStopsUpper=upper,
                limitStopsStiffness=stops.stiffness,
                limitStopsDamping=stops.damping,
                frictionProportionalZone=1.0,  # without friction it has no effect
            )
        )
