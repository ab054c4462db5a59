"""Links of bodies in the forms in which engines take them."""

from collections.abc import Sequence

import numpy as np

from bodycheck.adapters.contract import Link
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.kinematics import conjugate, multiply, normalise, rotate
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array


def link_of(body: Body) -> Link:
    """Return the one link that a body is, with its origin at the centre of mass and the axes of the body's frame."""
    inertia = inertia_tensor(body)
    xx, yy, zz, xy, xz, yz = (float(inertia[place]) for place in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    return Link(body.mass, (xx, yy, zz, xy, xz, yz))


def links_of(scene: Scene, links: Sequence[Link] = ()) -> Sequence[Link]:
    """Return links, or where there are none the one link that the body of a scene is."""
    return links or (link_of(scene.body),)


def tensor(link: Link) -> Array:
    """Return the inertia tensor (3, 3), kg m^2, of a link about its centre of mass, along the axes of its frame."""
    xx, yy, zz, xy, xz, yz = link.inertia
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def state_of(link: Link, first: State) -> State:
    """Return the state of the frame of a link, from that of the frame of the first link of its body."""
    attitude, spin, arm = np.array(first.quaternion), np.array(first.angular_velocity), np.array(link.position)
    turn = normalise(np.array(link.quaternion))
    px, py, pz = (np.array(first.position) + rotate(attitude, arm)).tolist()
    vx, vy, vz = (np.array(first.velocity) + rotate(attitude, np.cross(spin, arm))).tolist()
    w, x, y, z = multiply(attitude, turn).tolist()
    wx, wy, wz = rotate(conjugate(turn), spin).tolist()
    return State((px, py, pz), (w, x, y, z), (vx, vy, vz), (wx, wy, wz))
