"""A body between two fingers, with a hundred digits, along the axes of the world.

The first finger presses along a unit vector n, the second against it, with equal forces N at all times. Friction acts in the
directions across n. Loads and motions are along a line d across n: the axis of the carriage, the vertical, or the direction in
which the body moves at the start. The contacts of both fingers are beside each other, at the same distance from the centre of
mass along n, so that each bears one half.

A finger that is a sphere touches a brick at one point, and so does a brick a sphere. Where two bricks touch at faces,
mechanics does not determine how the force is distributed; with everything symmetrical about the line d through the centre of
mass, it does not matter.
"""

from dataclasses import dataclass

from bodycheck.reference.contact.gripping.waves import Pieces, added, constant, pieces_of
from bodycheck.reference.contact.problem import NONE
from bodycheck.reference.contact.spheres.ball import size
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Real, Vector3, vector
from bodycheck.reference.exact.rotations import cross, dot, matrix, minus, scaled
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.frames import Place
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism, PairContact, shape_of
from bodycheck.reference.scene import Brick, Sphere

#: A unit vector that no direction is compared with by itself.
OBLIQUE: Vector3 = (MP.mpf("0.36"), MP.mpf("0.48"), MP.mpf("0.8"))


@dataclass(frozen=True, eq=False)
class Solid:
    """A body at the start: its centre of mass (m), the unit vectors of its axes, world frame, and its shape."""

    centre: Vector3
    axes: tuple[Vector3, Vector3, Vector3]
    shape: Sphere | Brick

    def half_length(self, direction: Vector3) -> tuple[Real, Real]:
        """Return half its length (m) along a direction, and how much the direction misses an axis of a brick (rad)."""
        if isinstance(self.shape, Sphere):
            return MP.mpf(self.shape.radius), MP.zero
        along = [abs(dot(axis, direction)) for axis in self.axes]
        index = along.index(max(along))
        return MP.mpf(self.shape.semi_axes[index]), MP.sqrt(max(MP.zero, 1 - along[index] ** 2))

    def faces(self, normal: Vector3) -> list[tuple[Vector3, Real]]:
        """Return the two axes of a brick across a normal, each with its half-length (m); none of a sphere."""
        if isinstance(self.shape, Sphere):
            return []
        pairs = [(axis, MP.mpf(length)) for axis, length in zip(self.axes, self.shape.semi_axes, strict=True)]
        return sorted(pairs, key=lambda pair: abs(dot(pair[0], normal)))[:2]


@dataclass(frozen=True, eq=False)
class Grip:
    """A body between two fingers.

    Attributes
    ----------
    body
        The index of the body.
    carriage
        The index of the joint of the carriage; None if the fingers are on the world.
    normal, along, across
        The unit vectors n, d and n x d.
    mass, borne
        The masses (kg) of the body and of the carriage with its fingers; the second is infinite without a carriage.
    moment
        The moment of inertia of the body about n (kg m^2).
    gravity
        The acceleration of gravity along d (m/s^2).
    press, effort
        The force N of each finger, and the force along d on the carriage, without weights (N).
    friction, torsional, one
        The coefficients of the contacts, the second in m, and whether they share one limit.
    arm
        The components (m), along d and across it, of the contacts from the centre of mass.
    speed, carried
        The speeds (m/s) at the start along d of the body and of the carriage.
    reach
        The displacements (m) of the body along d from the fingers between which the contacts stay as they are.
    missed
        By how much the numbers of the file miss the contacts and directions, relative to sizes and speeds.
    length
        Half the length (m) of the body along n.
    centres
        The centres of mass (m) of all bodies at the start, world frame.
    """

    body: int
    carriage: int | None
    normal: Vector3
    along: Vector3
    across: Vector3
    mass: Real
    borne: Real
    moment: Real
    gravity: Real
    press: Pieces
    effort: Pieces
    friction: Real
    torsional: Real
    one: bool
    arm: tuple[Real, Real]
    speed: Real
    carried: Real
    reach: tuple[Real, Real]
    missed: Real
    length: Real
    centres: tuple[Vector3, ...]

    @property
    def centred(self) -> bool:
        """Return whether the load has no moment about the contacts."""
        return bool(abs(self.arm[1]) <= NONE * (abs(self.arm[0]) + self.length))

    @property
    def bearing(self) -> Real:
        """The load (N) along d that the contacts of both fingers bear at most, for a force of 1 N of each."""
        if self.centred:
            return 2 * self.friction
        if not (self.friction and self.torsional):
            return MP.zero
        lever = abs(self.arm[1])
        if self.one:
            return 2 / MP.sqrt(1 / self.friction**2 + (lever / self.torsional) ** 2)
        return 2 * min(self.friction, self.torsional / lever)

    @property
    def turns(self) -> bool:
        """Return whether a body that is no longer held turns."""
        if self.centred or not self.friction:
            return False
        return self.one or self.torsional < self.friction * abs(self.arm[1])


