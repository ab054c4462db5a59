"""Bodies that are made of links: the optional part of the contract for them, and functions that convert them for engines.

Some engines take the inertia tensor of a link only from a URDF file: `urdf` writes one.
"""

import math
import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from bodycheck.adapters.contract import Method, Simulation
from bodycheck.reference.inertia import IDENTITY, inertia_tensor
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.scene import Body, Quaternion, Scene, State, Vector
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True)
class Link:
    """A part of a rigid body, described in its own frame, as files of robots describe it.

    Parameters
    ----------
    mass
        The mass (kg).
    inertia
        The components xx, yy, zz, xy, xz, yz of the inertia tensor about the link's centre of mass, along the axes of the
        link's frame (kg m^2).
    center_of_mass
        The centre of mass, in the link's frame (m).
    position
        The origin of the link's frame, in the frame of the first link of the body (m).
    quaternion
        The unit quaternion (w, x, y, z) that converts components in the link's frame to components in the first link's frame.
    """

    mass: float
    inertia: tuple[float, float, float, float, float, float]
    center_of_mass: Vector = (0.0, 0.0, 0.0)
    position: Vector = (0.0, 0.0, 0.0)
    quaternion: Quaternion = (1.0, 0.0, 0.0, 0.0)


@runtime_checkable
class Links(Protocol):
    """An adapter that can give its engine a body as one or several links, which are welded together."""

    def prepare_links(self, links: Sequence[Link], scene: Scene, method: Method) -> Simulation:
        """Return a simulation of a free body that is made of links, at t = 0.

        The engine receives each link as it is: the tensors, centres of mass and welds of the links are not merged into one
        body. The states of the simulation are those of the frame of the first link: the position and the velocity of its
        origin, its attitude, and the angular velocity along its axes.

        Parameters
        ----------
        links
            The links. The frame of the first link is the frame of the body.
        scene
            The initial state of the frame of the first link, and gravity. It has neither plane nor drag, and its body is
            ignored.
        method
            The method, which the caller has checked as for `Adapter.prepare`.

        Raises
        ------
        SceneUnsupported
            If the engine cannot take a body in this form.
        """
        ...


def link_of(body: Body) -> Link:
    """Return a body as a single link, whose origin is the centre of mass and whose axes are the axes of the body's frame."""
    inertia = inertia_tensor(body)
    xx, yy, zz, xy, xz, yz = (float(inertia[index]) for index in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    return Link(body.mass, (xx, yy, zz, xy, xz, yz))


def links_of(scene: Scene, links: Sequence[Link] = ()) -> Sequence[Link]:
    """Return the given links; if there are none, return the body of the scene as a single link."""
    return links or (link_of(scene.body),)


def tensor(link: Link) -> Array:
    """Return the inertia tensor (3, 3), kg m^2, of a link about its centre of mass, along the axes of its frame."""
    xx, yy, zz, xy, xz, yz = link.inertia
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def carried(rows: Array, position: ArrayLike, quaternion: ArrayLike) -> Array:
    """Return the states of a frame, from the states of another frame that is fixed to the same body.

    Parameters
    ----------
    rows
        The states (n, 13) of the other frame in the columns of `bodycheck.adapters.contract.Simulation.advance`; quaternions
        may have any norm, which they keep.
    position
        The origin (3,) of the frame in the other one (m).
    quaternion
        The quaternion (4,), of any norm, that converts components in the frame to components in the other frame.

    Returns
    -------
    The states (n, 13): position and velocity of the frame's origin, the frame's attitude, and the angular velocity along its
    axes.
    """
    origin, attitude, velocity, spin = np.split(rows, (3, 7, 10), axis=1)
    arm = np.broadcast_to(np.asarray(position, dtype=float), origin.shape)
    turn = np.broadcast_to(normalise(np.asarray(quaternion, dtype=float)), attitude.shape)
    turned = normalise(attitude)
    origin = origin + rotate(turned, arm)
    velocity = velocity + rotate(turned, np.cross(spin, arm))
    return np.concatenate([origin, multiply(attitude, turn), velocity, rotate(conjugate(turn), spin)], axis=1)


def state_in(frame: tuple[ArrayLike, ArrayLike], other: State) -> State:
    """Return the state of a frame, from the state of another frame in which it has a fixed position and quaternion."""
    row = np.array([*other.position, *other.quaternion, *other.velocity, *other.angular_velocity])
    origin, attitude, velocity, spin = np.split(carried(row[None], *frame)[0], (3, 7, 10))
    return State(*(tuple(part.tolist()) for part in (origin, attitude, velocity, spin)))


def velocity_to_origin(rows: Array, centre: ArrayLike) -> Array:
    """Return states (n, 13) of a link's frame, from rows (n, 13) whose velocity is the velocity of the link's centre of mass.

    `centre` is the centre of mass (3,) in the link's frame (m).
    """
    attitude, spin = normalise(rows[:, 3:7]), rows[:, 10:]
    moved = rows.copy()
    moved[:, 7:10] -= rotate(attitude, np.cross(spin, np.asarray(centre, dtype=float)))
    return moved


def velocity_of(point: ArrayLike, frame: State) -> Vector:
    """Return the velocity (m/s, world) of a point that is fixed in a moving frame at the position (3,), in m."""
    return state_in((point, IDENTITY), frame).velocity


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
