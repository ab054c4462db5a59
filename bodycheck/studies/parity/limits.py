"""The limits of a robot model that is compared; its numbers have those of cases, so that no term overflows.

A model beyond them is a fault of its file, and engines are not compared with it.
"""

from collections.abc import Iterator

import numpy as np

from bodycheck.casefile.values import MAX_NUMBER
from bodycheck.errors import BadInput
from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel
from bodycheck.robots.elements import quoted
from bodycheck.robots.faults import MAX_FAULTS, FaultyQuantity, FileFault
from bodycheck.robots.urdf import MAX_LINKS, MAX_NAME

#: The numbers of a link and of a joint, and the quantities that their faults are about.
OF_LINK: dict[str, FaultyQuantity] = {"mass": "mass", "center_of_mass": "center_of_mass", "inertia": "inertia"}
OF_JOINT: dict[str, FaultyQuantity] = {
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


def beyond(model: RobotModel, file: str) -> tuple[FileFault, ...]:
    """Return the names and numbers of a model that are beyond the limits; `file` is the name of its file.

    Numbers that are not finite have faults of their own. Raises `BadInput` if there are too many links or joints.
    """
    for count, kind in ((len(model.links), "links"), (len(model.joints), "joints")):
        if count > MAX_LINKS:
            raise BadInput(f"{file}: has {count} {kind}; allowed: at most {MAX_LINKS}")
    return tuple(_beyond(model, file))[:MAX_FAULTS]


def is_finite(model: RobotModel) -> bool:
    """Return whether all numbers of the links and joints of a model are finite."""
    read = [getattr(link, name) for link in model.links for name in OF_LINK]
    read += [getattr(joint, name) for joint in model.joints for name in (*OF_JOINT, "rotation", "axis")]
    return all(np.isfinite(np.asarray(one, np.longdouble)).all() for one in read if one is not None)


def _beyond(model: RobotModel, file: str) -> Iterator[FileFault]:
    parts: list[tuple[str, RobotLink | RobotJoint, dict[str, FaultyQuantity]]] = []
    parts += [("link", link, OF_LINK) for link in model.links]
    parts += [("joint", joint, OF_JOINT) for joint in model.joints]
    for kind, part, quantities in parts:
        if len(part.name) > MAX_NAME:
            told = f"name of a {kind}: read {quoted(part.name)}; allowed: at most {MAX_NAME} characters"
            yield FileFault("model", "parent", f"{file}: {told}")
            continue
        for attribute, quantity in quantities.items():
            if (read := _too_large(getattr(part, attribute))) is not None:
                told = f"{attribute.replace('_', ' ')}: read {read:g}; allowed: at most {MAX_NUMBER:g} in size"
                yield FileFault(part.name, quantity, f"{file}: {told}")
    if (read := _too_large(model.gravity)) is not None:
        yield FileFault("model", "", f"{file}: gravity: read {read:g}; allowed: at most {MAX_NUMBER:g} in size")


def _too_large(numbers: object) -> np.longdouble | None:
    """Return the first finite number that is too large; None if there is none."""
    values = np.atleast_1d(np.asarray([] if numbers is None else numbers, np.longdouble)).ravel()
    large = values[np.isfinite(values) & (np.abs(values) > MAX_NUMBER)]
    return large[0] if large.size else None
