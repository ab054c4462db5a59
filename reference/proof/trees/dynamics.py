"""The inverse dynamics and the poses of a tree of links, in any arithmetic.

The inverse dynamics gives the efforts at the joints that a motion needs. They are polynomials of velocities, accelerations, and
sines and cosines of angles, so that they can be computed with balls, with power series of balls, and with derivatives. The
coordinates of a ball are the quaternion q of its turn. Its length remains 1 by the equation (q . q)'' = 0, which is added along
q to the equations of the torques; so all of them are polynomials, and the mass matrix is positive definite.
"""

from collections.abc import Sequence
from typing import Any

from flint import arb

from bodycheck.reference.proof.balls import (
    UNIT,
    Matrix,
    Triple,
    applied,
    cross,
    product,
    quaternion_rows,
    scaled,
    transposed,
    vector_sum,
)
from bodycheck.reference.proof.trees.tree import Link, Number, Rows, Tree, Vector, as_number


def times(a: Number, b: Number) -> Number:
    """Return a product, which takes no time if a factor is exactly 0, 1 or -1."""
    for one, other in ((a, b), (b, a)):
        if type(one) is int:
            return 0 if one == 0 else other if one == 1 else -other if one == -1 else one * other
    return a * b


def plus(*terms: Number) -> Number:
    """Return a sum, without terms that are exactly 0."""
    whole: Number = 0
    for term in terms:
        if type(term) is int and term == 0:
            continue
        whole = term if type(whole) is int and whole == 0 else whole + term
    return whole


def negative(value: Number) -> Number:
    """Return the negative of a number."""
    return -value


def crossed(a: Vector, b: Vector) -> list[Number]:
    """Return the cross product of two vectors."""
    return [
        plus(times(a[1], b[2]), negative(times(a[2], b[1]))),
        plus(times(a[2], b[0]), negative(times(a[0], b[2]))),
        plus(times(a[0], b[1]), negative(times(a[1], b[0]))),
    ]


def turned(rows: Rows, v: Vector) -> list[Number]:
    """Return the product of a matrix and a vector."""
    return [plus(*(times(entry, part) for entry, part in zip(row, v, strict=True))) for row in rows]


def back(rows: Rows, v: Vector) -> list[Number]:
    """Return the product of the transpose of a matrix and a vector."""
    return [plus(*(times(rows[i][j], v[i]) for i in range(3))) for j in range(3)]


def added(*vectors: Vector) -> list[Number]:
    """Return the sum of vectors."""
    return [plus(*parts) for parts in zip(*vectors, strict=True)]


def turning_rates(q: Vector, change: Vector) -> list[Number]:
    """Return twice the vector part of the product of the conjugate of a quaternion and its rate, or its second derivative.

    For a unit quaternion it is the angular velocity, or the angular acceleration, in the frame that turns.
    """
    w, *v = q
    rate, *moved = change
    twisted = crossed(v, moved)
    return [2 * plus(times(w, moved[i]), negative(times(v[i], rate)), negative(twisted[i])) for i in range(3)]


def of_torque(q: Vector, v: Vector, a: Vector, torque: Vector) -> list[Number]:
    """Return the four efforts of a ball: the product of its quaternion and the quaternion ((q . q)'' / 2, 2 torque)."""
    w, *axis = q
    stretch = plus(*(times(x, y) for x, y in zip(q, a, strict=True)), *(times(x, x) for x in v))
    twice = [2 * part for part in torque]
    twisted = crossed(axis, twice)
    along = plus(*(times(x, y) for x, y in zip(axis, twice, strict=True)))
    vector = [plus(times(w, twice[i]), times(stretch, axis[i]), twisted[i]) for i in range(3)]
    return [plus(times(w, stretch), negative(along)), *vector]