class _Misses:
    """The sizes of differences that the decimals of a file leave of zero."""

    def __init__(self) -> None:
        self.largest = MP.zero

    def zero(self, value: Real, reason: str) -> None:
        """Raise `NotModelled` for a number, relative to its size, that decimals do not explain."""
        if not abs(value) <= NONE:
            raise NotModelled(reason)
        self.largest = max(self.largest, abs(value))


def grip_of(scene: Mechanism) -> Grip:
    """Return the grip of a scene in which bodies on joints touch others.

    Raises `NotModelled` for any other number of bodies, and for fingers that do not press the body from the start on, from two
    sides, with equal forces.
    """
    (body,), fingers, carriage = _roles(scene)
    law, misses = _law(scene), _Misses()
    places = _places(scene, fingers, carriage)
    held, one, other = (_solid(scene, index, places[index]) for index in (body, *(finger.child for finger in fingers)))
    axes = [_axis(places[finger.child], finger) for finger in fingers]
    normal = _normal(minus(other.centre, one.centre), axes, misses)
    start = scene.bodies[body].start
    assert start is not None  # it is free
    weight: Vector3 = (MP.zero, MP.zero, -MP.mpf(scene.gravity))
    velocity = vector(start.velocity)
    along = _line(weight, velocity, normal, None if carriage is None else _axis(places[carriage.child], carriage), misses)
    if any(exact.rates(start.attitude, start.rotation)):
        raise NotModelled("a gripped body that turns at the start")
    points = [_contact(finger, held, normal, sign, misses) for finger, sign in ((one, 1), (other, -1))]
    apart, length = minus(points[1], points[0]), held.half_length(normal)[0]
    misses.zero(size(minus(apart, scaled(dot(apart, normal), normal))) / length, "fingers that press at places apart")
    frame, from_centre = (normal, along, cross(normal, along)), minus(points[0], held.centre)
    arm = dot(from_centre, along), dot(from_centre, frame[2])
    inertia = exact.inertia(scene.bodies[body])
    moving = () if carriage is None else (*fingers, carriage)
    borne = sum((exact.inertia(scene.bodies[each.child]).mass for each in moving), MP.zero) if moving else MP.inf
    lows, highs = zip(*(_reach(finger, held, points[0], frame) for finger in (one, other)), strict=True)
    return Grip(
        body,
        None if carriage is None else scene.joints.index(carriage),
        *frame,
        *(inertia.mass, borne, _moment(inertia.tensor, held.axes, normal, misses if arm[1] else None)),
        dot(weight, along),
        _press(scene, fingers, axes, normal),
        _effort(scene, carriage),
        *(MP.mpf(law.friction), MP.mpf(law.torsional_friction), law.cone == "one" and law.torsional_friction > 0),
        arm,
        *(dot(velocity, along), MP.zero if carriage is None else MP.mpf(carriage.start_velocity[0])),
        (max(lows), min(highs)),
        *(misses.largest, length),
        tuple(places[index].point(exact.inertia(each).centre) for index, each in enumerate(scene.bodies)),
    )


def _normal(between: Vector3, axes: list[Vector3], misses: _Misses) -> Vector3:
    """Return the direction in which the first finger presses. between: the way (m) from it to the second."""
    if not size(between):
        raise NotModelled("two fingers at the same place")
    normal = scaled(MP.sign(dot(axes[0], between)) or MP.one, axes[0])
    misses.zero(size(cross(axes[1], normal)), "fingers that move along different lines")
    return normal


def _line(weight: Vector3, velocity: Vector3, normal: Vector3, rail: Vector3 | None, misses: _Misses) -> Vector3:
    """Return the direction of loads and motions. rail: that of the carriage; None without one."""
    down = _unit(weight)
    if down is not None:
        misses.zero(dot(down, normal), "fingers that move along a line that is not horizontal")
    along = rail or down or _unit(velocity) or _unit(cross(normal, OBLIQUE)) or normal
    if down is not None:
        misses.zero(size(cross(down, along)), "a carriage of fingers that moves across gravity")
    misses.zero(dot(along, normal), "fingers that press along the line on which their carriage or the body moves")
    aside = minus(velocity, scaled(dot(velocity, along), along))
    misses.zero(size(aside) / (size(velocity) or MP.one), "a gripped body that moves aside")
    return along


