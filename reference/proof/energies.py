"""Energy and angular momentum of the bodies of a scene, from their states in balls."""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import AnyScene, Joint, Mechanism
from bodycheck.reference.proof.balls import Ball, Matrix, Triple, applied, ball, cross, dot, scaled, squared, vector_sum
from bodycheck.reference.proof.bodies import as_ball, inertia, rotor
from bodycheck.reference.proof.mass import mass_of
from bodycheck.reference.proof.motions import Shown

#: A function from states to the energy (J), from some height on, and the angular momentum about the centre of mass (kg m^2/s).
Conserved = Callable[[Shown], tuple[Ball, Triple]]


@dataclass(frozen=True, eq=False)
class _Massive:
    """A body: its mass (kg), and the rows of its inertia tensor in its frame (kg m^2)."""

    mass: Ball
    tensor: Matrix


def conserved(scene: AnyScene) -> Conserved:
    """Return the function of the energy and of the angular momentum of a scene, world components.

    The energy is that of the bodies, of gravity, and of the armatures, springs, elastic stops and constant efforts of joints
    with one coordinate. It needs the coordinates of joints.
    """
    bodies, gravity = _bodies(scene), ball(scene.gravity)
    joints: list[tuple[Joint, int, int]] = []
    if isinstance(scene, Mechanism):
        held = zip(scene.joints, places(scene), strict=True)
        joints = [(joint, one.start, other.start) for joint, (one, other) in held if joint.type in ("revolute", "prismatic")]

    def at(shown: Shown) -> tuple[Ball, Triple]:
        energy = sum((_of_joint(joint, shown.position[i], shown.velocity[j]) for joint, i, j in joints), arb(0))
        momenta = []
        for body, (position, turn, velocity, rates) in zip(bodies, shown.bodies, strict=True):
            spin = applied(body.tensor, rates)
            energy += (body.mass * dot(velocity, velocity) + dot(spin, rates)) / 2 + body.mass * gravity * position[2]
            momenta.append(applied(turn, spin))
        return energy, _about_centre(bodies, shown, momenta)

    return at


def _bodies(scene: AnyScene) -> list[_Massive]:
    if not isinstance(scene, Mechanism):
        return [_Massive(ball(scene.body.mass), rotor(scene).tensor)]
    bodies = []
    for body in scene.bodies:
        a, b, c = ((as_ball(x), as_ball(y), as_ball(z)) for x, y, z in inertia(body.inertia))
        bodies.append(_Massive(ball(mass_of(body)), (a, b, c)))
    return bodies


def _about_centre(bodies: list[_Massive], shown: Shown, momenta: list[Triple]) -> Triple:
    """The angular momentum about the common centre of mass, from those of the bodies about their own."""
    total: Triple = (arb(0), arb(0), arb(0))
    for each in momenta:
        total = vector_sum(total, each)
    whole = sum((body.mass for body in bodies), arb(0))
    if len(bodies) == 1 or whole.is_zero():
        return total
    centre, common = ((arb(0), arb(0), arb(0)), (arb(0), arb(0), arb(0)))
    for body, (position, _, velocity, _) in zip(bodies, shown.bodies, strict=True):
        centre = vector_sum(centre, scaled(body.mass / whole, position))
        common = vector_sum(common, scaled(body.mass / whole, velocity))
    for body, (position, _, velocity, _) in zip(bodies, shown.bodies, strict=True):
        arm, speed = (vector_sum(one, scaled(arb(-1), mean)) for one, mean in ((position, centre), (velocity, common)))
        total = vector_sum(total, scaled(body.mass, cross(arm, speed)))
    return total


def _of_joint(joint: Joint, coordinate: Ball, rate: Ball) -> Ball:
    """The energy of a joint."""
    stretch = coordinate - ball(joint.rest)
    energy = (ball(joint.armature) * squared(rate) + ball(joint.stiffness) * squared(stretch)) / 2
    energy -= ball(joint.effort) * (coordinate - ball(Fraction(joint.start[0])))
    if joint.stops is None or not joint.stops.stiffness:
        return energy
    beyond = arb(0)
    if joint.stops.lower is not None:
        beyond = beyond.max(ball(joint.stops.lower) - coordinate)
    if joint.stops.upper is not None:
        beyond = beyond.max(coordinate - ball(joint.stops.upper))
    return energy + ball(joint.stops.stiffness) * squared(beyond) / 2
