"""Linkages of parallelograms, which move as one pendulum: the N-four-bar of the IFToMM benchmark A02, for instance.

All joints are hinges about parallel axes. If the rate of each joint is a fixed multiple c = -1, 0 or 1 of the rate of an angle
theta, and each body either turns with theta or does not turn, every point moves on a circle at the rate of theta, or rests:

    p(theta) = a + R(theta) b,    T = I theta'^2 / 2,    V = const + A cos theta + B sin theta,

and the loops stay closed if the two ends of each loop have the same b, which is checked with a hundred digits. In positions in
which all bars are in line, the linkage can change to another mode of motion; the closed form is the analytic continuation.
"""

from dataclasses import dataclass

from bodycheck.reference.exact.inertia import Components
from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector3, Wide, vector
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, conjugate, dot, matrix, multiply, plus, turned
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.forms import pendulum
from bodycheck.reference.mechanisms.forms.ground import cross
from bodycheck.reference.mechanisms.forms.motion import WIDE_EPS, Form, FormMotion, JointForm, gathered
from bodycheck.reference.mechanisms.kinematics import from_the_root
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Array

#: The largest difference, in units of the largest length, that counts as rounding of the numbers in the file: loops are closed
#: and axes parallel within this.
_ROUNDED = MP.mpf(10) ** -12


@dataclass(frozen=True, eq=False)
class _Frame:
    """A body's frame at the start: attitude and origin in the world (m), whether it turns with theta, and b of its origin."""

    attitude: Quaternion4
    origin: Vector3
    turns: int
    radius: Vector3


def form_of_parallelograms(mechanism: Mechanism) -> Form | None:
    """The closed form of a linkage of parallelograms; None if the mechanism is not such a linkage, or nothing pulls on it."""
    joints = mechanism.joints
    if not mechanism.loops or None in mechanism.joint_of or any(joint.type not in ("revolute", "fixed") for joint in joints):
        return None
    if any(joint.damping or joint.stiffness or joint.friction or joint.effort for joint in joints):
        return None
    first = next(
        (joint for joint in joints if joint.parent == WORLD and joint.type == "revolute" and joint.start_velocity[0]), None
    )
    rates = _rates(mechanism, first.start_velocity[0]) if first is not None else None
    if first is None or rates is None:
        return None
    axis = turned(matrix(exact.turn(first.attitude)), exact.unit_axis(first))
    frames = _frames(mechanism, rates, axis)
    if frames is None or not _closed(mechanism, frames):
        return None
    system = _pendulum(mechanism, frames, axis, rates, first)
    if system is None:
        return None
    reason = "parallelograms that turn with one angle"
    return Form("pendulum", reason, lambda times: _motion(mechanism, system, rates, times))


def _rates(mechanism: Mechanism, first: float) -> list[int] | None:
    """The rate of each joint as a multiple -1, 0 or 1 of the rate `first` (rad/s), from the initial velocities.

    Returns None if a rate is no such multiple.
    """
    speeds = [joint.start_velocity[0] if joint.type == "revolute" else 0.0 for joint in mechanism.joints]
    multiples = [1 if speed == first else -1 if speed == -first else 0 for speed in speeds]
    return multiples if all(each * first == speed for each, speed in zip(multiples, speeds, strict=True)) else None


def _frames(mechanism: Mechanism, rates: list[int], axis: Vector3) -> dict[int, _Frame] | None:
    """The frames of the bodies at the start; None if an axis is not parallel or a body turns at another rate than 0 or theta's.

    axis: of theta, in the world.
    """
    multiples = {id(joint): rate for joint, rate in zip(mechanism.joints, rates, strict=True)}
    frames = {WORLD: _Frame(IDENTITY, ORIGIN, 0, ORIGIN)}
    for joint in from_the_root(mechanism):
        parent, multiple = frames[joint.parent], multiples[id(joint)]
        attitude = multiply(parent.attitude, exact.turn(joint.attitude))
        arm = turned(matrix(parent.attitude), vector(joint.position))
        if joint.type == "revolute":
            direction = turned(matrix(attitude), exact.unit_axis(joint))
            across = cross(axis, direction)
            if dot(across, across) > _ROUNDED**2:
                return None
            # The axis of a joint may point against the axis of theta.
            multiple *= 1 if dot(axis, direction) > 0 else -1
            cosine, sine = MP.cos_sin(MP.mpf(joint.start[0]) / 2)
            x, y, z = exact.unit_axis(joint)
            attitude = multiply(attitude, (cosine, sine * x, sine * y, sine * z))
        turns = parent.turns + multiple
        if turns not in (0, 1):
            return None
        radius = plus(parent.radius, arm) if parent.turns else parent.radius
        frames[joint.child] = _Frame(attitude, plus(parent.origin, arm), turns, radius)
    return frames


