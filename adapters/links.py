"""Links of bodies in the forms in which engines take them."""

from collections.abc import Sequence

import numpy as np

from bodycheck.adapters.contract import Link
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.scene import Body, Scene
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