def _roles(scene: Mechanism) -> tuple[tuple[int, ...], tuple[Joint, Joint], Joint | None]:
    """Return the indices of the free bodies, the joints of the fingers, and the joint of the carriage, if there is one."""
    free = tuple(index for index, joint in enumerate(scene.joint_of) if joint is None)
    touched = {index for pair in scene.contacts for index in pair.bodies} - set(free)
    fingers = [joint for joint in scene.joints if joint.child in touched]
    others = [joint for joint in scene.joints if joint.child not in touched]
    if len(free) != 1 or len(fingers) != 2 or len(scene.contacts) != 2 or scene.plane is not None:
        raise NotModelled("bodies on joints that touch others, except two fingers that grip one free body")
    one, other = fingers
    parents = {one.parent, other.parent}
    if len(others) > 1 or parents != {joint.child for joint in others} | ({WORLD} if not others else set()):
        raise NotModelled("fingers on other bodies than the world or one carriage")
    carriage = others[0] if others else None
    if carriage is not None and (carriage.parent != WORLD or carriage.type != "prismatic"):
        raise NotModelled("a carriage of fingers that is not on a prismatic joint of the world")
    for joint in scene.joints:
        if any((joint.armature, joint.damping, joint.stiffness, joint.friction, joint.mimic, joint.stops)):
            raise NotModelled("fingers on joints with other forces than efforts")
    if any(finger.start_velocity[0] for finger in fingers):
        raise NotModelled("fingers that move at the start")
    if scene.loops or scene.pushes:
        raise NotModelled("a gripped body with pushes, or fingers in a closed loop")
    for controller in scene.controllers:
        if controller.law != "effort" or controller.rate is not None or controller.effort_limit is not None:
            raise NotModelled("fingers with other controllers than efforts without a rate and a limit")
    return free, (one, other), carriage


def _law(scene: Mechanism) -> PairContact:
    """Return the law of both contacts. Raises `NotModelled` if they differ."""
    one, other = scene.contacts
    laws = [(pair.friction, pair.rolling_friction, pair.torsional_friction, pair.cone) for pair in (one, other)]
    if laws[0] != laws[1]:
        raise NotModelled("fingers with different friction")
    if one.rolling_friction:
        raise NotModelled("rolling friction of fingers")
    if MP.isinf(MP.mpf(one.friction)):
        raise NotModelled("fingers on which nothing slips")
    return one


def _places(scene: Mechanism, fingers: tuple[Joint, Joint], carriage: Joint | None) -> dict[int, Place]:
    """Return the frames at the start of the bodies on joints."""
    places = {WORLD: Place()}
    for joint in (*(() if carriage is None else (carriage,)), *fingers):
        frame = places[joint.parent].then(Place(exact.turn(joint.attitude), vector(joint.position)))
        moved = scaled(MP.mpf(joint.start[0]), exact.unit_axis(joint))
        places[joint.child] = frame.then(Place(origin=moved))
    body = next(index for index, joint in enumerate(scene.joint_of) if joint is None)
    start, centre = scene.bodies[body].start, exact.inertia(scene.bodies[body]).centre
    assert start is not None  # it is free
    turn = Place(exact.turn(start.attitude))
    places[body] = Place(turn.turn, minus(vector(start.position), turn.point(centre)))
    return places


def _solid(scene: Mechanism, index: int, pose: Place) -> Solid:
    body = scene.bodies[index]
    shape = shape_of(body)
    if not isinstance(shape, Sphere | Brick):
        raise NotModelled("fingers and gripped bodies of other shapes than spheres and bricks")
    x, y, z = zip(*matrix(pose.turn), strict=True)
    return Solid(pose.point(exact.inertia(body).centre), (x, y, z), shape)


def _axis(pose: Place, joint: Joint) -> Vector3:
    """Return the unit axis of a prismatic joint, whose child has a pose, world frame."""
    return minus(pose.point(exact.unit_axis(joint)), pose.origin)


def _unit(v: Vector3) -> Vector3 | None:
    length = size(v)
    return scaled(1 / length, v) if length else None


