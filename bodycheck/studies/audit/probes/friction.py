"""The probe of the isotropy of friction: how friction brakes a box that slides in several directions, and what turns its path.

By Coulomb's law friction acts against the velocity with the same force in every direction. The load on the face of a box that
slides without spin shifts forwards, along the velocity. Therefore friction has no moment about the vertical with any pattern of
the load, and the box neither spins nor leaves its path. The box is square, and its direction of motion is turned against the
axes of the world, while its edges are along these axes or are turned with the direction.
"""

from collections.abc import Iterable
from math import cos, radians, sin

import numpy as np

from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reports.quantities import listing
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot
from bodycheck.studies.audit.probe import Finding, Property, not_probed

#: The directions of motion (degrees) against an axis of the world. Friction in a pyramid is the same at the angles beyond.
DIRECTIONS = (0.0, 15.0, 30.0, 45.0)

#: The directions in words.
ANGLES = f"{listing([f'{direction:g}' for direction in DIRECTIONS])} degrees"

#: A flat square box. Its moments of inertia are m (b^2 + c^2) / 3 and so on.
_HALF, _HALF_HEIGHT = 0.2, 0.05
BOX = Body(1.0, (0.0425 / 3, 0.0425 / 3, 0.08 / 3), Brick((_HALF, _HALF, _HALF_HEIGHT)))

#: The speed at the start (m/s), the coefficient of friction, the gravitational acceleration (m/s^2), and the duration (s). In
#: this short time friction hardly turns the path.
SPEED, FRICTION, GRAVITY, DURATION = 2.0, 0.5, 9.81, 0.06

#: The largest tilt (rad) of a box that lies on a soft contact.
FLAT = 0.02

#: The smallest fraction of the force that counts as a difference between directions, or as a force sideways. Contacts that are
#: solved by iteration come within some thousandths.
LEAST = 0.01

#: The properties.
PROPERTIES: tuple[Property, Property] = ("friction-anisotropy", "sideways-friction")

#: The attitudes of the box in words, and whether its edges turn with the direction of motion.
ATTITUDES = {"edges along the axes of the world": False, "edges along the motion": True}


def friction(pilot: Pilot) -> tuple[Finding, ...]:
    """Return findings about the properties friction-anisotropy and sideways-friction, one each for either attitude of the box.

    The value of friction-anisotropy is 1 minus the ratio of the smallest to the largest force of friction. The value of
    sideways-friction is the largest force across the velocity, as a fraction of mu N.
    """
    return tuple(finding for words, turned in ATTITUDES.items() for finding in _findings(pilot, words, turned=turned))


def _findings(pilot: Pilot, words: str, *, turned: bool) -> tuple[Finding, ...]:
    forces = []
    for direction in DIRECTIONS:
        force = _force(pilot, radians(direction), turned=turned)
        if isinstance(force, NotFlown):
            return not_probed(f"friction: {words}", force.reason, *PROPERTIES)
        forces.append(force)
    along, across = np.array(forces).T
    if not along.max() > 0:
        return not_probed(f"friction: {words}", "friction does not brake the box", *PROPERTIES)
    values = (1 - float(along.min() / along.max()), float(across[np.abs(across).argmax()]))
    return tuple(
        Finding(
            name,
            f"friction: {words}: {_listed(parts)} of mu N at {ANGLES}",
            "found" if abs(value) > LEAST else "none",
            value,
            expected="0",
        )
        for name, parts, value in zip(PROPERTIES, (along, across), values, strict=True)
    )


def _force(pilot: Pilot, direction: float, *, turned: bool) -> tuple[float, float] | NotFlown:
    """Return the force of friction against the velocity and across it, to the left, as fractions of mu N.

    The mean load N follows from the vertical motion, because a box on a soft contact sinks or hops at first.
    """
    scene, steps = sliding(direction, turned=turned), max(2, round(DURATION / pilot.timestep))
    flown = pilot.fly(Flight(scene, pilot.timestep, (steps,)))
    if isinstance(flown, NotFlown):
        return flown
    if not np.isfinite(flown.states).all():
        return NotFlown("its states are not numbers")
    if 2 * np.hypot(*flown.states[0, 4:6]) > FLAT:
        return NotFlown("the box does not lie flat on the plane")
    change = flown.states[0, 7:10] - np.array(scene.initial.velocity)
    load = FRICTION * (GRAVITY * steps * pilot.timestep + change[2])
    if not load > 0:
        return NotFlown("the plane does not bear the box")
    along = np.array([cos(direction), sin(direction)])
    return -float(change[:2] @ along) / load, float(change[:2] @ (-along[1], along[0])) / load


def sliding(direction: float, *, turned: bool) -> Scene:
    """Return the scene of the box that slides in a direction (rad). turned: whether its edges turn with the direction."""
    yaw = direction if turned else 0.0
    return Scene(
        BOX,
        State(
            (0.0, 0.0, _HALF_HEIGHT),
            (cos(yaw / 2), 0.0, 0.0, sin(yaw / 2)),
            (SPEED * cos(direction), SPEED * sin(direction), 0.0),
        ),
        gravity=GRAVITY,
        plane=Plane(friction=FRICTION),
    )


def _listed(values: Iterable[float]) -> str:
    return ", ".join(f"{value:.3f}" for value in values)
