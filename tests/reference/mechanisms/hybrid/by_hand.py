"""A pendulum and a two-link arm with controllers and stops, by equations written by hand and SciPy's DOP853 with events."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from bodycheck.reference.mechanisms.control import Stops
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Array
from tests.support.jointed import body

#: Masses (kg), moments of inertia about the centres (kg m^2), lengths to the centres (m), and the length of the upper arm (m).
M1, M2, I1, I2, C1, C2, L1, G = 1.0, 0.5, 0.01, 0.005, 0.5, 0.3, 1.0, 9.81

ARM = Mechanism(
    (body("upper", M1, (I1, I1, I1), (0.0, 0.0, -C1)), body("fore", M2, (I2, I2, I2), (0.0, 0.0, -C2))),
    (
        Joint("shoulder", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(1.0,), start_velocity=(0.0,)),
        Joint("elbow", "revolute", 0, 1, position=(0.0, 0.0, -L1), axis=(0.0, 1.0, 0.0), start=(0.5,), start_velocity=(0.0,)),
    ),
    gravity=G,
)
PENDULUM = Mechanism(ARM.bodies[:1], ARM.joints[:1], gravity=G)

#: The effort of each joint at a time, from the coordinates and velocities.
Efforts = Callable[[float, Array, Array], Array]


def mass_matrix(q: Array) -> Array:
    """The mass matrix of the pendulum or of the arm."""
    if len(q) == 1:
        return np.array([[I1 + M1 * C1**2]])
    own, coupled = I2 + M2 * C2**2, M2 * L1 * C2 * math.cos(q[1])
    return np.array([[I1 + M1 * C1**2 + M2 * L1**2 + own + 2 * coupled, own + coupled], [own + coupled, own]])


def forces(q: Array, v: Array) -> Array:
    """The forces of gravity and of the motion along the coordinates."""
    if len(q) == 1:
        return np.array([-G * M1 * C1 * math.sin(q[0])])
    both, turning = -G * M2 * C2 * math.sin(q[0] + q[1]), M2 * L1 * C2 * math.sin(q[1])
    upper = -G * (M1 * C1 + M2 * L1) * math.sin(q[0]) + both
    return np.array([upper + turning * (2 * v[0] * v[1] + v[1] ** 2), both - turning * v[0] ** 2])


@dataclass(frozen=True)
class Rigid:
    """A rigid stop of a joint at a coordinate, on the side 1 or -1."""

    joint: int
    place: float
    side: int
    restitution: float


def rigid(stops: Sequence[Stops | None]) -> list[Rigid]:
    """The rigid stops of joints."""
    limits = [
        (joint, each, place, side)
        for joint, each in enumerate(stops)
        if each
        for place, side in ((each.lower, -1), (each.upper, 1))
    ]
    return [Rigid(joint, place, side, each.restitution or 0.0) for joint, each, place, side in limits if place is not None]


@dataclass(frozen=True)
class _Motion:
    """The equations of the pendulum or the arm while some of its joints are held at their stops."""

    efforts: Efforts
    free: list[int]

    def needed(self, t: float, y: Array) -> Array:
        q, v = np.split(y, 2)
        return forces(q, v) + self.efforts(t, q, v)

    def rates(self, t: float, y: Array) -> Array:
        q, v = np.split(y, 2)
        a, free = np.zeros(len(q)), self.free
        a[free] = np.linalg.solve(mass_matrix(q)[np.ix_(free, free)], self.needed(t, y)[free])
        return np.concatenate([v, a])

    def event(self, stop: Rigid) -> Callable[[float, Array], float]:
        """The distance from a stop, or the force that presses a held joint against it."""

        def pressed(t: float, y: Array) -> float:
            q, a = np.split(y, 2)[0], np.split(self.rates(t, y), 2)[1]
            return float(stop.side * (self.needed(t, y) - mass_matrix(q) @ a)[stop.joint])

        def distance(t: float, y: Array) -> float:
            return float(stop.side * (stop.place - y[stop.joint]))

        chosen: Any = distance if stop.joint in self.free else pressed
        chosen.terminal, chosen.direction = True, -1
        return chosen  # type: ignore[no-any-return]


def follow(
    q: Array, v: Array, until: float, efforts: Efforts, stops: Sequence[Rigid] = (), begin: float = 0.0
) -> tuple[Array, Array]:
    """The coordinates and velocities at a time, with impacts at rigid stops and joints that stay there."""
    held: dict[int, Rigid] = {}
    while begin < until:
        motion = _Motion(efforts, [index for index in range(len(q)) if index not in held])
        watched = [held.get(stop.joint, stop) for stop in stops]
        events = [motion.event(stop) for stop in watched]
        pulled = [index for index, stop in held.items() if motion.event(stop)(begin, np.concatenate([q, v])) < 0]
        if pulled:
            del held[pulled[0]]
            continue
        out = solve_ivp(motion.rates, (begin, until), np.concatenate([q, v]), "DOP853", rtol=1e-13, atol=1e-14, events=events)
        begin, (q, v) = float(out.t[-1]), np.split(out.y[:, -1], 2)
        if out.status == 1:
            stop = next(stop for stop, times in zip(watched, out.t_events, strict=True) if len(times))
            if stop.joint in held:
                del held[stop.joint]
            else:
                q, v = _hit(q, v, stop, held)
    return q, v


def _hit(q: Array, v: Array, stop: Rigid, held: dict[int, Rigid]) -> tuple[Array, Array]:
    """The state after an impact, in which `held` gets the joint if it does not rebound."""
    others = [index for index in range(len(q)) if index not in held or index == stop.joint]
    unit = np.zeros(len(q))
    unit[others] = np.linalg.solve(mass_matrix(q)[np.ix_(others, others)], np.eye(len(q))[others, stop.joint])
    v = v - (1 + stop.restitution) * v[stop.joint] / unit[stop.joint] * unit
    q = q.copy()
    q[stop.joint] = stop.place
    if not stop.restitution:
        v[stop.joint], held[stop.joint] = 0.0, stop
    return q, v
