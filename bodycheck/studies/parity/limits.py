"""The limits of a robot model that is compared: those of cases, so that no term of a model overflows.

A model beyond them is a fault of its file, and no engine is compared with it.
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


def _beyond(model: RobotModel, file: str) -> Iterator[FileFault]:
    parts: list[tuple[str, RobotLink | RobotJoint, dict[str, FaultyQuantity]]] = []
    parts += [("link", link, OF_LINK) for link in model.links]
    parts += [("joint", joint, OF_JOINT) for joint in model.joints]
    for kind, part, quantities in parts:
        where = f"{file}: {kind} {quoted(part.name)}"
        if len(part.name) > MAX_NAME:
            yield FileFault("model", "parent", f"{where}: its name has more than {MAX_NAME} characters")
            continue
        for attribute, quantity in quantities.items():
            if (read := _too_large(getattr(part, attribute))) is not None:
                what = attribute.replace("_", " ")
                yield FileFault(part.name, quantity, f"{where}: {what}: read {read:g}; allowed: at most {MAX_NUMBER:g} in size")
    if (read := _too_large(model.gravity)) is not None:
        yield FileFault("model", "", f"{file}: gravity: read {read:g}; allowed: at most {MAX_NUMBER:g} in size")


def _too_large(numbers: object) -> np.longdouble | None:
    """Return the first finite number that is too large; None if there is none."""
    values = np.atleast_1d(np.asarray([] if numbers is None else numbers, np.longdouble)).ravel()
    large = values[np.isfinite(values) & (np.abs(values) > MAX_NUMBER)]
    return large[0] if large.size else None
