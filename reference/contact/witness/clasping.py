"""The second reading of a body between two fingers, with a hundred digits, in the axes of the world."""

from dataclasses import dataclass

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.independent.arithmetic import (
    Matrix,
    Real,
    Vector,
    WideArray,
    applied,
    cross,
    dot,
    minus,
    norm,
    plus,
    product,
    scaled,
)
from bodycheck.reference.independent.border import MP, attitude, made_of
from bodycheck.reference.independent.directions import exact_quaternion
from bodycheck.reference.mechanisms.control import Signal
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism, shape_of
from bodycheck.reference.scene import Brick, Sphere, Tensor

#: The size of a length, relative to others, that is the rounding of the decimals of a file.
DECIMALS = MP.mpf(10) ** -12


@dataclass(frozen=True, eq=False)
class Clasp:
    """A body between two fingers, which move along one line together.

    Attributes
    ----------
    body
        The index of the body.
    normal, along
        The unit vectors of the line along which a finger presses, towards the body, and of the line of the motion.
    mass, moment, light
        The mass of the body (kg), its moment of inertia about n (kg m^2), and the inverse mass (1/kg) of carriage and
        fingers, 0 on the world.
    gravity
        The acceleration of gravity along the line (m/s^2).
    press, sign
        The effort (N) of the joint of a finger, and the sign with which it presses.
    effort
        The efforts (N) on the carriage.
    friction, torsional, one
        The coefficients, the second in m, and whether they share one limit.
    lever, rise
        The distances (m) of the centre of mass from the line of the contacts, across and along the line of the motion.
    reach
        The ways (m) along the line, against and with it, until the body slips out of a finger.
    speed, carried
        The speeds (m/s) of body and carriage at the start.
    centres, attitudes
        The centres of mass (m) of all bodies, and their attitudes as quaternions (4,).
    """

    body: int
    normal: Vector
    along: Vector
    mass: Real
    moment: Real
    light: Real
    gravity: Real
    press: Signal
    sign: Real
    effort: tuple[Signal, ...]
    friction: Real
    torsional: Real
    one: bool
    lever: Real
    rise: Real
    reach: tuple[Real, Real]
    speed: Real
    carried: Real
    centres: tuple[Vector, ...]
    attitudes: tuple[WideArray, ...]

    @property
    def turning(self) -> bool:
        """Return whether a body that is not held turns."""
        return bool(self.lever and self.friction) and (self.one or self.torsional < self.friction * abs(self.lever))

    @property
    def bearing(self) -> Real:
        """The force (N) that holds the body at most, for a force of 1 N of each finger."""
        if not self.lever or not self.friction:
            return 2 * self.friction
        if not self.torsional:
            return MP.mpf(0)
        parts = 1 / self.friction, abs(self.lever) / self.torsional
        return 2 / (MP.hypot(*parts) if self.one else max(parts))


def clasp_of(scene: Mechanism) -> Clasp:
    """Return the clasp of a scene of a free body, two fingers and at most one carriage."""
    free = [index for index, body in enumerate(scene.bodies) if body.start is not None]
    if len(free) != 1 or len(scene.contacts) != 2:
        raise NotModelled("other bodies than one between two fingers")
    (index,) = free
    body = scene.bodies[index]
    assert body.start is not None  # it is free
    fingers = [next(each for each in pair.bodies if each != index) for pair in scene.contacts]
    frames = _frames(scene)
    centres: list[Vector] = [
        plus(frames[each][1], applied(frames[each][0], _centre(scene, each))) for each in range(len(scene.bodies))
    ]
    centres[index] = [MP.mpf(each) for each in body.start.position]
    velocity = [MP.mpf(each) for each in body.start.velocity]
    weight: Vector = (MP.mpf(0), MP.mpf(0), -MP.mpf(scene.gravity))
    joints = {joint.child: number for number, joint in enumerate(scene.joints)}
    first = scene.joints[joints[fingers[0]]]
    pressing = _direction(frames, first.child, first.axis)
    light, carried = MP.mpf(0), MP.mpf(0)
    effort: tuple[Signal, ...] = (MP.mpf(0),)
    if first.parent != WORLD:
        rail = scene.joints[joints[first.parent]]
        along = _direction(frames, rail.child, rail.axis)
        light = 1 / sum(made_of(scene.bodies[each].inertia)[0] for each in (*fingers, first.parent))
        effort, carried = _signals(scene, joints[first.parent]), MP.mpf(rail.start_velocity[0])
    else:
        choices = (weight, velocity, cross(pressing, centres[index]), cross(pressing, (MP.mpf(1), MP.mpf(2), MP.mpf(3))))
        along = next(each for each in choices if norm(each) > 0)
    along = scaled(along, 1 / norm(along))
    mass, tensor = made_of(body.inertia)
    sign = MP.sign(dot(pressing, minus(centres[index], centres[fingers[0]])))
    press = _signals(scene, joints[fingers[0]])
    if len(press) > 1:
        raise NotModelled("a finger with two efforts")
    away = _away(scene, centres, (index, fingers[0]), pressing)
    normal = scaled(pressing, sign)
    lever, rise = dot(away, cross(normal, along)), dot(away, along)
    across_body = [dot([row[column] for row in frames[index][0]], normal) for column in range(3)]
    size = norm(minus(centres[index], centres[fingers[0]]))
    law = scene.contacts[0]
    return Clasp(
        index,
        *(
            normal,
            along,
            mass,
            dot(across_body, applied(tensor, across_body)),
            light,
            dot(weight, along),
            press[0],
            sign,
            effort,
        ),
        *(MP.mpf(law.friction), MP.mpf(law.torsional_friction), law.cone == "one" and law.torsional_friction > 0),
        *(lever if abs(lever) > DECIMALS * size else MP.mpf(0), rise),
        _reach(scene, frames, centres, (index, fingers[0]), normal, along),
        *(dot(velocity, along), carried, tuple(centres)),
        tuple(exact_quaternion([list(row) for row in frames[each][0]]) for each in range(len(scene.bodies))),
    )


