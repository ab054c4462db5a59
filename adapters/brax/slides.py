"""Give Brax mechanisms on slides as it moves them.

Brax's pipeline `generalized` turns the axes of hinges to the world in each step, and not those of slides: it displaces a body
along the axis in the body's frame, and computes inertia and forces as if that axis were along the same numbers in the world.
The two agree where the frame of a slide is not turned. A frame that keeps its attitude can be written so: the axes, the inertia
and all that hangs on the body are then given along the axes of the world. A slide on a body that turns cannot.
"""

from xml.etree import ElementTree

import numpy as np

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.mujoco.contact import numbers_written
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.trajectory import Array

UNTURNED = "1 0 0 0"


def align_slides(root: ElementTree.Element) -> None:
    """Turn the frames of all bodies on slides, in MuJoCo's XML of a mechanism, to the axes of the world, as the module says.

    Coordinates and motion stay the same. Raises `SceneUnsupported` for a slide on a body that turns.
    """
    for world in root.iter("worldbody"):
        _align(world, turns=False)


def _align(parent: ElementTree.Element, turns: bool) -> None:
    """Align the bodies in a body. turns: whether its attitude changes; if not, its frame has the axes of the world."""
    for body in parent.findall("body"):
        kinds = {joint.get("type"): joint for joint in body.findall("joint")}
        if "slide" in kinds:
            if turns:
                raise SceneUnsupported(
                    f"{kinds['slide'].get('name')} slides on a body that turns, and Brax does not turn the axes of slides"
                )
            turn_content(body, numbers(body.get("quat", UNTURNED)))
            body.set("quat", UNTURNED)
        _align(body, turns or "hinge" in kinds)


def turn_content(body: ElementTree.Element, attitude: Array) -> None:
    """Turn what is in the frame of a body, whose attitude (4,) is taken away from it. Without one the digits stay."""
    if not attitude[1:].any():
        return
    for joint in body.findall("joint"):
        joint.set("axis", numbers_written(*rotate(attitude, numbers(joint.get("axis", "")))))
    for child in body.findall("body"):
        child.set("pos", numbers_written(*rotate(attitude, numbers(child.get("pos", "")))))
        child.set("quat", numbers_written(*multiply(attitude, numbers(child.get("quat", UNTURNED)))))
    for inertial in body.findall("inertial"):
        inertial.set("pos", numbers_written(*rotate(attitude, numbers(inertial.get("pos", "")))))
        turned = rotate(attitude, rotate(attitude, tensor_of(inertial)).T)
        inertial.attrib.pop("diaginertia", None)
        inertial.set("fullinertia", numbers_written(*np.diag(turned), turned[0, 1], turned[0, 2], turned[1, 2]))


def tensor_of(inertial: ElementTree.Element) -> Array:
    """Return the inertia tensor (3, 3) of an element, whose axes are those of the body."""
    if (full := inertial.get("fullinertia")) is None:
        return np.diag(numbers(inertial.get("diaginertia", "")))
    xx, yy, zz, xy, xz, yz = numbers(full)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def numbers(text: str) -> Array:
    """Return the numbers of an attribute."""
    return np.array(text.split(), dtype=float)
