"""Random robot models of clear meaning: physical links on joints without damping, friction, mimicry and limits."""

from collections.abc import Sequence
from random import Random

import numpy as np

from bodycheck.reference.kinematics import normalise
from bodycheck.reference.robots.model import RobotJoint, RobotJointType, RobotLink, RobotModel, Wide
from bodycheck.reference.robots.rotations import matrices
from bodycheck.robots.urdf_text import urdf

#: The types of joints that every reader of URDF has.
COMMON: tuple[RobotJointType, ...] = ("revolute", "prismatic", "fixed")


def random_tree(random: Random, joints: int, floating: bool = False, types: Sequence[RobotJointType] = COMMON) -> RobotModel:
    """A random tree of links with turned inertias on joints whose frames are turned, in a random order.

    The root has no mass, and nothing but the first joint hangs on it, which is floating or else not fixed, so that no mass is
    welded to the world.

    Parameters
    ----------
    random
        What is drawn from.
    joints
        The number of joints, at least 1.
    floating
        Whether the first joint is floating.
    types
        The types of all other joints.
    """
    moving = [kind for kind in types if kind != "fixed"]
    bodies = [RobotLink("base", 0.0, _zeros(3), _zeros(3, 3)), *(random_link(random, f"link_{k}") for k in range(joints))]
    kinds = ["floating" if floating else random.choice(moving), *(random.choice(types) for _ in range(joints - 1))]
    # Every other joint continues the chain of the one before, so that there are long chains and branches.
    parents = [0, *(random.choice([k, random.randint(1, k)]) for k in range(1, joints))]
    order = list(range(joints + 1))
    random.shuffle(order)
    place = {old: new for new, old in enumerate(order)}
    made = [
        random_joint(random, f"joint_{k}", kind, place[parent], place[k + 1])
        for k, (kind, parent) in enumerate(zip(kinds, parents, strict=True))
    ]
    random.shuffle(made)
    return RobotModel("tree", tuple(bodies[old] for old in order), tuple(made))


def random_link(random: Random, name: str) -> RobotLink:
    """A link of the size of an arm or a leg, whose principal axes are turned against its frame."""
    mass, turn = random.uniform(0.2, 3.0), random_rotation(random)
    a, b, c = (mass * random.uniform(0.001, 0.02) for _ in range(3))
    tensor = turn @ np.diag(np.array([b + c, a + c, a + b], np.longdouble)) @ turn.T
    nearest = ((tensor + tensor.T) / 2).astype(float).astype(np.longdouble)
    return RobotLink(name, mass, _vector(random, 0.2), nearest)


def random_joint(random: Random, name: str, type: RobotJointType, parent: int, child: int) -> RobotJoint:
    """A joint whose frame is turned, and whose axis is an axis of its frame or another one.

    The frame of every other floating joint is that of the parent, as in most files.
    """
    if type == "floating" and random.random() < 0.5:
        return RobotJoint(name, type, parent, child, _zeros(3), np.eye(3, dtype=np.longdouble), _zeros(3))
    axis = _zeros(3)
    if type in ("revolute", "prismatic", "planar"):
        axis[random.randrange(3)] = random.choice([-1, 1])
        if type != "planar" and random.random() < 0.5:
            axis = normalise(_vector(random, 1.0) + axis)
        elif type == "planar":
            # Readers of planar joints that know other planes than that of x and y are few.
            axis = np.array([0, 0, 1], np.longdouble)
    return RobotJoint(name, type, parent, child, _vector(random, 0.5), random_rotation(random), axis)


def random_rotation(random: Random) -> Wide:
    """A random rotation (3, 3)."""
    turn = np.array([[random.uniform(-1, 1) for _ in range(4)]], np.longdouble)
    return matrices(normalise(turn))[0]


def urdf_with_turned_inertias(model: RobotModel, random: Random) -> str:
    """The URDF of a model, in which the axes of each `<inertial>` are turned against those of its link."""
    return urdf(model, {link.name: random_rotation(random) for link in model.links})


def _vector(random: Random, size: float) -> Wide:
    return np.array([random.uniform(-size, size) for _ in range(3)], np.longdouble)


def _zeros(*shape: int) -> Wide:
    return np.zeros(shape, np.longdouble)