def _away(scene: Mechanism, centres: list[Vector], pair: tuple[int, int], pressing: Vector) -> Vector:
    """The way (m) from the contact with a finger to the centre of the body, across the direction of pressing.

    A finger with faces presses beside the centre. pair: the body and the finger.
    """
    body, finger = pair
    if not isinstance(shape_of(scene.bodies[finger]), Sphere):
        return [MP.mpf(0)] * 3
    away = minus(centres[body], centres[finger])
    return minus(away, scaled(pressing, dot(away, pressing)))


def _reach(
    scene: Mechanism,
    frames: dict[int, tuple[Matrix, Vector]],
    centres: list[Vector],
    pair: tuple[int, int],
    normal: Vector,
    along: Vector,
) -> tuple[Real, Real]:
    """The ways (m) until a point on the edge of a rectangle passes another body, against the line of the motion and with it.

    A finger and the body touch while a rectangle contains a point, or two rectangles overlap. pair: the body and a finger.
    """
    body, finger = pair
    shapes = [shape_of(scene.bodies[each]) for each in pair]
    apart = minus(centres[finger], centres[body])
    apart = minus(apart, scaled(normal, dot(apart, normal)))
    ways = [MP.inf, MP.inf]
    bricks = [each for each, shape in zip(pair, shapes, strict=True) if isinstance(shape, Brick)]
    if not bricks:
        return MP.mpf(0), MP.mpf(0)
    for column in range(3):
        axis = [row[column] for row in frames[bricks[0]][0]]
        if abs(dot(axis, normal)) > MP.mpf(1) / 2 or abs(dot(axis, along)) < DECIMALS:
            continue
        half = sum((_half_along(scene, frames, brick, axis) for brick in bricks), MP.mpf(0))
        there, rate = dot(apart, axis), dot(axis, along)
        for number, side in enumerate((-1, 1)):
            # the body moves by s along the line, and the finger from it by -s
            toward = side if rate > 0 else -side
            ways[number] = min(ways[number], (half + toward * there) / abs(rate))
    return ways[0], ways[1]


def _half_along(scene: Mechanism, frames: dict[int, tuple[Matrix, Vector]], brick: int, axis: Vector) -> Real:
    """Half the length (m) of a brick along one of its axes."""
    shape = shape_of(scene.bodies[brick])
    assert isinstance(shape, Brick)
    cosines = [abs(dot([row[column] for row in frames[brick][0]], axis)) for column in range(3)]
    return MP.mpf(shape.semi_axes[cosines.index(max(cosines))])


def _centre(scene: Mechanism, index: int) -> Vector:
    inertia = scene.bodies[index].inertia
    if not isinstance(inertia, Tensor) and not hasattr(inertia, "position"):
        raise NotModelled("a finger made of several parts")
    centre = scene.bodies[index].center_of_mass if isinstance(inertia, Tensor) else inertia.position
    return [MP.mpf(each) for each in centre]


def _frames(scene: Mechanism) -> dict[int, tuple[Matrix, Vector]]:
    """The matrices of cosines and the origins (m) of the frames of all bodies; of a free one, of its centre of mass."""
    level = [[MP.mpf(row == column) for column in range(3)] for row in range(3)]
    frames: dict[int, tuple[Matrix, Vector]] = {WORLD: (level, [MP.mpf(0)] * 3)}
    for index, body in enumerate(scene.bodies):
        if body.start is not None:
            frames[index] = attitude(body.start.attitude), [MP.mpf(each) for each in body.start.position]
    while len(frames) <= len(scene.bodies):
        for joint in scene.joints:
            if joint.parent in frames and joint.child not in frames:
                rows, origin = frames[joint.parent]
                turned = product(rows, attitude(joint.attitude))
                axis = [MP.mpf(each) for each in joint.axis]
                slid = scaled(axis, MP.mpf(joint.start[0]) / norm(axis))
                start = plus(origin, applied(rows, [MP.mpf(each) for each in joint.position]), applied(turned, slid))
                frames[joint.child] = turned, start
    return frames


def _direction(frames: dict[int, tuple[Matrix, Vector]], child: int, axis: tuple[float, float, float]) -> Vector:
    """The unit vector of the axis of a prismatic joint, whose child has the axes of its frame."""
    direction = applied(frames[child][0], [MP.mpf(each) for each in axis])
    return scaled(direction, 1 / norm(direction))


def _signals(scene: Mechanism, joint: int) -> tuple[Signal, ...]:
    """The efforts of a joint and of its controller."""
    driving = [controller.effort for controller in scene.controllers if controller.joint == joint]
    steady = scene.joints[joint].effort
    return (steady, *driving) if steady or not driving else tuple(driving)
