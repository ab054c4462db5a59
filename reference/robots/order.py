"""The order of the joints of a robot model from the root on."""

from bodycheck.reference.robots.model import RobotJoint, RobotModel


def from_the_root(model: RobotModel) -> tuple[RobotJoint, ...]:
    """The joints, each followed by all that hang on its child, and those of one parent in the order of the file.

    Raises `ValueError` if the joints are no tree: if a link is the child of two joints, or if the root does not lead to it.
    """
    carried: dict[int, list[RobotJoint]] = {}
    for joint in model.joints:
        carried.setdefault(joint.parent, []).append(joint)
    if len({joint.child for joint in model.joints}) < len(model.joints):
        raise ValueError("a link is the child of two joints")
    ordered: list[RobotJoint] = []
    waiting = carried.get(model.root, [])[::-1]
    while waiting:
        ordered.append(joint := waiting.pop())
        waiting += carried.get(joint.child, [])[::-1]
    if len(ordered) + 1 < len(model.links):
        raise ValueError("the root does not lead to all links")
    return tuple(ordered)
