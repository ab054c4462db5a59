"""Planes, contacts and pushes in words."""

import math

from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism, PairContact
from bodycheck.reference.scene import Plane, Push
from bodycheck.reports.quantities import number, vector


def on_plane(plane: Plane) -> str:
    """Return a plane on which bodies roll, bounce and rest, in words."""
    tilted = f"inclined by {number(plane.incline)} rad " if plane.incline else ""
    return f"on a plane {tilted}with {_touching(plane.friction, plane.restitution)}"


def contact(mechanism: Mechanism, pair: PairContact) -> str:
    """Return how two bodies touch, in words."""
    one, other = ("the plane" if place == WORLD else mechanism.bodies[place].name for place in pair.bodies)
    return f"between {one} and {other} {_touching(pair.friction, pair.restitution)}"


def pushed(push: Push, name: str = "") -> str:
    """Return a constant force in words. name: of the body, where there are several."""
    during = f" from {number(push.start)} s" if push.start else ""
    during += f" until {number(push.end)} s" if math.isfinite(push.end) else ""
    where = f" at {vector(push.point)} m from the centre of mass" if any(push.point) else ""
    return f"pushed {f'{name} ' if name else ''}with {vector(push.force)} N{where}{during}"


def _touching(friction: float, restitution: float) -> str:
    rough = "friction so large that nothing slips" if math.isinf(friction) else f"friction coefficient {number(friction)}"
    return f"{rough} and coefficient of restitution {number(restitution)}"
