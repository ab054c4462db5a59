"""Write links as a URDF file, for engines that take the inertia tensor of a link only from such a file."""

import math
import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from bodycheck.adapters.links import Link
from bodycheck.reference.scene import Quaternion


def urdf(links: Sequence[Link]) -> str:
    """Return a URDF file of a body whose links are joined to the first one by fixed joints.

    The links are named link_0, link_1 and so on, and have no shapes. Numbers are written with all their digits; rotations are
    rounded, because URDF describes them by angles.
    """
    parts = [link_element(f"link_{number}", link) for number, link in enumerate(links)]
    joints = [_joint(number, link) for number, link in enumerate(links[1:], 1)]
    return "\n".join(['<?xml version="1.0"?>', '<robot name="body">', *parts, *joints, "</robot>", ""])


def angles(quaternion: Quaternion) -> tuple[float, float, float]:
    """Return the angles (rad) of rotations about the fixed axes x, y and z, in this order, that make up a unit quaternion.

    Half the sum and half the difference of the first and the third angle are the arguments of two complex numbers. In gimbal
    lock one of these numbers is zero, and both angles then have the same size.
    """
    w, x, y, z = quaternion
    half_sum, half_difference = math.atan2(x + z, w - y), math.atan2(x - z, w + y)
    about_y = 2 * math.atan2(math.hypot(w + y, x - z), math.hypot(w - y, x + z)) - math.pi / 2
    return half_sum + half_difference, about_y, half_sum - half_difference


def link_element(name: str, link: Link) -> str:
    """Return the URDF element of a link without shapes."""
    moments = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), link.inertia, strict=True)
    inertia = " ".join(f'{moment}="{spaced([value])}"' for moment, value in moments)
    return (
        f'<link name="{name}"><inertial><origin xyz="{spaced(link.center_of_mass)}" rpy="0 0 0"/>'
        f'<mass value="{spaced([link.mass])}"/><inertia {inertia}/></inertial></link>'
    )


def _joint(number: int, link: Link) -> str:
    return (
        f'<joint name="weld_{number}" type="fixed"><parent link="link_0"/><child link="link_{number}"/>'
        f'<origin xyz="{spaced(link.position)}" rpy="{spaced(angles(link.quaternion))}"/></joint>'
    )


def spaced(numbers: Sequence[float]) -> str:
    """Return numbers as text, separated by spaces, with all their digits."""
    return " ".join(repr(float(number)) for number in numbers)


@contextmanager
def file_of(text: str) -> Iterator[str]:
    """Yield the path of a file that contains a text; the file exists while this context lasts."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "body.urdf")
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text)
        yield path
