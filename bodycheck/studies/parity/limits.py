"""The limits of a robot model that is compared: the numbers and sizes that cases allow, so that no term overflows.

A model beyond them is a fault of its file, and engines are not compared with it.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from bodycheck.casefile.scenes import MAX_SIZE
from bodycheck.casefile.values import MAX_NUMBER
from bodycheck.errors import BadInput
from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel
from bodycheck.robots.attributes import read_numbers
from bodycheck.robots.elements import Element, place, quoted
from bodycheck.robots.faults import MAX_FAULTS, FaultyQuantity, FileFault
from bodycheck.robots.named_files import local
from bodycheck.robots.urdf import MAX_LINKS, MAX_NAME

#: The numbers of a link and of a joint, and the quantities that their faults are about.
OF_LINK: Mapping[str, FaultyQuantity] = {"mass": "mass", "center_of_mass": "center_of_mass", "inertia": "inertia"}
OF_JOINT: Mapping[str, FaultyQuantity] = {
    "position": "pose",
    "armature": "",
    "damping": "damping",
    "friction": "friction",
    "stiffness": "",
    "rest": "",
    "effort_limit": "effort_limit",
    "velocity_limit": "effort_limit",
    "lower": "effort_limit",
    "upper": "effort_limit",
}

#: The attributes of MJCF that hold the numbers of bodies and joints. Of other numbers, such as ranges, some may be infinite.
MJCF: Mapping[FaultyQuantity, tuple[str, ...]] = {
    "mass": ("mass", "density"),
    "inertia": ("diaginertia", "fullinertia", "size", "fromto"),
    "pose": ("pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"),
    "axis": ("axis",),
    "damping": ("damping",),
    "friction": ("frictionloss",),
    "": ("armature", "stiffness", "springref", "ref", "gravity"),
}
OF_MJCF = {name: quantity for quantity, names in MJCF.items() for name in names}

#: What is allowed.
ALLOWED = f"allowed: 0, or from {1 / MAX_NUMBER:g} to {MAX_NUMBER:g} in size"


def beyond(model: RobotModel, file: str) -> tuple[FileFault, ...]:
    """Return the names, numbers and sizes of a model that are beyond the limits; `file` is the name of its file.

    Numbers that are not finite have faults of their own. Raises `BadInput` if there are too many links or joints.
    """
    for count, kind in ((len(model.links), "links"), (len(model.joints), "joints")):
        if count > MAX_LINKS:
            raise BadInput(f"{file}: has {count} {kind}; allowed: at most {MAX_LINKS}")
    return tuple([*_beyond(model, file), *_of_size(model, file)][:MAX_FAULTS])


def beyond_in_text(root: Element) -> tuple[FileFault, ...]:
    """Return the numbers of an MJCF file that are not finite or beyond the limits.

    They are looked for in the text too, because MuJoCo may make finite numbers of them.
    """
    faults = []
    for element in root.everything():
        for name, text in element.attributes.items():
            values = read_numbers(text) if local(name) in OF_MJCF else None
            if values is not None and not (np.isfinite(values).all() and _within(values)):
                message = f"{place(element, name)}: read {quoted(text)}; {ALLOWED}"
                faults.append(FileFault("model", OF_MJCF[local(name)], message))
    return tuple(faults[:MAX_FAULTS])


def is_finite(model: RobotModel) -> bool:
    """Return whether all numbers of the links and joints of a model are finite."""
    read = [getattr(link, name) for link in model.links for name in OF_LINK]
    read += [getattr(joint, name) for joint in model.joints for name in (*OF_JOINT, "rotation", "axis")]
    return all(np.isfinite(np.asarray(one, np.longdouble)).all() for one in read if one is not None)


def _beyond(model: RobotModel, file: str) -> Iterator[FileFault]:
    parts: list[tuple[str, RobotLink | RobotJoint, Mapping[str, FaultyQuantity]]] = []
    parts += [("link", link, OF_LINK) for link in model.links]
    parts += [("joint", joint, OF_JOINT) for joint in model.joints]
    for kind, part, quantities in parts:
        if len(part.name) > MAX_NAME:
            message = f"name of a {kind}: read {quoted(part.name)}; allowed: at most {MAX_NAME} characters"
            yield FileFault("model", "parent", f"{file}: {message}")
            continue
        for attribute, quantity in quantities.items():
            if not _within(numbers := getattr(part, attribute)):
                message = f"{attribute.replace('_', ' ')}: read {_largest(numbers):g}; {ALLOWED}"
                yield FileFault(part.name, quantity, f"{file}: {message}")


def _of_size(model: RobotModel, file: str) -> Iterator[FileFault]:
    masses = [abs(_largest(link.mass)) for link in model.links]
    centres = [abs(_largest(link.center_of_mass)) for link in model.links]
    reach = np.sum([max(centres), *(abs(_largest(joint.position)) for joint in model.joints)])
    mass = np.sum(masses)
    if (size := mass * reach**2) > MAX_SIZE:
        message = f"all masses times the square of the largest distance are {size:.3g} kg m^2; allowed: at most {MAX_SIZE:g}"
        yield FileFault("model", "inertia", f"{file}: {message}")


def _largest(numbers: Any) -> np.longdouble:
    """Return the finite number of the largest size; 0 if there is none."""
    values = np.atleast_1d(np.asarray(() if numbers is None else numbers, np.longdouble)).ravel()
    return max(values[np.isfinite(values)], key=abs, default=np.longdouble(0))


def _within(numbers: float | Sequence[float] | None) -> bool:
    size = abs(_largest(numbers))
    return bool(size == 0 or 1 / MAX_NUMBER <= size <= MAX_NUMBER)
