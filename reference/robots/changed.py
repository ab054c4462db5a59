"""Robot models with other numbers in one link or joint: what a model would be if a reader took something else for it."""

from dataclasses import replace
from typing import Any

from bodycheck.reference.robots.model import RobotModel


def with_link(model: RobotModel, name: str, **changes: Any) -> RobotModel:
    """The model with other attributes of the link of a name. Raises `KeyError` if there is none."""
    index = _place([link.name for link in model.links], name)
    links = list(model.links)
    links[index] = replace(links[index], **changes)
    return replace(model, links=tuple(links))


def with_joint(model: RobotModel, name: str, **changes: Any) -> RobotModel:
    """The model with other attributes of the joint of a name. Raises `KeyError` if there is none."""
    index = _place([joint.name for joint in model.joints], name)
    joints = list(model.joints)
    joints[index] = replace(joints[index], **changes)
    return replace(model, joints=tuple(joints))


def _place(names: list[str], name: str) -> int:
    if name not in names:
        raise KeyError(name)
    return names.index(name)
