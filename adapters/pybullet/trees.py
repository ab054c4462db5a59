"""Write the trees of a mechanism as URDF files, of which PyBullet makes its bodies in reduced coordinates."""

from collections.abc import Sequence

from bodycheck.adapters.mechanisms import link_of
from bodycheck.adapters.urdf import angles, link_element, spaced
from bodycheck.reference.mechanisms.exact import nearest_axis, nearest_turn
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism

#: PyBullet's names of the types of joints. Limits of which the lower one is above the upper one are none.
TYPES = {"revolute": "continuous", "prismatic": "prismatic", "spherical": "spherical", "fixed": "fixed"}

#: The base of a tree that is fixed to the world.
FIXED_BASE = (
    '<link name="world"><inertial><mass value="0"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)


def document(mechanism: Mechanism, tree: Sequence[int]) -> str:
    """Return the URDF file of a tree. Bodies and joints have the names body_k and joint_k by the place k of the body."""
    root, *others = tree
    parts = [FIXED_BASE if root == WORLD else link_element(f"body_{root}", link_of(mechanism.bodies[root]))]
    for place in others:
        joint = mechanism.joint_of[place]
        assert joint is not None  # only roots have none
        parts += [link_element(f"body_{place}", link_of(mechanism.bodies[place])), joint_element(joint)]
    return "\n".join(['<?xml version="1.0"?>', '<robot name="mechanism">', *parts, "</robot>", ""])


def joint_element(joint: Joint) -> str:
    """Return the element of a joint with its damping."""
    parent = "world" if joint.parent == WORLD else f"body_{joint.parent}"
    return (
        f'<joint name="joint_{joint.child}" type="{TYPES[joint.type]}">'
        f'<parent link="{parent}"/><child link="body_{joint.child}"/>'
        f'<origin xyz="{spaced(joint.position)}" rpy="{spaced(angles(nearest_turn(joint.attitude)))}"/>'
        f'<axis xyz="{spaced(nearest_axis(joint))}"/><limit lower="0" upper="-1" effort="0" velocity="0"/>'
        f'<dynamics damping="{spaced([joint.damping])}" friction="0"/></joint>'
    )
