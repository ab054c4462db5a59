"""Representations of one body, which are equivalent in mechanics but may not be equivalent for an engine.

The principal frame of a body has its origin at the centre of mass and its axes along the principal axes. A representation may
have another frame, in which the engine is given the body and returns its states.
"""

from dataclasses import dataclass, replace

import numpy as np

from bodycheck.adapters.links import Link, carried, link_of, state_in
from bodycheck.reference.inertia import IDENTITY, inertia_tensor
from bodycheck.reference.kinematics import conjugate, normalise, rotate
from bodycheck.reference.scene import Body, Quaternion, Scene, Vector, vector_of
from bodycheck.reference.trajectory import Array

#: The separation of the centres of mass of the two links of `split`, as mu d^T S^-1 d. At 1, both links would have no extent in
#: one direction.
SEPARATION_SQUARED = 0.5

#: The frames of representations: a turn by about 80 degrees about an oblique axis, and a displacement (m) of the size of the
#: body.
TURN: Quaternion = (0.76, 0.4, -0.3, float(np.sqrt(1 - 0.76**2 - 0.4**2 - 0.3**2)))
OFFSET: Vector = (0.11, -0.07, 0.05)
#: The fraction of the mass that the second of two links has.
SHARE = 0.375


@dataclass(frozen=True)
class Representation:
    """A body in one of the forms in which it can be given to an engine.

    Parameters
    ----------
    name
        The representation in words.
    body
        The body, which the engine is given if there are no links.
    links
        The links of which the body is made; empty if the engine is given the body itself.
    axes
        The quaternion (w, x, y, z) that rotates components along the principal axes to components in the frame of the states.
    centre
        The centre of mass, in the frame of the states (m).
    """

    name: str
    body: Body
    links: tuple[Link, ...] = ()
    axes: Quaternion = IDENTITY
    centre: Vector = (0.0, 0.0, 0.0)


def representations(body: Body) -> tuple[Representation, ...]:
    """Return representations of a body that is given along its principal axes.

    The first representation has twice the mass and twice the moments of inertia, and moves like the given body as long as no
    forces except gravity act. All other representations are of the given body itself.
    """
    first, second, third = body.moments
    heavy = replace(body, mass=2 * body.mass, moments=(2 * first, 2 * second, 2 * third))
    turned = replace(body, axes=TURN)
    aside = replace(link_of(body), center_of_mass=OFFSET)
    return (
        Representation("mass and moments of inertia times 2", heavy),
        Representation("body frame turned against the principal axes", turned, axes=TURN),
        Representation("full inertia tensor", body, (link_of(turned),), axes=TURN),
        Representation("centre of mass off the origin", body, (aside,), centre=OFFSET),
        Representation("two welded links", body, split(body, SHARE, OFFSET, TURN)),
    )


def split(body: Body, share: float, position: Vector, quaternion: Quaternion) -> tuple[Link, Link]:
    """Return two links that make up a body when they are welded together.

    The second moments of the body, S = tr(J) / 2 - J with its inertia tensor J, are the sum of the second moments of the two
    parts about their own centres of mass and of the second moments mu d d^T of two point masses at these centres, with the
    separation d and the reduced mass mu. If mu d^T S^-1 d < 1, both parts are physically possible bodies; here it is
    `SEPARATION_SQUARED`.

    Parameters
    ----------
    body
        The body. Its frame is that of the first link.
    share
        The fraction of the mass that the second link has, above 0 and below 1.
    position, quaternion
        The frame of the second link, as in `Link`.
    """
    tensor = inertia_tensor(body)
    second_moments = np.trace(tensor) / 2 * np.eye(3) - tensor
    reduced = share * (1 - share) * body.mass
    apart = np.linalg.cholesky(second_moments / reduced) @ np.full(3, np.sqrt(SEPARATION_SQUARED / 3))
    parts = second_moments - reduced * np.outer(apart, apart)
    inertia = np.trace(parts) * np.eye(3) - parts
    back = conjugate(normalise(np.array(quaternion)))
    aside = rotate(back, (1 - share) * apart - np.array(position))
    turned = rotate(back, rotate(back, share * inertia).T)
    return (
        Link((1 - share) * body.mass, _components((1 - share) * inertia), vector_of(-share * apart)),
        Link(share * body.mass, _components(turned), vector_of(aside), position, quaternion),
    )


def started(given: Representation, scene: Scene) -> Scene:
    """Return a scene with the body in a representation, from the scene with the body along its principal axes.

    The initial state of the result is the state of the frame of the representation.
    """
    back = conjugate(normalise(np.array(given.axes)))
    return replace(scene, body=given.body, initial=state_in((-rotate(back, np.array(given.centre)), back), scene.initial))


def along_principal_axes(given: Representation, rows: Array) -> Array:
    """Return states (n, 13) of the principal frame, from states (n, 13) of the frame of a representation.

    Both have the columns of `bodycheck.adapters.contract.Simulation.advance`.
    """
    return carried(rows, given.centre, given.axes)


def _components(tensor: Array) -> tuple[float, float, float, float, float, float]:
    """Return the components of a symmetric tensor (3, 3) in the order of `Link.inertia`."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor.tolist()
    return xx, yy, zz, xy, xz, yz
