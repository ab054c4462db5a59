"""The witness of several bodies that rest on a plane and on each other: forces at the points of contact that balance them.

Bodies that are released at rest stay there if such forces exist. Every contact pushes, none pulls, and each force is within the
cone of friction. Linear programming finds the forces from the six equations of every body. The points of contact are the
corners of the shared areas, which are equivalent to a pressure anywhere in them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact.witness.faces import DECIMALS, wide_vector
from bodycheck.reference.contact.witness.reading import bodies, surface
from bodycheck.reference.contact.witness.standing import Standing, axes_of, friction_of, shared, shrunk, standing
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.independent.arithmetic import WIDE_EPS, Vector, Wide
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.directions import exact_quaternion
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.scene import Sphere
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Witness

#: Name of the way in results.
NAME = "balance of forces and moments, linear programming"

#: The fraction by which faces and coefficients of friction are made smaller: more than the error of linear programming, so that
#: forces that balance exactly exist beside those that it finds.
SAFE = 1e-6

#: The number of edges of the pyramid within a cone of friction.
EDGES = 8

#: The number of roundings of a state in the wide type.
ROUNDINGS = 8.0


@dataclass(frozen=True, eq=False)
class Contact:
    """A contact of a body with another one below it, or with the plane.

    Attributes
    ----------
    lower, upper
        The indices of the bodies; `WORLD` denotes the plane.
    places
        (k, 3) the points of contact along two axes in the plane and the normal (m).
    forces
        (f, 3) directions of forces on the upper body, of which any sum with positive factors may act at each point.
    gap
        The distance of the two bodies in the file (m), which counts as zero.
    """

    lower: int
    upper: int
    places: Array
    forces: Array
    gap: float


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The rest of several bodies at ascending times (n,) >= 0 (s); None for a scene of another kind.

    Raises `NotModelled` if linear programming finds no forces that balance the weights.
    """
    free, normal = bodies(scene), surface(scene).normal
    if len(free) < 2 or scene.pushes or not scene.gravity or any(any(body.velocity) or any(body.rates) for body in free):
        return None
    stands = [stand for body in free if (stand := standing(body, normal)) is not None]
    if len(stands) < len(free):
        return None
    contacts = list(_contacts(scene, stands, normal))
    if {contact.upper for contact in contacts} != set(range(len(stands))):
        return None
    if not balanced(stands, contacts, normal):
        raise NotModelled("bodies for which no forces within the cones of friction balance the weights")
    count, n = len(free), len(times)
    places = np.array([wide_vector(body.position) for body in free])
    attitudes = np.array([exact_quaternion([list(row) for row in body.cosines]) for body in free])
    none = np.zeros((count, n, 3), dtype=Wide)
    tilt, gap = max(stand.tilt for stand in stands), max(contact.gap for contact in contacts)
    size = float(np.abs(places).max()) + max(stand.half for stand in stands)
    return Witness(
        NAME,
        quaternion=np.repeat(attitudes[:, None], n, axis=1),
        angular_velocity=none,
        position=np.repeat(places[:, None], n, axis=1),
        velocity=none,
        error=tilt + ROUNDINGS * WIDE_EPS,
        position_error=count * (gap + tilt * size) + ROUNDINGS * WIDE_EPS * size,
        events=(),
    )


def _contacts(scene: AnyScene, stands: Sequence[Standing], normal: Vector) -> Iterator[Contact]:
    """Yield the contacts of bodies with what is below them."""
    near = DECIMALS * max(stand.half for stand in stands)
    for upper, above in enumerate(stands):
        below = [(WORLD, MP.zero, above.foot), *((k, each.middle + each.height, each.foot) for k, each in enumerate(stands))]
        for lower, top, foot in below:
            gap = abs(above.middle - above.height - top)
            if lower == upper or gap > near or (lower != WORLD and isinstance(stands[lower].body.shape, Sphere)):
                continue
            area = shared(foot, above.foot) if lower != WORLD else above.foot
            if not len(area):
                continue
            places = np.column_stack([shrunk(area, SAFE), np.full(len(area), float(top))])
            yield Contact(lower, upper, places, _forces(scene, (lower, upper), normal), float(gap))


def _forces(scene: AnyScene, pair: tuple[int, int], normal: Vector) -> Array:
    """The edges (f, 3) of a pyramid within the cone of friction of two bodies, and the vertical if it is within the cone.

    They are along the axes in the plane and the normal. Whether the vertical is in the cone is decided with a hundred digits.
    """
    friction = friction_of(scene, pair)
    along = min(float(friction), 1 / SAFE) * (1 - SAFE)
    angles = 2 * np.pi * np.arange(EDGES) / EDGES
    edges = np.column_stack([along * np.cos(angles), along * np.sin(angles), np.ones(EDGES)])
    if normal[0] > friction * normal[2]:
        return edges
    return np.vstack([[-float(normal[0] / normal[2]), 0.0, 1.0], edges])


def balanced(stands: Sequence[Standing], contacts: Sequence[Contact], normal: Vector) -> bool:
    """Return whether forces at the contacts balance the forces and moments on all bodies."""
    from scipy.optimize import linprog  # imported here, since the import takes longer than most truths

    basis = [np.array([float(part) for part in each]) for each in (*axes_of(normal), normal)]
    down = np.array([float(normal[0]), 0.0, -float(normal[2])])
    columns = []
    for contact in contacts:
        for point in contact.places:
            for force in contact.forces:
                column = np.zeros((len(stands), 6))
                for index, sign in ((contact.upper, 1.0), (contact.lower, -1.0)):
                    if index != WORLD:
                        centre = np.array([float(part) for part in stands[index].body.position])
                        arm = (point - [float(centre @ each) for each in basis]) / stands[index].half
                        column[index] += sign * np.concatenate([force, np.cross(arm, force)])
                columns.append(column.ravel())
    masses = np.array([float(stand.body.mass) for stand in stands])
    weights = np.concatenate([np.concatenate([-mass * down, np.zeros(3)]) for mass in masses])
    scale = np.repeat(masses, 6)
    solution = linprog(np.zeros(len(columns)), A_eq=np.array(columns).T / scale[:, None], b_eq=weights / scale)
    return bool(solution.status == 0)
