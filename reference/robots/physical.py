"""Values of a robot model that no body can have: masses, moments of inertia and joints that contradict mechanics."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel, Wide, from_the_root

#: How far moments may be beyond the physical limits, relative to the largest moment. Programs write moments with nine digits or
#: more, so that a smaller violation is a rounding of them.
MARGIN = 1e-9

#: The same relative to mass times the square of the size of a link: some fifty roundings of doubles. Programs that compute
#: moments about the centre of mass from moments about another point leave such roundings, also where the moments are zero. The
#: size is the largest distance (m) from the link's origin to its centre of mass or to a joint, and not smaller than the least.
ROUNDING, LEAST_SIZE = 1e-14, 1e-5


@dataclass(frozen=True)
class Unphysical:
    """A value that is physically impossible.

    Attributes
    ----------
    subject
        The name of the link or joint.
    quantity
        The quantity: mass, center_of_mass, inertia, armature, damping or friction.
    text
        The value in the file, and why it is impossible.
    """

    subject: str
    quantity: str
    text: str


@np.errstate(invalid="ignore")  # numbers of a file may be infinite or not a number
def unphysical(model: RobotModel) -> tuple[Unphysical, ...]:
    """Return the impossible values of a model: first those of links, then those of joints, in the order of the file.

    - A mass, armature, damping or friction that is negative or not a number.
    - A component of the centre of mass or of the inertia that is not a number.
    - Principal moments A <= B <= C with A < 0 or A + B < C, beyond `MARGIN` and `rounding`: no distribution of mass has them.
      Moments of zero are possible: a point has them, and a thin rod about its own axis.
    - Inertia without mass.
    - A joint that moves nothing with mass and has no armature: its acceleration is undetermined.

    Raises `ValueError` if the joints do not form a tree.
    """
    joints: dict[int, list[Wide]] = {}
    for joint in model.joints:
        joints.setdefault(joint.parent, []).append(joint.position)
    faults = [fault for index, link in enumerate(model.links) for fault in _of_link(link, joints.get(index, ()))]
    faults += [fault for joint in model.joints for fault in _of_joint(joint)]
    return (*faults, *_of_subtrees(model))


def rounding(mass: float, centre: Wide, joints: Iterable[Wide]) -> float:
    """Return the size (kg m^2) of what rounding may leave of moments of zero.

    mass: the mass of a link (kg). centre, joints: the positions (3,) of its centre of mass and of the joints on it (m).
    """
    return float(ROUNDING * abs(mass) * max(LEAST_SIZE, *(np.abs(position).max() for position in (centre, *joints))) ** 2)


def _of_link(link: RobotLink, joints: Iterable[Wide]) -> Iterator[Unphysical]:
    def fault(quantity: str, text: str) -> Unphysical:
        return Unphysical(link.name, quantity, text)

    if not np.isfinite(link.mass):
        yield fault("mass", f"the mass is {link.mass:g}, which is not a number of kilograms")
    elif link.mass < 0:
        yield fault("mass", f"the mass is {link.mass:.6g} kg; no mass is negative")
    if not np.isfinite(link.center_of_mass).all():
        yield fault("center_of_mass", "a component of the centre of mass is not a number of metres")
    if not np.isfinite(link.inertia).all():
        yield fault("inertia", "a component of the inertia is not a number")
        return
    # The numbers of a file may be so large that their sums overflow a double.
    scale = np.abs(link.inertia).max() or np.longdouble(1)
    a, b, c = scale * np.linalg.eigvalsh((link.inertia / scale).astype(float))
    moments = f"the principal moments are {a:.6g}, {b:.6g} and {c:.6g} kg m^2"
    margin = max(MARGIN * abs(a), MARGIN * abs(c), rounding(link.mass, link.center_of_mass, joints))
    if a < -margin:
        yield fault("inertia", f"{moments}; no moment is negative")
    elif a + b < c - margin:
        yield fault("inertia", f"{moments}; the largest exceeds the sum of the others by {c - a - b:.3g}")
    if link.mass == 0 and c > 0:
        yield fault("inertia", f"{moments}, but the mass is zero")


def _of_joint(joint: RobotJoint) -> Iterator[Unphysical]:
    for quantity in ("armature", "damping", "friction"):
        value = getattr(joint, quantity)
        if not value >= 0:
            yield Unphysical(joint.name, quantity, f"the {quantity} is {value:.6g}; allowed: zero or a positive number")


def _of_subtrees(model: RobotModel) -> Iterator[Unphysical]:
    joints = from_the_root(model)
    heavy = {index for index, link in enumerate(model.links) if link.mass != 0 or link.inertia.any()}
    for joint in reversed(joints):
        if joint.child in heavy:
            heavy.add(joint.parent)
    for joint in model.joints:
        if joint.type != "fixed" and joint.child not in heavy and not joint.armature:
            text = (
                f"nothing that this {joint.type} joint moves has mass, and it has no armature: its acceleration is undetermined"
            )
            yield Unphysical(joint.name, "mass", text)
