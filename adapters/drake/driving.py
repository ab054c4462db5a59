"""Drive the joints of a plant in Drake: efforts are inputs of Drake's actuators.

A law is a system that Drake evaluates wherever it evaluates forces, so that every integrator keeps its order; the discrete
plant evaluates it at the start of each step.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.framework import LeafSystem

from bodycheck.adapters.contract import Law, Method
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array


class Inputs(LeafSystem):  # type: ignore[misc]  # Drake has no types here
    """The inputs of all actuators of a plant: held ones, and those of a law.

    Parameters
    ----------
    states, inputs
        The numbers of coordinates and velocities of the plant, and of its actuators.
    """

    def __init__(self, states: int, inputs: int) -> None:
        LeafSystem.__init__(self)  # Drake requires a call by this name
        self.joints: Actuated | None = None
        self.state = self.DeclareVectorInputPort("state", states)
        self.held = self.DeclareVectorInputPort("held", inputs)
        self.DeclareVectorOutputPort("inputs", inputs, self._inputs)

    def _inputs(self, context: Any, inputs: Any) -> None:
        given = np.array(self.held.Eval(context))
        if self.joints is not None and self.joints.law is not None:
            state, joints = self.state.Eval(context), self.joints
            given[joints.in_inputs] += self.joints.law(context.get_time(), state[joints.in_q], state[joints.in_state])
        inputs.SetFromVector(given)


class Actuated:
    """The driven joints of a plant.

    Parameters
    ----------
    plant, context
        The plant, and its context.
    port, port_context
        The input port of the held inputs of all actuators, and the context of its system.
    constant
        The constant inputs of all actuators.
    joints, inputs
        The driven joints of the plant, and the indices of their actuators.
    """

    def __init__(
        self, plant: Any, context: Any, port: tuple[Any, Any], constant: Array, joints: Sequence[Any], inputs: Sequence[int]
    ) -> None:
        self.plant, self.context, (self.port, self.port_context), self.constant = plant, context, port, constant
        self.in_inputs = np.array(inputs, dtype=np.int64)
        self.in_q = _indices(joint.position_start() for joint in joints)
        self.in_v = _indices(joint.velocity_start() for joint in joints)
        self.in_state = plant.num_positions() + self.in_v
        self.law: Law | None = None

    def state(self) -> tuple[Array, Array]:
        """Return the coordinates and velocities (j,) of the joints."""
        return self.plant.GetPositions(self.context)[self.in_q], self.plant.GetVelocities(self.context)[self.in_v]

    def apply(self, efforts: Array) -> None:
        """Exert efforts (j,) from now on, in addition to the constant ones and to those of the law."""
        inputs = self.constant.copy()
        inputs[self.in_inputs] += efforts
        self.port.FixValue(self.port_context, inputs)  # what depends on the inputs is computed again

    def obey(self, law: Law) -> None:
        """Exert from now on the efforts of a law."""
        self.law = law
        self.apply(np.zeros(len(self.in_inputs)))


def follows(mechanism: Mechanism, method: Method) -> bool:
    """Return whether a law with a state drives joints: a continuous controller, or elastic stops as efforts."""
    return any(each.rate is None for each in mechanism.controllers) or method.option("limits") == "effort"


def _indices(numbers: Any) -> NDArray[np.int64]:
    return np.array(list(numbers), dtype=np.int64)