def _contact(finger: Solid, held: Solid, normal: Vector3, sign: int, misses: _Misses) -> Vector3:
    """Return the point at which a finger touches the body; where faces touch, the point beside its centre of mass.

    sign: 1 for the finger that presses along the normal, -1 for the other.
    """
    halves = [solid.half_length(normal) for solid in (finger, held)]
    for _, miss in halves:
        misses.zero(miss, "fingers that do not press on faces of bricks")
    length = sum((half for half, _ in halves), MP.zero)
    apart = minus(held.centre, finger.centre)
    misses.zero(sign * dot(apart, normal) / length - 1, "fingers that do not touch the body at the start")
    aside = minus(apart, scaled(dot(apart, normal), normal))
    point = held.centre
    if isinstance(finger.shape, Sphere) and isinstance(held.shape, Sphere):
        misses.zero(size(aside) / length, "spheres that grip a sphere from places that are not opposite")
    elif isinstance(finger.shape, Sphere):
        point = minus(held.centre, aside)
    return minus(point, scaled(sign * halves[1][0], normal))


def _reach(finger: Solid, held: Solid, point: Vector3, frame: tuple[Vector3, Vector3, Vector3]) -> tuple[Real, Real]:
    """Return the displacements (m) of the body along d from a finger between which the contact stays as it is.

    point: the place of the contact. frame: the unit vectors n, d and n x d.
    """
    normal, along, across = frame
    if isinstance(finger.shape, Sphere) and isinstance(held.shape, Sphere):
        return MP.zero, MP.zero
    if isinstance(finger.shape, Brick) and isinstance(held.shape, Brick):
        apart = minus(held.centre, finger.centre)
        lengths = [half for solid in (finger, held) for axis, half in solid.faces(normal) if abs(dot(axis, along)) > 1 - NONE]
        if len(lengths) != 2 or abs(dot(apart, across)) > NONE * sum(lengths):
            raise NotModelled("faces that touch and are not symmetrical about the line of the load through the centre of mass")
        there = dot(apart, along)
        return -sum(lengths) - there, sum(lengths) - there
    solid, sign = (held, MP.mpf(-1)) if isinstance(finger.shape, Sphere) else (finger, MP.one)
    low, high = -MP.inf, MP.inf
    for axis, half in solid.faces(normal):
        there, rate = dot(minus(point, solid.centre), axis), sign * dot(axis, along)
        if abs(there) > half:
            raise NotModelled("fingers that press beside a face")
        if abs(rate) > NONE:
            ends = sorted(((-half - there) / rate, (half - there) / rate))
            low, high = max(low, ends[0]), min(high, ends[1])
    return low, high


def _moment(tensor: tuple[Real, ...], axes: tuple[Vector3, Vector3, Vector3], normal: Vector3, misses: _Misses | None) -> Real:
    """Return the moment of inertia (kg m^2) of a body about a normal, world frame.

    misses: for a body that may turn about the normal, which then must be a principal axis.
    """
    x, y, z = (dot(axis, normal) for axis in axes)
    xx, yy, zz, xy, xz, yz = tensor
    rows = xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z
    moment = dot(rows, (x, y, z))
    if misses is not None:
        aside = minus(rows, scaled(moment, (x, y, z)))
        misses.zero(size(aside) / (moment or MP.one), "a body between fingers that products of inertia would tilt")
    return moment


def _force(scene: Mechanism, joint: Joint) -> Pieces:
    """Return the effort of a joint and its controller along its axis (N)."""
    steady: Pieces = ((MP.zero, constant(MP.mpf(joint.effort))),)
    index = scene.joints.index(joint)
    driving = next((controller for controller in scene.controllers if controller.joint == index), None)
    return steady if driving is None else added(steady, pieces_of(driving.effort), MP.one)


def _press(scene: Mechanism, fingers: tuple[Joint, Joint], axes: list[Vector3], normal: Vector3) -> Pieces:
    """Return the force of each finger (N). Raises `NotModelled` if they differ."""
    signs = [MP.sign(dot(axis, normal)) for axis in axes]
    nothing: Pieces = ((MP.zero, constant(MP.zero)),)
    one, other = (added(nothing, _force(scene, finger), sign) for finger, sign in zip(fingers, signs, strict=True))
    apart = added(one, other, MP.one)  # the second finger presses against the normal
    if any(any(difference.powers) or difference.sines for _, difference in apart):
        raise NotModelled("fingers that press with different forces")
    return one


def _effort(scene: Mechanism, carriage: Joint | None) -> Pieces:
    return ((MP.zero, constant(MP.zero)),) if carriage is None else _force(scene, carriage)
