"""The stops of joints as MuJoCo's own limits, which are soft constraints.

MuJoCo pushes a joint that is beyond its stop by x back with the effort

    max(0, k x + b x' + d x'') / ((1 - d) w),

where `solreflimit` is (-k, -b), d is the impedance, which `solimplimit` sets, and w is the inverse inertia of the joint where
all coordinates are zero (`dof_invweight0`). With k = K (1 - d) w, b = C (1 - d) w, and with the smallest impedance that MuJoCo
allows, elastic stops of the stiffness K and the damping C arrive as they are, but for an additional inertia while they push:
d / ((1 - d) w), a ten-thousandth of the joint's own.

Rigid stops become the stiffest springs that a time step resolves by MuJoCo's documentation: those whose time constant is two
steps at critical damping, with the largest impedance. A spring that only pushes gives back the part e of a velocity that its
damping ratio z decides, and at critical damping e = exp(-2); for smaller restitutions it stays critical.

Where stops cease to act, `jnt_limited` of the model becomes 0 between two steps.
"""

import math
from collections.abc import Callable, Mapping
from fractions import Fraction

import mujoco
import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Strides
from bodycheck.adapters.mujoco.contact import numbers_written
from bodycheck.adapters.mujoco.stepping import Stepper
from bodycheck.reference.mechanisms.control import SLACK, Stops
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reference.trajectory import Array

#: The smallest and the largest impedance that MuJoCo uses: mjMINIMP and mjMAXIMP.
SOFTEST, HARDEST = 0.0001, 0.9999

#: A coordinate (rad or m) that no joint reaches, for the side on which a joint has no stop.
FAR = 1e9


def limited(mechanism: Mechanism, chosen: Mapping[str, str]) -> tuple[Joint, ...]:
    """Return the joints whose stops are limits of MuJoCo with the options of a method."""
    return () if chosen.get("limits") == "effort" else tuple(joint for joint in mechanism.joints if joint.stops is not None)


def attributes(joint: Joint, timestep: float, chosen: Mapping[str, str], inverse_inertia: float) -> dict[str, str]:
    """Return the attributes of a joint with stops.

    Parameters
    ----------
    joint
        The joint.
    timestep
        The time step (s).
    chosen
        The options of the method; `solreflimit` and `solimplimit` replace what follows from the stops.
    inverse_inertia
        `dof_invweight0` of the joint, which the limits of elastic stops need.
    """
    stops = joint.stops
    assert stops is not None
    lower, upper = (-FAR if stops.lower is None else stops.lower), (FAR if stops.upper is None else stops.upper)
    impedance, stiffness, damping = _rigid(stops, timestep) if stops.rigid else _elastic(stops, inverse_inertia)
    return {
        "limited": "true",
        "range": numbers_written(lower, upper),
        "solreflimit": numbers_written(-stiffness, -damping),
        "solimplimit": numbers_written(impedance, impedance, 0.001, 0.5, 1.0),
        **{key: chosen[key] for key in ("solreflimit", "solimplimit") if key in chosen},
    }


def _elastic(stops: Stops, inverse_inertia: float) -> tuple[float, float, float]:
    """Return the impedance, and the stiffness and the damping for MuJoCo, of elastic stops."""
    scale = (1 - SOFTEST) * inverse_inertia
    return SOFTEST, scale * stops.stiffness, scale * stops.damping


def _rigid(stops: Stops, timestep: float) -> tuple[float, float, float]:
    """Return the impedance, and the stiffness and the damping for MuJoCo, of rigid stops."""
    frequency, ratio = 1 / (2 * timestep), damping_ratio(stops.restitution or 0.0)
    return HARDEST, frequency**2, 2 * ratio * frequency


def damping_ratio(restitution: float) -> float:
    """Return the damping ratio, at most 1, at which a spring that only pushes gives back a part of a velocity."""
    low, high = 0.0, 1.0
    if restitution <= math.exp(-2):
        return high
    for _ in range(60):  # the part falls with the ratio
        middle = (low + high) / 2
        low, high = (middle, high) if returned(middle) > restitution else (low, middle)
    return low


def returned(ratio: float) -> float:
    """Return the part of a velocity that a spring with a damping ratio below 1 gives back if it only pushes."""
    swing = math.sqrt(1 - ratio**2)
    return math.exp(-ratio / swing * math.atan2(2 * ratio * swing, 2 * ratio**2 - 1))


def inverse_inertias(model: mujoco.MjModel, joints: tuple[Joint, ...]) -> dict[str, float]:
    """Return `dof_invweight0` of joints of a compiled model, by their names."""
    return {joint.name: float(model.dof_invweight0[model.joint(joint.name).dofadr[0]]) for joint in joints}


def released_after(stops_until: float, timestep: float) -> int:
    """Return the number of steps (s) after which stops no longer act that act until a time (s)."""
    return math.ceil(Fraction(stops_until) / Fraction(timestep) - SLACK)


class Releasing(Stepper):
    """A model whose limits of joints cease to act after a number of steps.

    Parameters
    ----------
    model, data, rows
        As those of `Stepper`; the model is changed.
    steps
        The number of steps.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, rows: Callable[[Array], Array], steps: int) -> None:
        super().__init__(model, data, rows)
        self.left = steps

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, bodies, 13) after each of n strides, as `Simulation.advance` does."""
        ends, left = np.cumsum(strides), self.left
        if not left or ends[-1] < left:
            self.left = max(left - int(ends[-1]), 0)
            return super().advance(strides)
        count = int(np.searchsorted(ends, left, side="right"))
        states = super().advance(np.diff(np.append(ends[:count], left), prepend=0))[:, :count]
        self.model.jnt_limited[:], self.left = 0, 0
        if count == len(ends):
            return states
        try:
            return np.concatenate([states, super().advance(np.diff(ends[count:], prepend=left))], axis=1)
        except EngineDiverged as signal:
            signal.states = np.concatenate([states, signal.states], axis=1)
            raise
