"""Truths of random cases against multiprecision arithmetic: error and bound of every figure."""

import time
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.casefile.case import parse
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.flight.flights import flights
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Brick, Ellipsoid, EulerAngles, Scene, Tensor
from bodycheck.reference.scenes import variable, vary
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from tests.support.multiprecision.arithmetic import MP, cross, dot, norm, real, vector
from tests.support.multiprecision.flight import Flight, Moment, read
from tests.support.random_cases import drawn

#: The figures that have a bound, by the name of the bound, and their units.
UNITS = {
    "error": "rad",
    "position_error": "m",
    "velocity_error": "m/s",
    "angular_velocity_error": "rad/s",
    "energy_error": "J",
    "angular_momentum_error": "kg m^2/s",
}

#: One rounding, in units of which errors are counted that are smaller.
ROUNDING = 2.0**-52


@dataclass(frozen=True, eq=False)
class Figure:
    """The errors of one figure of one case, as arrays (n,) over its instants, in the unit of the figure.

    Attributes
    ----------
    t
        Instants (s).
    error
        Distance from the multiprecision value.
    bound
        What the truth says that the error is at most.
    scale
        Size of the terms that the figure is the sum of; 1 for an attitude.
    """

    t: Array
    error: Array
    bound: Array
    scale: Array

    @property
    def broken(self) -> NDArray[np.intp]:
        """Indices of the instants at which the error is not within the bound."""
        return np.flatnonzero(~(self.error <= self.bound))

    @property
    def ratio(self) -> float:
        """The largest bound over the largest error, or over a rounding if that is larger; not a number where all are zero."""
        error = max(self.error.max(), ROUNDING * self.scale.max())
        bound = float(self.bound.max())
        return bound / float(error) if error > 0 else (np.inf if bound > 0 else np.nan)


@dataclass(frozen=True, eq=False)
class Check:
    """What was found of one case.

    Attributes
    ----------
    regime, seed
        Which case it is: `random_cases.drawn`.
    figures
        Its figures by the name of their bound.
    seconds
        CPU time of reading the case and of its truth (s).
    """

    regime: str
    seed: int
    figures: dict[str, Figure]
    seconds: tuple[float, float]


def check(regime: str, seed: int, *, vouched: bool, member: bool = False) -> Check:
    """Compare the truth of the case of a regime and a seed with multiprecision arithmetic. Raises what the truth raises.

    vouched: whether the truth is compared with its witnesses. They only add to its bounds, and could hide that one is broken.
    member: whether the truth is computed as that of a member of an ensemble, where the case can be one.
    """
    text, times = drawn(regime, seed)
    begun = time.process_time()
    case = parse(text, f"{regime}-{seed}")
    read_at = time.process_time()
    of_member = member and variable(case.scene)
    found = member_truth(case.scene, np.array(times)) if of_member else truth(case.scene, np.array(times), vouched=vouched)
    seconds = read_at - begun, time.process_time() - read_at
    return Check(regime, seed, figures(text, found), seconds)


def member_truth(scene: Scene, times: Array) -> Truth:
    """The truth of a scene as that of a member of an ensemble, in which all numbers vary."""
    definition, body, initial = scene.definition, scene.body, scene.initial
    assert definition is not None
    values: dict[str, object] = {"mass": body.mass, "gravity": scene.gravity, "angular_velocity": initial.angular_velocity}
    values |= {"position": initial.position, "velocity": initial.velocity}
    if not isinstance(definition.attitude, EulerAngles):
        values["quaternion"] = definition.attitude
    if isinstance(definition.inertia, Tensor):
        values["moments"] = body.moments
    elif isinstance(body.shape, Brick | Ellipsoid):
        values["semi_axes"] = body.shape.semi_axes
    found = flights(vary(scene, {name: np.array([value], dtype=float) for name, value in values.items()}), times)
    arrays = (getattr(found.trajectory, name)[0] for name in ("position", "quaternion", "velocity", "angular_velocity"))
    bounds = Bounds(*(getattr(found.bounds, name)[0] for name in NAMES))
    return Truth(scene, Trajectory(times, *arrays), bounds, found.forms[0], "", "")


def figures(text: str, found: Truth) -> dict[str, Figure]:
    """The figures of the truth of a case file with this text, by the name of their bound."""
    flight = read(text)
    return _figures(found, flight, flight.motion(found.trajectory.t.tolist()))


def _figures(found: Truth, flight: Flight, exact: list[Moment]) -> dict[str, Figure]:
    motion, seen = found.trajectory, observe(found.scene, found.trajectory)
    momentum, energy = flight.angular_momentum, flight.energy
    errors = {
        "error": [_angle(q, moment.quaternion) for q, moment in zip(motion.quaternion, exact, strict=True)],
        "position_error": _distances(motion.position, [moment.position for moment in exact]),
        "velocity_error": _distances(motion.velocity, [moment.velocity for moment in exact]),
        "angular_velocity_error": _distances(motion.angular_velocity, [moment.angular_velocity for moment in exact]),
        "energy_error": [float(abs(real(value) - energy)) for value in seen.total_energy.tolist()],
        "angular_momentum_error": _distances(seen.angular_momentum, [momentum] * len(exact)),
    }
    scales = _scales(flight, motion.t)
    return {name: Figure(motion.t, np.array(errors[name]), getattr(found.bounds, name), scales[name]) for name in UNITS}


def _scales(flight: Flight, t: Array) -> dict[str, Array]:
    """The sizes of the terms that the figures are the sums of."""
    start, g, mass = flight.start, float(flight.gravity), float(flight.mass)
    place, speed = float(norm(start.position)), float(norm(start.velocity))
    reach, fast = place + speed * t + g * t * t / 2, speed + g * t
    spin, momentum = float(norm(start.angular_velocity)), float(norm(flight.angular_momentum))
    return {
        "error": np.ones_like(t),
        "position_error": reach,
        "velocity_error": fast,
        "angular_velocity_error": np.full_like(t, spin),
        "energy_error": mass * fast**2 / 2 + mass * g * reach + momentum * spin / 2,
        "angular_momentum_error": np.full_like(t, momentum),
    }


def _distances(values: Array, exact: Iterable[object]) -> list[float]:
    return [float(norm(vector(value) - other)) for value, other in zip(values.tolist(), exact, strict=True)]


def _angle(q: Array, exact: list[object]) -> float:
    """The angle (rad) between the attitudes of a quaternion of doubles and of an exact unit quaternion."""
    w, *v = (real(part) for part in q.tolist())
    w0, *v0 = exact
    own, other = vector(v), vector(v0)
    across = other * w - own * w0 - cross(own, other)
    along = w * w0 + dot(own, other)
    return float(2 * MP.atan2(norm(across), abs(along)))
