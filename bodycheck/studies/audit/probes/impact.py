"""The probe of an impact: energy, momentum and angular momentum of two equal boxes whose faces meet flat.

One box is at rest, and the other comes along the normal of the faces, without spin, displaced in the plane of the faces. There
is neither gravity nor friction, and the coefficient of restitution is 1. By Newton's law each corner of the common patch leaves
with the speed at which it came. Four equal impulses at these corners satisfy this law and keep the energy, the momentum and the
angular momentum. The boxes are homogeneous, so that they turn afterwards.

An error that vanishes with the time step belongs to the scheme. An engine without a coefficient of restitution gives back
another part of the velocity; this is a property of its contacts, and no energy is expected to be kept. Energy that is gained is
a finding in any case.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import BodyStart, JointedBody, Mechanism
from bodycheck.reference.scene import Brick, Plane, Solid, vector_of
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, Property, not_probed

#: The boxes: half their lengths (m), their mass (kg) and their moments of inertia (kg m^2).
BOX = Brick((0.1, 0.15, 0.2))
MASS = 1.0
MOMENTS = np.array([0.15**2 + 0.2**2, 0.1**2 + 0.2**2, 0.1**2 + 0.15**2]) * MASS / 3

#: The height of the box at rest above the plane (m), which no box reaches; the displacement of the other box in the plane of
#: the faces (m), and its speed (m/s).
HEIGHT = 1.0
DISPLACEMENT = (0.11, 0.07)
SPEED = 3.0

#: The distances of the faces at the start (m). The instant of the impact within a step differs between them.
GAPS = (0.05, 0.0517, 0.0535)

#: The duration of a flight (s). The impact occurs after some 17 ms.
DURATION = 0.1

#: The boxes act on each other in a step that changes the velocity of the first box by more than this fraction of the speed of
#: approach. Damping changes it less. Errors are those between the first and the last such step.
ACTS = 1e-3

#: The smallest error that counts, relative to the energy or the momentum. Damping, and a scheme of first order, change both by
#: less while the boxes act on each other.
LEAST = 5e-3

#: The smallest fraction of the speed of approach that an engine with a coefficient of restitution of 1 gives back.
GIVES_BACK = 0.9

#: An error vanishes with the time step if less than this fraction of it is left at a quarter of the time step. The fraction is
#: a quarter for an error of first order, and 1 for an error that does not vanish.
LASTS = 0.6

#: The properties, in the order of the errors in `Outcome`.
PROPERTIES: tuple[Property, ...] = ("impact_energy_error", "impact_momentum_error", "impact_angular_momentum_error")


@dataclass(frozen=True)
class Outcome:
    """The result of several impacts with one time step.

    Parameters
    ----------
    errors
        The relative errors of the energy, the momentum and the angular momentum, each of the impact in which it is largest.
    restitution
        The smallest fraction of the speed of approach that the impacts gave back.
    """

    errors: tuple[float, float, float]
    restitution: float


def impact(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about the properties impact_energy_error, impact_momentum_error and impact_angular_momentum_error."""
    here, finer = outcome(pilot, pilot.timestep), outcome(pilot, pilot.timestep / 4)
    for result in (here, finer):
        if isinstance(result, NotFlown):
            return not_probed("impact", result.reason, *PROPERTIES)
    assert not isinstance(here, NotFlown)
    assert not isinstance(finer, NotFlown)
    of_energy, *others = (
        _finding(name, error, left) for name, error, left in zip(PROPERTIES, here.errors, finer.errors, strict=True)
    )
    if min(here.restitution, finer.restitution) < GIVES_BACK and not (of_energy.verdict == "found" and here.errors[0] > 0):
        reason = f"the contact gives back {here.restitution:.2g} of the speed of approach, where 1 is asked for"
        of_energy = not_probed("impact", reason, "impact_energy_error")[0]
    return of_energy, *others


