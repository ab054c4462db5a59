"""The bodies of a scene and their plane with a hundred digits, in the axes of the world."""

from dataclasses import dataclass

from bodycheck.reference.independent.arithmetic import Real, Vector
from bodycheck.reference.independent.border import MP, Matrix, Triple, attitude, border, euler_velocity, made_of
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism, PairContact, shape_of
from bodycheck.reference.scene import EulerRates, Plane, Shape


@dataclass(frozen=True, eq=False)
class FreeBody:
    """A body at t = 0.

    Attributes
    ----------
    mass
        Mass (kg).
    tensor
        Rows of the inertia tensor about the centre of mass, in the frame of the body (kg m^2).
    shape
        The shape about the centre of mass; None if it has none.
    position, velocity
        Position (m) and velocity (m/s) of the centre of mass, world frame.
    cosines
        Rows of the matrix of direction cosines, body to world.
    rates
        Angular velocity in the frame of the body (rad/s).
    """

    mass: Real
    tensor: Matrix
    shape: Shape | None
    position: Vector
    velocity: Vector
    cosines: Matrix
    rates: Vector


@dataclass(frozen=True, eq=False)
class Surface:
    """The plane, with the friction and the restitution of its contact with one body.

    Attributes
    ----------
    normal
        The unit normal, world frame.
    friction, restitution
        Coulomb's coefficient, which may be infinite, and the coefficient of restitution.
    rolling, torsional
        The coefficients of rolling and of torsional friction (m).
    one
        Whether friction and both moments have one limit.
    """

    normal: Vector
    friction: Real
    restitution: Real
    rolling: Real
    torsional: Real
    one: bool


def bodies(scene: AnyScene) -> tuple[FreeBody, ...]:
    """The bodies of a scene without joints."""
    if not isinstance(scene, Mechanism):
        begin, initial = border(scene), scene.initial
        vectors = _numbers(initial.position), _numbers(initial.velocity)
        return (FreeBody(begin.mass, begin.tensor, scene.body.shape, *vectors, begin.cosines, begin.rates),)
    read = []
    for body in scene.bodies:
        start = body.start
        assert start is not None  # a scene with a plane has no joints
        turning = start.rotation
        rates = euler_velocity(start.attitude, turning) if isinstance(turning, EulerRates) else _numbers(turning)
        vectors = _numbers(start.position), _numbers(start.velocity)
        read.append(FreeBody(*made_of(body.inertia), shape_of(body), *vectors, attitude(start.attitude), rates))
    return tuple(read)


def surface(scene: AnyScene, body: int = 0) -> Surface:
    """The plane of a scene, which it must have, and its contact with a body, given by its index."""
    plane = scene.plane
    assert plane is not None  # the caller has checked this
    law: Plane | PairContact = plane
    for contact in scene.contacts if isinstance(scene, Mechanism) else ():
        if set(contact.bodies) == {WORLD, body}:
            law = contact
    cosine, sine = MP.cos_sin(MP.mpf(plane.incline))
    friction, restitution, rolling, torsional = (
        MP.mpf(each) for each in (law.friction, law.restitution, law.rolling_friction, law.torsional_friction)
    )
    return Surface((sine, MP.mpf(0), cosine), friction, restitution, rolling, torsional, law.cone == "one")


def pair_law(scene: AnyScene, pair: tuple[int, int]) -> tuple[Real, Real]:
    """The coefficients of friction and restitution of two bodies, by their indices. The friction may be infinite."""
    stated = [contact for contact in scene.contacts if contact.bodies == pair] if isinstance(scene, Mechanism) else []
    law = stated[0] if stated else scene.plane
    assert law is not None  # a scene without a plane states all pairs that touch
    return MP.mpf(law.friction), MP.mpf(law.restitution)


def _numbers(values: tuple[float, float, float]) -> Triple:
    return [MP.mpf(value) for value in values]