def _relative(tree: Tree, q: Vector, sines: Vector, cosines: Vector) -> list[Rows]:
    """The attitude of each link in the frame in which its coordinate is zero."""
    turns: list[Rows] = []
    for link in tree.links:
        i = link.first
        if link.kind == "ball":
            turns.append(quaternion_rows(*q[i : i + 4]))
        elif link.kind == "turn":
            turns.append([[cosines[i], negative(sines[i]), 0], [sines[i], cosines[i], 0], [0, 0, 1]])
        else:
            turns.append([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return turns


def efforts(tree: Tree, q: Vector, v: Vector, a: Vector, sines: Vector, cosines: Vector) -> list[Number]:
    """Return the efforts that a motion needs at all joints, less those of springs, dampers and constant forces.

    They are zero for the motion of the tree. q, v, a: coordinates, velocities and accelerations. sines, cosines: of the
    coordinates, of which those of hinges are needed.
    """
    forces: list[list[Number]] = []
    moments: list[list[Number]] = []
    still, up = [0, 0, 0], [0, 0, tree.gravity]
    rates: list[tuple[list[Number], list[Number], list[Number]]] = []
    turns = _relative(tree, q, sines, cosines)
    for link, turn in zip(tree.links, turns, strict=True):
        i = link.first
        w, e, acc = rates[link.parent] if link.parent >= 0 else (still, still, up)
        acc = added(acc, crossed(e, link.offset), crossed(w, crossed(w, link.offset)))
        w, e, acc = (back(turn, back(link.turn, each)) for each in (w, e, acc))
        if link.kind == "slide":
            out, speed = [0, 0, q[i]], [0, 0, v[i]]
            acc = added(acc, crossed(e, out), crossed(w, crossed(w, out)), [0, 0, a[i]])
            coriolis = crossed(w, speed)
            acc = added(acc, coriolis, coriolis)
        else:
            spin, change = _spin(link, q, v), _spin(link, q, a)
            e = added(e, crossed(w, spin), change)
            w = added(w, spin)
        rates.append((w, e, acc))
        moment = link.moment
        forces.append(added([times(link.mass, part) for part in acc], crossed(e, moment), crossed(w, crossed(w, moment))))
        moments.append(added(turned(link.tensor, e), crossed(w, turned(link.tensor, w)), crossed(moment, acc)))
    needed: list[Number] = [0] * tree.size
    for number in range(len(tree.links) - 1, -1, -1):
        link, i = tree.links[number], tree.links[number].first
        force, moment = forces[number], moments[number]
        if link.kind == "ball":
            torque = added(moment, [times(link.damping, part) for part in _spin(link, q, v)])
            needed[i : i + 4] = of_torque(q[i : i + 4], v[i : i + 4], a[i : i + 4], torque)
        else:
            needed[i] = plus(
                (force if link.kind == "slide" else moment)[2],
                times(link.armature, a[i]),
                times(link.damping, v[i]),
                times(link.stiffness, plus(q[i], negative(link.rest))),
                negative(link.effort),
            )
        if link.parent >= 0:
            if link.kind == "slide":
                moment = added(moment, crossed([0, 0, q[i]], force))
            force, moment = (turned(link.turn, turned(turns[number], each)) for each in (force, moment))
            forces[link.parent] = added(forces[link.parent], force)
            moments[link.parent] = added(moments[link.parent], moment, crossed(link.offset, force))
    return needed


def _spin(link: Link, q: Vector, v: Vector) -> list[Number]:
    """The angular velocity of a link that turns relative to its parent, in its own frame; of accelerations likewise."""
    i = link.first
    return turning_rates(q[i : i + 4], v[i : i + 4]) if link.kind == "ball" else [0, 0, v[i]]


def poses(tree: Tree, q: Sequence[Any], v: Sequence[Any]) -> list[tuple[Triple, Matrix, Triple, Triple]]:
    """Return the position of the centre of mass, the attitude, the velocity and the angular velocity of each body, in balls.

    The angular velocity is along the axes of the body.
    """
    zero = arb(0)
    frames: list[tuple[Matrix, Triple, Triple, Triple]] = []  # attitude, origin, velocity of the origin, spin in the world
    world: tuple[Matrix, Triple, Triple, Triple] = (UNIT, (zero, zero, zero), (zero, zero, zero), (zero, zero, zero))
    relative = _relative(tree, q, [value.sin() for value in q], [value.cos() for value in q])
    for link, rows in zip(tree.links, relative, strict=True):
        turn, origin, velocity, spin = frames[link.parent] if link.parent >= 0 else world
        arm = applied(turn, _balls(link.offset))
        now = product(turn, _matrix(link.turn))
        velocity = vector_sum(velocity, cross(spin, arm))
        origin = vector_sum(origin, arm)
        if link.kind == "slide":
            axis = (now[0][2], now[1][2], now[2][2])
            out = scaled(q[link.first], axis)
            velocity = vector_sum(vector_sum(velocity, cross(spin, out)), scaled(v[link.first], axis))
            origin = vector_sum(origin, out)
        else:
            now = product(now, _matrix(rows))
            spin = vector_sum(spin, applied(now, _balls(_spin(link, q, v))))
        frames.append((now, origin, velocity, spin))
    states = []
    for _, body in sorted(tree.bodies.items()):
        turn, origin, velocity, spin = frames[body.link] if body.link >= 0 else world
        arm, now = applied(turn, body.centre), product(turn, body.turn)
        states.append((vector_sum(origin, arm), now, vector_sum(velocity, cross(spin, arm)), applied(transposed(now), spin)))
    return states


def joint_states(tree: Tree, q: Sequence[Any], v: Sequence[Any], count: int) -> tuple[list[Any], list[Any]]:
    """Return the first `count` coordinates and the velocities that belong to them, in the layout of `coordinates`."""
    position, velocity = list[Any](), list[Any]()
    for _, link in sorted(((tree.columns[link.first], link) for link in tree.links), key=lambda pair: pair[0]):
        if tree.columns[link.first] < count:
            position += q[link.first : link.first + len(link.start)]
            velocity += _spin(link, q, v) if link.kind == "ball" else [v[link.first]]
    return position, velocity


def _matrix(rows: Rows) -> Matrix:
    return _balls(rows[0]), _balls(rows[1]), _balls(rows[2])


def _balls(values: Vector) -> Triple:
    x, y, z = map(as_number, values)
    return x, y, z