def _finding(name: Property, error: float, finer: float) -> Finding:
    lasts = abs(error) > LEAST and abs(finer) > max(LEAST, LASTS * abs(error)) and error * finer > 0
    words = f"impact: {error:.2g}, and {finer:.2g} with a quarter of the time step"
    return Finding(name, words, "found" if lasts else "none", error, "", "0")


def outcome(pilot: Pilot, timestep: float) -> Outcome | NotFlown:
    """Return the result of the impacts with a time step (s), or the reason why there is none."""
    errors, returned = [], []
    for gap in GAPS:
        flown = pilot.fly(Flight(boxes(gap), timestep, (1,) * round(DURATION / timestep)))
        if isinstance(flown, NotFlown):
            return flown
        if not np.isfinite(flown.states).all():
            return NotFlown("its states are not numbers")
        states = np.concatenate([start(gap)[None], flown.states])
        hit = np.flatnonzero(np.abs(np.diff(states[:, 0, 7])) > ACTS * SPEED)
        if not len(hit):
            return NotFlown("the boxes do not act on each other")
        before, after = states[hit[0]], states[hit[-1] + 1]
        errors.append(
            (
                energy(after) / energy(before) - 1,
                _change(before, after, momentum) / (MASS * SPEED),
                _change(before, after, angular_momentum) / float(np.linalg.norm(angular_momentum(states[0]))),
            )
        )
        returned.append(restitution(before, after))
    largest = np.array(errors)[np.abs(errors).argmax(axis=0), range(3)].tolist()
    return Outcome((largest[0], largest[1], largest[2]), min(returned))


def boxes(gap: float) -> Mechanism:
    """Return the scene of the boxes, whose faces are at a distance of `gap` (m)."""
    first, second = start(gap)
    bodies = [
        JointedBody(name, Solid(BOX, MASS), start=BodyStart(vector_of(row[:3]), velocity=vector_of(row[7:10])), shape=BOX)
        for name, row in (("resting", first), ("coming", second))
    ]
    return Mechanism(tuple(bodies), plane=Plane(friction=0.0, restitution=1.0))


def start(gap: float) -> Array:
    """Return the initial states (2, 13) of the boxes, whose faces are at a distance of `gap` (m)."""
    states = np.zeros((2, 13))
    states[:, 3], states[:, 2] = 1.0, HEIGHT
    states[1, :3] += (2 * BOX.semi_axes[0] + gap, *DISPLACEMENT)
    states[1, 7] = -SPEED
    return states


def energy(states: Array) -> float:
    """Return the kinetic energy (J) of the boxes, from their states (2, 13)."""
    return float(MASS * (states[:, 7:10] ** 2).sum() + (states[:, 10:] ** 2 @ MOMENTS).sum()) / 2


def momentum(states: Array) -> Array:
    """Return the momentum (3,), in kg m/s, of the boxes."""
    return np.asarray(MASS * states[:, 7:10].sum(axis=0))


def angular_momentum(states: Array) -> Array:
    """Return the angular momentum (3,), in kg m^2/s, of the boxes about the initial place of the first box."""
    arms = states[:, :3] - np.array([0.0, 0.0, HEIGHT])
    spins = rotate(states[:, 3:7], MOMENTS * states[:, 10:])
    return np.asarray((np.cross(arms, MASS * states[:, 7:10]) + spins).sum(axis=0))


def restitution(before: Array, after: Array) -> float:
    """Return the fraction of the speed of approach that an impact gave back, from the states (2, 13) before and after it.

    The impulse J, the change of the momentum of the first box along the normal n, acts at the centre of the patch, at r from
    the centre of mass. The fraction is J / (m' v) - 1 with 1 / m' = 2 / m + 2 (r x n) . I^-1 (r x n).
    """
    y, z = np.array(DISPLACEMENT) / 2
    effective = 1 / (2 / MASS + 2 * (z**2 / MOMENTS[1] + y**2 / MOMENTS[2]))
    return float(MASS * (before - after)[0, 7] / (effective * SPEED) - 1)


def _change(before: Array, after: Array, quantity: Callable[[Array], Array]) -> float:
    return float(np.linalg.norm(quantity(after) - quantity(before)))
