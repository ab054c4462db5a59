"""The impulses of two spheres that hit each other, and of a sphere that hits the plane.

With the unit vector n from the first sphere to the second, the point of contact of the first has, relative to that of the
second, the velocity u = v1 - v2 + (r1 w1 + r2 w2) x n. An impulse along n changes only the velocities of the centres. An
impulse J across n changes u by J (b1 + b2), with b = 1/m + r^2/I, so that the slip keeps its direction during the impact. By
Coulomb's law, friction ends the slip if this needs at most the friction times the impulse along n; otherwise it exerts this
largest impulse against the slip.
"""

from dataclasses import dataclass, replace

from bodycheck.reference.contact.spheres.ball import Ball, Law, Moving, never_slips, size
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Real, Vector3
from bodycheck.reference.exact.rotations import ORIGIN, cross, dot, minus, plus, scaled

#: The normal of the plane.
UP: Vector3 = (MP.mpf(0), MP.mpf(0), MP.mpf(1))


@dataclass(frozen=True, eq=False)
class Impulse:
    """An impulse.

    Attributes
    ----------
    on_first
        The impulse (N s) on the first sphere; on the second sphere it is the opposite one.
    grip
        The smallest coefficient of friction that ends the slip.
    """

    on_first: Vector3
    grip: Real


def between(balls: tuple[Ball, Ball], moving: tuple[Moving, Moving], law: Law) -> Impulse:
    """Return the impulse of two spheres that touch and approach each other."""
    (first, second), (one, other) = balls, moving
    normal = direction(one, other)
    turning = plus(scaled(first.radius, one.spin), scaled(second.radius, other.spin))
    slipping = plus(minus(one.velocity, other.velocity), cross(turning, normal))
    inertia = 1 / (1 / first.mass + 1 / second.mass)
    return _impulse(slipping, normal, inertia, 1 / (first.mobility + second.mobility), law)


def on_plane(ball: Ball, moving: Moving, law: Law) -> Impulse:
    """Return the impulse of the plane on a sphere that hits it."""
    return _impulse(slip(ball, moving), scaled(MP.mpf(-1), UP), ball.mass, 1 / ball.mobility, law)


def slip(ball: Ball, moving: Moving) -> Vector3:
    """The velocity (m/s) of the lowest point of a sphere."""
    return minus(moving.velocity, scaled(ball.radius, cross(moving.spin, UP)))


def _impulse(velocity: Vector3, normal: Vector3, inertia: Real, inertia_across: Real, law: Law) -> Impulse:
    """Return the impulse on a body whose point of contact moves with a velocity (m/s) along and across a normal.

    inertia, inertia_across: impulses per change of this velocity along and across the normal (kg).
    """
    closing = dot(velocity, normal)
    along = (1 + law.restitution) * inertia * closing
    across = minus(velocity, scaled(closing, normal))
    speed = size(across) if size(across) > NEGLIGIBLE * size(velocity) else MP.zero
    needed = inertia_across * speed
    exerted = needed if never_slips(law) else min(needed, law.friction * along)
    friction = scaled(-exerted / speed, across) if speed else ORIGIN
    return Impulse(plus(scaled(-along, normal), friction), needed / along)


def struck(ball: Ball, moving: Moving, impulse: Vector3, normal: Vector3) -> Moving:
    """Return a sphere after an impulse (N s) at the point of its surface in the direction of a unit vector."""
    return replace(
        moving,
        velocity=plus(moving.velocity, scaled(1 / ball.mass, impulse)),
        spin=plus(moving.spin, scaled(ball.radius / ball.moment, cross(normal, impulse))),
    )


def direction(one: Moving, other: Moving) -> Vector3:
    """The unit vector from the centre of one sphere to that of another."""
    apart = minus(other.position, one.position)
    return scaled(1 / size(apart), apart)
