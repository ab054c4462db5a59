"""Springs and dampers of MJCF that are given by a time constant and a damping ratio, as MuJoCo's compiler makes them."""

from bodycheck.casefile.robots.mjcf_carriers import Tree
from bodycheck.casefile.robots.numbers import numbers
from bodycheck.robots.elements import refuse


def set_springs(tree: Tree) -> None:
    """Set the stiffness and damping of joints with `springdamper`."""
    for joint in tree.joints:
        if joint.element.tag == "joint" and any(numbers(joint.element, "springdamper", (2,), (0.0, 0.0))):
            refuse(joint.element, "springdamper", "is not read yet")
