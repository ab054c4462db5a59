"""Controllers of joints in mechanisms with loops: integration from one instant at which efforts change to the next.

A law with a rate gives an effort that is held; a continuous law is part of the equations, whose state has after coordinates and
velocities the integral of the error of each law with ki, and the time since the last such instant.
"""

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import MP, Real, Wide, real, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.integration.collocation import Integrated, integrate
from bodycheck.reference.mechanisms.hybrid.sampled import Memory, computed, signals_at
from bodycheck.reference.mechanisms.hybrid.signals import Piece, breaks, piece, signals
from bodycheck.reference.mechanisms.loops import joint_space
from bodycheck.reference.mechanisms.loops.joint_space import Tree
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array

#: The largest number of instants at which efforts change; each takes some 20 ms.
MOST_INSTANTS = 1000


def integrated(mechanism: Mechanism, linkage: Tree, start: WideArray, times: Array, **how: Any) -> Integrated:
    """The motion at ascending times (n,) >= 0, s, from a state (c + u,) at t = 0. how: arguments of `collocation.integrate`.

    Raises `NotModelled` for a continuous law whose effort is limited, and `OutOfReach` if efforts change too often or the
    motion cannot be followed.
    """
    if any(controller.rate is None and controller.effort_limit is not None for controller in mechanism.controllers):
        raise NotModelled("limits of the effort of continuous controllers in a mechanism with loops", "controllers")
    size, end = len(start), float(times[-1]) if len(times) else 0.0
    edges = sorted({Fraction(0), *breaks(mechanism.controllers, real(end))})
    if len(edges) > MOST_INSTANTS:
        raise OutOfReach(f"controllers of a mechanism with loops change their efforts {len(edges)} times")
    driven = _Driven(mechanism, linkage)
    states, errors, error = np.empty((len(times), size), dtype=Wide), np.empty(len(times)), 0.0
    state = np.concatenate([start, np.zeros(driven.further, dtype=Wide)])
    for begin, after in zip(edges, [*edges[1:], Fraction(end)], strict=True):
        driven.start(begin, state)
        inside = np.flatnonzero((times >= float(begin)) & ((times < float(after)) | (after == end)))
        local = np.array([wide(real(Fraction(float(time)) - begin)) for time in times[inside]] + [wide(real(after - begin))])
        state[-1] = 0
        part = integrate(driven.derivatives, state, local, corrected=driven.corrected, **how)
        states[inside], errors[inside] = part.states[:-1, :size], error + part.errors[:-1]
        state, error = driven.corrected(part.states[-1]), error + float(part.errors[-1])
    return Integrated(states, errors)


class _Driven:
    """The equations of a mechanism between two instants at which efforts change, and the memories of its controllers."""

    def __init__(self, mechanism: Mechanism, linkage: Tree) -> None:
        self.linkage = linkage
        self.controllers = mechanism.controllers
        of_joint = {id(element.joint): element for element in linkage.elements}
        elements = [of_joint[id(mechanism.joints[controller.joint])] for controller in self.controllers]
        self.places = [(element.held.start, linkage.coordinates + element.moving.start) for element in elements]
        self.memories = {index: Memory() for index, each in enumerate(self.controllers) if each.rate is not None}
        self.integrals = [index for index, each in enumerate(self.controllers) if each.rate is None and each.ki]
        self.further = len(self.integrals) + 1
        self.held = np.zeros(len(linkage.inertia), dtype=Wide)
        self.pieces: Mapping[int, tuple[Piece, ...]] = {}
        self.begin: Real = MP.mpf(0)

    def start(self, begin: Fraction, state: WideArray) -> None:
        """Compute the efforts that are held from an instant (s) on, and the pieces of the signals of continuous laws."""
        self.begin, self.held = real(begin), np.zeros_like(self.held)
        for index, memory in self.memories.items():
            controller, (held, moving) = self.controllers[index], self.places[index]
            assert controller.rate is not None
            if (begin * Fraction(controller.rate)).denominator == 1:
                target, target_velocity, effort = (wide(MP.mpf(value)) for value in signals_at(controller, self.begin))
                memory = computed(controller, memory, (target, target_velocity, effort), state[held], state[moving])
                self.memories[index] = memory
            self.held[moving - self.linkage.coordinates] = memory.acting
        self.pieces = {
            index: tuple(piece(signal, self.begin) for signal in signals(controller))
            for index, controller in enumerate(self.controllers)
            if controller.rate is None
        }

    def derivatives(self, states: WideArray) -> WideArray:
        """The derivatives (s, c + u + k) of states (s, c + u + k)."""
        base, elapsed = states[:, : -self.further], states[:, -1]
        pushed, rates = np.repeat(self.held[None], len(states), axis=0), []
        for index, pieces in self.pieces.items():
            controller, (held, moving) = self.controllers[index], self.places[index]
            target, target_velocity, effort = (self._value(each, elapsed) for each in pieces)
            error = target - states[:, held]
            pushed[:, moving - self.linkage.coordinates] += (
                controller.kp * error + controller.kd * (target_velocity - states[:, moving]) + effort
            )
            if index in self.integrals:
                column = len(base[0]) + self.integrals.index(index)
                pushed[:, moving - self.linkage.coordinates] += controller.ki * states[:, column]
                rates.append(error)
        rates.append(np.ones_like(elapsed))
        return np.hstack([joint_space.derivatives(self.linkage, base, pushed), np.stack(rates, axis=1)])

    def _value(self, part: Piece, elapsed: WideArray) -> WideArray:
        """The values (s,) of a signal at times (s,) since the start of its piece."""
        wave: Any = 0
        if part.amplitude:
            angle = wide(MP.fmod(part.angular_frequency * self.begin + part.phase, 2 * MP.pi))
            wave = wide(part.amplitude) * np.sin(angle + wide(part.angular_frequency) * elapsed)
        values: WideArray = wide(part.constant + part.slope * self.begin) + wide(MP.mpf(part.slope)) * elapsed + wave
        return values

    def corrected(self, state: WideArray) -> WideArray:
        """A state whose loops are closed."""
        size = len(state) - self.further
        return np.concatenate([joint_space.close_loops(self.linkage, state[:size]), state[size:]])