def _point(frame: _Frame, point: Vector3) -> tuple[Vector3, Vector3]:
    """The position in the world (m) of a point of a body at the start, and its vector b (m)."""
    arm = turned(matrix(frame.attitude), point)
    return plus(frame.origin, arm), plus(frame.radius, arm) if frame.turns else frame.radius


def _closed(mechanism: Mechanism, frames: dict[int, _Frame]) -> bool:
    """Return whether the loops stay closed: both ends of each are at the same position and have the same b."""
    for loop in mechanism.loops:
        ends = [_point(frames[body], vector(point)) for body, point in zip(loop.bodies, loop.points, strict=True)]
        size = max(abs(value) for position, _ in ends for value in position)
        for one, other in zip(*ends, strict=True):
            if max(abs(a - b) for a, b in zip(one, other, strict=True)) > _ROUNDED * size:
                return False
    return True


def _pendulum(
    mechanism: Mechanism, frames: dict[int, _Frame], axis: Vector3, rates: list[int], first: Joint
) -> pendulum.Pendulum | None:
    """The pendulum whose angle is theta, which is 0 at the start; None if gravity has no torque, or there is no inertia."""
    inertia = sum(MP.mpf(joint.armature) * rate**2 for joint, rate in zip(mechanism.joints, rates, strict=True))
    level, slope = MP.mpf(0), MP.mpf(0)
    for body, jointed_body in enumerate(mechanism.bodies):
        properties, frame = exact.inertia(jointed_body), frames[body]
        _, radius = _point(frame, properties.centre)
        arm = cross(axis, radius)
        inertia += properties.mass * dot(arm, arm)
        if frame.turns:
            inertia += _moment(properties.tensor, turned(matrix(conjugate(frame.attitude)), axis))
        # Apart from a constant, the height of R(theta) b is (z . b') cos theta + (z . axis x b) sin theta, where b' is the part
        # of b perpendicular to the axis.
        level += properties.mass * (radius[2] - dot(axis, radius) * axis[2])
        slope += properties.mass * arm[2]
    weight = MP.mpf(mechanism.gravity) * MP.hypot(level, slope)
    if not weight or not inertia:
        return None
    # The height is least opposite to its largest value, which is at atan2(slope, level).
    return pendulum.Pendulum(weight / inertia, MP.atan2(-slope, -level), MP.mpf(0), MP.mpf(first.start_velocity[0]))


def _moment(tensor: Components, axis: Vector3) -> Real:
    """The moment of inertia about a unit axis through the centre of mass (kg m^2)."""
    x, y, z = axis
    xx, yy, zz, xy, xz, yz = tensor
    return xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z)


def _motion(mechanism: Mechanism, system: pendulum.Pendulum, rates: list[int], times: Array) -> FormMotion:
    """The coordinates of all joints, which begin at their initial values and turn at their multiples of theta's rate."""
    turning = pendulum.follow(system, times)
    parts = {
        index: JointForm(
            Wide(joint.start[0]) + rate * turning.position,
            rate * turning.velocity,
            # Errors of the angles add up along a chain.
            len(rates) * (turning.error + WIDE_EPS * abs(joint.start[0])),
            turning.velocity_error * abs(rate),
        )
        for index, (joint, rate) in enumerate(zip(mechanism.joints, rates, strict=True))
        if joint.type == "revolute"
    }
    return gathered(mechanism, parts, len(times))
