"""A body that lies flat on a level plane in balls: it rests, slides without a spin, or spins in its place.

Friction then has a constant force, and a constant moment: mu times the load and the mean distance of the face from its centre.
So it is also, by definition, with friction that brakes translation and spin apart. A body that slides and spins at once has no
proof.
"""

from collections.abc import Callable

from flint import arb

from bodycheck.reference.proof.balls import Ball, Matrix, Triple, about, ball, product, scaled, size_of
from bodycheck.reference.proof.bodies import as_ball
from bodycheck.reference.proof.contact.start import Placed, Surroundings
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.scene import Brick, Cylinder, Plane, Shape


def states(body: Placed, law: Plane, plane: Surroundings) -> Callable[[Ball], tuple[Triple, Matrix, Triple, Triple]]:
    """Return the position, the attitude, the velocity and the angular velocity along the axes of the body at a time (s)."""
    x, y, _ = body.velocity
    speed, spin = size_of((x, y)), body.world[3][2]
    still, brake = speed.is_zero(), ball(law.friction) * plane.onto
    if not (still or spin.is_zero() or brake.is_zero() or law.law == "decoupled"):
        raise NotEnclosed("friction over an area of a body that slides and spins")
    moment = brake * ball(body.mass) * _mean_distance(body.shape, law.law) / as_ball(body.inertia[2][2])
    ways = [_braked(size, rate) for size, rate in ((speed, brake), (abs(spin), moment))]

    def at(t: Ball) -> tuple[Triple, Matrix, Triple, Triple]:
        (way, left), (turned, kept) = (each(t) for each in ways)
        a, b, c = body.position
        sine, cosine = (spin * turned).sin_cos()
        attitude = product(about(2, sine, cosine), body.world[1])
        return (a + way * x, b + way * y, c), attitude, scaled(left, (x, y, arb(0))), (arb(0), arb(0), kept * spin)

    return at


def _braked(speed: Ball, rate: Ball) -> Callable[[Ball], tuple[Ball, Ball]]:
    """The way over the initial speed (s), and the part of the speed that is left, of a motion that is braked until it ends."""
    if speed.is_zero():
        return lambda _: (arb(0), arb(0))
    if rate.is_zero():
        return lambda t: (t, arb(1))
    end = speed / rate

    def at(t: Ball) -> tuple[Ball, Ball]:
        now = t.min(end)
        return now * (1 - now / (2 * end)), arb(0) if t >= end else 1 - now / end

    return at


def _mean_distance(shape: Shape | None, law: str) -> Ball:
    """The mean distance of a face from its centre, or that of its corners (m)."""
    match shape:
        case Brick((half, other, _)):
            a, b = ball(half), ball(other)
            diagonal = (a * a + b * b).sqrt()
            if law == "corners":
                return diagonal
            return diagonal / 3 + a * a / (6 * b) * (b / a).asinh() + b * b / (6 * a) * (a / b).asinh()
        case Cylinder(radius, _) if law != "corners":
            return 2 * ball(radius) / 3
        case _:
            raise NotEnclosed("a body that does not lie on a face")
