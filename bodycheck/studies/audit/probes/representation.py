"""The probe of representations: whether a body moves in the same way in whatever form an engine is given it.

The body tumbles freely and falls. It is given along its principal axes and in each of `representations`, and flown with three
time steps: the audited time step, and twice and four times as much. In mechanics all motions are the same. With a scheme in the
coordinates of the given frame, they may differ by an error that vanishes with the time step. A difference that does not vanish
is a fault.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, log2
from typing import Literal

import numpy as np

from bodycheck.reference.kinematics import conjugate, multiply
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.representations import Representation, along_principal_axes, representations, started

#: A body with three moments that tumbles about no principal axis, falls, and turns by some 3 rad in 0.4 s.
SCENE = Scene(
    Body(2.0, (0.02, 0.035, 0.045)),
    State((0.1, -0.2, 0.3), (0.5, -0.5, 0.5, 0.5), (1.0, -0.5, 2.0), (4.0, -5.0, 6.0)),
    gravity=9.81,
)

#: Time steps as multiples of the audited time step.
MULTIPLES = (4, 2, 1)

#: The number of the largest time steps in a flight, and the number of samples. A difference is visible above rounding with few,
#: large steps, because rounding grows with the number of steps.
LONGEST_STEPS, SAMPLES = 50, 5

#: The largest sum of the rounding errors in one step, in units of roundoff times the size of a quantity. A step computes some
#: hundred products and sums, whose rounding errors have either sign. The motion of `SCENE` amplifies an initial error at most
#: 1.4 times, relative to the same sizes (`differences`).
ROUNDINGS_A_STEP = 16

#: The smallest ratio of the remainders at a time step and at half of it (see `Difference.vanishes`) for which a difference
#: counts as vanishing. The remainder of a vanishing difference is of second order and shrinks fourfold; otherwise it does not
#: shrink.
LEAST_RATIO = 2.0


@dataclass(frozen=True)
class Difference:
    """The differences of a quantity between two motions, at several instants and with several time steps.

    Parameters
    ----------
    unit
        The unit of the quantity; it is "rad" for the attitude.
    vectors
        The differences (steps, instants, 3), the largest time step first.
    rounding
        The largest difference that rounding can explain, for each time step (steps,).
    """

    unit: str
    vectors: Array
    rounding: Array

    @property
    def sizes(self) -> Array:
        """The largest difference over all instants, for each time step (steps,), in the unit."""
        return _largest(self.vectors)

    @property
    def excess(self) -> float:
        """The largest ratio, over the time steps, of the difference to the largest difference that rounding can explain."""
        return float((self.sizes / self.rounding).max())

    @property
    def vanishes(self) -> bool:
        """True if the difference tends to zero with the time step, or to a value within rounding.

        The remainder 2 D(h) - D(2h) of the difference D has no part of first order; it is the limit plus terms of higher order.
        A remainder opposed to the difference counts as a term of higher order. Such a remainder shrinks slowly if the observed
        order grows from 1 to 2 within the range of time steps.
        """
        left = 2 * self.vectors[1:] - self.vectors[:-1]
        coarse, fine = _largest(left).tolist()
        opposed = float((left[-1] * self.vectors[-1]).sum()) < 0
        return bool(fine <= 3 * self.rounding[-1] or coarse >= LEAST_RATIO * fine or opposed)

    @property
    def order(self) -> float:
        """The order with which the difference vanishes, from the smallest pair of time steps at which it exceeds rounding."""
        seen = self.sizes > self.rounding
        coarse, fine = self.sizes[1:] if seen[1:].all() else self.sizes[:-1]
        return log2(coarse / fine) if fine else inf


def representation(pilot: Pilot) -> tuple[Finding, ...]:
    """Return a finding for each of `representations`, which are compared with the body along its principal axes."""
    plain = _flown(pilot, Representation("principal axes", SCENE.body))
    return tuple(_finding(pilot, plain, given) for given in representations(SCENE.body))


def _finding(pilot: Pilot, plain: Array | NotFlown, given: Representation) -> Finding:
    if isinstance(plain, NotFlown):
        return Finding("representation", f"representation: {given.name}: {plain.reason}", "not-probed")
    there = _flown(pilot, given)
    if isinstance(there, NotFlown):
        return Finding("representation", f"representation: {given.name}: {there.reason}", "not-probed")
    if not np.isfinite(plain).all():
        return Finding("representation", f"representation: {given.name}: no motion to compare it with", "not-probed")
    if not np.isfinite(there).all():
        steps = (
            multiple * pilot.timestep for multiple, rows in zip(MULTIPLES, there, strict=True) if not np.isfinite(rows).all()
        )
        words = f"its states are not numbers with steps of {', '.join(f'{step:g} s' for step in steps)}"
        return Finding("representation", f"representation: {given.name}: {words}", "found", expected="0")
    quantities = differences(there, plain, pilot.timestep, pilot.roundoff)
    lasting = [difference for difference in quantities if difference.excess > 1 and not difference.vanishes]
    vanishing = [difference for difference in quantities if difference.excess > 1 and difference.vanishes]
    if lasting:
        return _said(given, lasting[0], "found", "differs, and does not vanish with the time step")
    if vanishing:
        first = vanishing[0]
        return _said(given, first, "found", f"differs, and vanishes with the time step with order {first.order:.1f}")
    return _said(given, quantities[0], "none", "the same motion to rounding")


def _said(given: Representation, difference: Difference, verdict: Literal["found", "none"], words: str) -> Finding:
    """Return the finding about a representation, whose value is the difference at the audited time step."""
    value = float(difference.sizes[-1])
    return Finding("representation", f"representation: {given.name}: {words}", verdict, value, difference.unit, "0")


def _flown(pilot: Pilot, given: Representation) -> Array | NotFlown:
    """Return the states (steps, instants, 13) of the principal frame of a body that is flown in a representation.

    The states with the largest time step come first.
    """
    scene, motions = started(given, SCENE), []
    for multiple in MULTIPLES:
        strides = (LONGEST_STEPS // SAMPLES * MULTIPLES[0] // multiple,) * SAMPLES
        result = pilot.fly(Flight(scene, multiple * pilot.timestep, strides, given.links))
        if isinstance(result, NotFlown):
            return result
        motions.append(along_principal_axes(given, result.states))
    return np.array(motions)


def differences(one: Array, other: Array, timestep: float, roundoff: float) -> Sequence[Difference]:
    """Return the differences of two motions in attitude, position, velocity and angular velocity, in this order.

    It is the order in which a difference is preferred for the finding.

    Parameters
    ----------
    one, other
        States (steps, instants, 13) with the time steps `MULTIPLES`, in the columns of `Simulation.advance`.
    timestep
        The smallest time step (s).
    roundoff
        The unit roundoff of the engine. In each step rounding adds up to `ROUNDINGS_A_STEP` times the roundoff, relative to the
        size of a quantity plus, for attitude and position, the distance covered at the largest rate in the whole flight.
    """
    duration = LONGEST_STEPS * MULTIPLES[0] * timestep
    relative = multiply(conjugate(other[..., 3:7]), one[..., 3:7])
    half = np.linalg.norm(relative[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(half, np.abs(relative[..., :1]))
    turn = np.sign(relative[..., :1]) * relative[..., 1:] * np.divide(angle, half, out=np.full_like(half, 2.0), where=half > 0)
    lengths, speeds, rates = (
        max(float(_largest(states[..., columns]).max()) for states in (one, other))
        for columns in (slice(0, 3), slice(7, 10), slice(10, 13))
    )
    steps = LONGEST_STEPS * MULTIPLES[0] / np.array(MULTIPLES)
    rounding = ROUNDINGS_A_STEP * roundoff * steps
    return (
        Difference("rad", turn, rounding * (1 + rates * duration)),
        Difference("m", one[..., :3] - other[..., :3], rounding * (lengths + speeds * duration)),
        Difference("m/s", one[..., 7:10] - other[..., 7:10], rounding * speeds),
        Difference("rad/s", one[..., 10:] - other[..., 10:], rounding * rates),
    )


def _largest(vectors: Array) -> Array:
    """Return the length of the longest of the vectors (steps, instants, 3) for each time step (steps,)."""
    return np.asarray(np.linalg.norm(vectors, axis=-1).max(axis=-1))
