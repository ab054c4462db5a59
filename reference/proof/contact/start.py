"""The bodies of a scene with a plane at t = 0, along the axes of the plane: x downhill, z along the normal."""

from dataclasses import dataclass
from fractions import Fraction

from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism, shape_of
from bodycheck.reference.proof.balls import Ball, Matrix, Triple, about, applied, ball, product, transposed, triple
from bodycheck.reference.proof.bodies import Entries, Rationals, angular_velocity, attitude, inertia, rotor
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.mass import mass_of
from bodycheck.reference.scene import Ellipsoid, Scene, Shape, Sphere

#: The part of the size of its terms up to which a distance or a velocity at t = 0 counts as zero.
NONE = ball(Fraction(1, 10**12))


@dataclass(frozen=True, eq=False)
class Placed:
    """A body at t = 0.

    Attributes
    ----------
    mass, inertia, shape
        Its mass (kg), the rows of its inertia tensor in its frame (kg m^2), and its shape.
    position, velocity, spin
        Position (m), velocity (m/s) and angular velocity (rad/s) along the axes of the plane.
    attitude
        The matrix from the axes of the body to those of the plane.
    world
        The states as the file gives them: position, attitude, velocity, and angular velocity along the axes of the body.
    """

    mass: Fraction
    inertia: Entries
    shape: Shape | None
    position: Triple
    velocity: Triple
    spin: Triple
    attitude: Matrix
    world: tuple[Triple, Matrix, Triple, Triple]


@dataclass(frozen=True, eq=False)
class Surroundings:
    """A plane: the matrix from its axes to those of the world, and gravity downhill and against its normal (m/s^2)."""

    to_world: Matrix
    incline: Fraction
    gravity: Fraction
    downhill: Ball
    onto: Ball

    @property
    def along(self) -> tuple[Fraction | Ball, Fraction | Ball]:
        """Gravity downhill and against the normal, as rational numbers on a level plane."""
        return (self.downhill, self.onto) if self.incline else (Fraction(0), self.gravity)

    def shown(
        self, position: Triple, turn: Matrix, attitude: Matrix, velocity: Triple, spin: Triple
    ) -> tuple[Triple, Matrix, Triple, Triple]:
        """The states of a body in the world, from those along the axes of the plane, and its rotation since t = 0."""
        turned = product(turn, attitude)
        rates = applied(transposed(turned), spin)
        return applied(self.to_world, position), product(self.to_world, turned), applied(self.to_world, velocity), rates


def surroundings(scene: AnyScene) -> Surroundings:
    """Return the plane of a scene; without one, a level plane that nothing touches."""
    incline = Fraction(0 if scene.plane is None else scene.plane.incline)
    sine, cosine = ball(incline).sin_cos()
    gravity = Fraction(scene.gravity)
    return Surroundings(about(1, sine, cosine), incline, gravity, ball(gravity) * sine, ball(gravity) * cosine)


def placed(scene: AnyScene, plane: Surroundings) -> list[Placed]:
    """Return the bodies of a scene, which all are free."""
    back = transposed(plane.to_world)
    bodies = []
    for mass, rows, shape, position, turn, velocity, rates in _read(scene):
        turned = product(back, turn)
        world = (triple(position), turn, triple(velocity), rates)
        along = (applied(back, world[0]), applied(back, world[2]), applied(turned, rates))
        bodies.append(Placed(mass, rows, shape, *along, turned, world))
    return bodies


#: What a file gives of a body: mass, inertia, shape, position, attitude, velocity, angular velocity.
_Read = tuple[Fraction, Entries, Shape | None, tuple[float, ...], Matrix, tuple[float, ...], Triple]


def _read(scene: AnyScene) -> list[_Read]:
    if isinstance(scene, Scene):
        body, initial = rotor(scene), scene.initial
        rows = body.exact_tensor or body.tensor
        begun = (initial.position, body.attitude, initial.velocity, body.rates)
        return [(Fraction(scene.body.mass), rows, scene.body.shape, *begun)]
    return [_of_mechanism(scene, index) for index in range(len(scene.bodies))]


def _of_mechanism(scene: Mechanism, index: int) -> _Read:
    body = scene.bodies[index]
    assert body.start is not None  # it is free
    start = body.start
    begun = (start.position, attitude(start.attitude), start.velocity, angular_velocity(start.attitude, start.rotation))
    return (mass_of(body), inertia(body.inertia), shape_of(body), *begun)


def diagonal(rows: Entries) -> Rationals:
    """Return the moments of a tensor that is diagonal and rational. Raises `NotEnclosed` for another one."""
    moments = [rows[i][i] for i in range(3)]
    products = [rows[i][j] for i in range(3) for j in range(i)]
    if not all(isinstance(each, Fraction) for each in (*moments, *products)) or any(products):
        raise NotEnclosed("a body that touches and has no rational moments along its axes")
    return moments[0], moments[1], moments[2]


def radius_of(shape: Shape | None) -> float | None:
    """Return the radius of a sphere (m); None for another shape."""
    match shape:
        case Sphere(radius):
            return radius
        case Ellipsoid((radius, b, c)) if radius == b == c:
            return radius
    return None
