"""A body on a ball joint on the world: Lagrange's top, or any body without a torque about the fixed point."""

from collections.abc import Callable

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.exact.axes import principal_axes
from bodycheck.reference.exact.inertia import Components
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Quaternion4, Vector3, Wide, doubles, vector, wide
from bodycheck.reference.exact.rotations import conjugate, dot, matrix, multiply, turned, unit
from bodycheck.reference.exact.start import Start
from bodycheck.reference.flight import torque_free
from bodycheck.reference.flight.closed_form import ERROR_PER_RADIAN, ROUNDINGS, STORED_ERROR_RAD
from bodycheck.reference.kinematics import multiply as product
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.exact import turn
from bodycheck.reference.mechanisms.forms import top
from bodycheck.reference.mechanisms.forms.ground import Carried
from bodycheck.reference.mechanisms.forms.motion import JointForm
from bodycheck.reference.trajectory import Array

#: The name of a form, why it is exact, and the motion at times (n,), s.
Found = tuple[str, str, Callable[[Array], JointForm]]


def form_of_ball(held: Carried) -> Found | None:
    """The closed form of the motion of the body that a ball joint carries; None if there is none."""
    if held.joint.damping:
        return None
    about = about_origin(held)
    if any(held.gravity) and any(held.centre):
        lagrange = _top(held, about)
        if lagrange is None:
            return None
        spinner, axis = lagrange
        return "Lagrange top", "a symmetric body on a ball joint", lambda times: _turning(held, spinner, axis, times)
    moments, axes = principal_axes(about)
    if min(moments) <= NEGLIGIBLE * max(moments):
        return None
    return "free rotation", "gravity has no torque about the ball joint", lambda times: _free(held, moments, axes, times)


def about_origin(held: Carried) -> Components:
    """The inertia tensor of the carried body about the joint's origin, along the child's axes (kg m^2)."""
    x, y, z = held.centre
    m, (xx, yy, zz, xy, xz, yz) = held.mass, held.tensor
    squares = (xx + m * (y * y + z * z), yy + m * (x * x + z * z), zz + m * (x * x + y * y))
    return (*squares, xy - m * x * y, xz - m * x * z, yz - m * y * z)


def _top(held: Carried, about: Components) -> tuple[top.Top, Quaternion4] | None:
    """The top, and the unit quaternion from its frame to the child's frame.

    Returns None if the body is not symmetric about the line from the fixed point to its centre of mass, or has no moment of
    inertia about it.
    """
    arm = MP.sqrt(dot(held.centre, held.centre))
    x, y, z = (part / arm for part in held.centre)
    xx, yy, zz, xy, xz, yz = about
    along = xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z)
    across = (xx + yy + zz - along) / 2
    more = along - across
    symmetric = (
        *(across + more * x * x - xx, across + more * y * y - yy, across + more * z * z - zz),
        *(more * x * y - xy, more * x * z - xz, more * y * z - yz),
    )
    if max(abs(rest) for rest in symmetric) > NEGLIGIBLE * across or along <= NEGLIGIBLE * across:
        return None
    zero = MP.mpf(0)
    # The shortest rotation from z to the axis of symmetry.
    axis: Quaternion4 = (zero, MP.mpf(1), zero, zero) if z == -1 else unit((1 + z, -y, x, zero))
    if not (x or y) and z > 0:
        axis = (MP.mpf(1), zero, zero, zero)
    rates = turned(matrix(conjugate(axis)), vector(held.joint.start_velocity))
    attitude = multiply(multiply(held.attitude, _start(held)), axis)
    weight = held.mass * MP.sqrt(dot(held.gravity, held.gravity)) * arm
    return top.Top(across, along, weight, attitude, rates), axis


def _start(held: Carried) -> Quaternion4:
    w, x, y, z = held.joint.start
    return turn((w, x, y, z))


def _turning(held: Carried, spinner: top.Top, axis: Quaternion4, times: Array) -> JointForm:
    """The coordinates of the joint from the motion of the top."""
    motion = top.follow(spinner, times)
    before, after = _row(conjugate(held.attitude)), _row(conjugate(axis))
    count = len(times)
    attitude = product(np.tile(before, (count, 1)), product(motion.attitude, np.tile(after, (count, 1))))
    rows = np.array([[wide(part) for part in row] for row in matrix(axis)], dtype=Wide)
    rates = np.stack([(motion.rates * row).sum(axis=1) for row in rows], axis=1)
    return JointForm(attitude, rates, motion.error, motion.rates_error)


def _row(q: Quaternion4) -> np.ndarray:
    return np.array([wide(part) for part in q], dtype=Wide)


def _free(held: Carried, moments: Vector3, axes: Quaternion4, times: Array) -> JointForm:
    """The rotation without torque, in doubles, by the same functions as for a body in free flight."""
    rates = turned(matrix(conjugate(axes)), vector(held.joint.start_velocity))
    begin = Start(moments, axes, multiply(_start(held), axes), rates)
    if not any(rates):
        attitude = np.tile(_row(_start(held)), (len(times), 1))
        error = np.full(len(times), EPS)
        return JointForm(attitude, np.zeros((len(times), 3), dtype=Wide), error, np.zeros(len(times)))
    turning = torque_free.rotation(begin, times)
    back, around = (np.tile(doubles(q), (len(times), 1)) for q in (conjugate(axes), axes))
    angles = turning.first_angle + turning.angle_rate * np.abs(times)
    error = 1.5 * STORED_ERROR_RAD + ERROR_PER_RADIAN * angles
    speed = float(np.sqrt((turning.amplitude**2).sum()))
    return JointForm(
        product(turning.attitude, back).astype(Wide),
        rotate(around, turning.angular_velocity).astype(Wide),
        error,
        speed * error + ROUNDINGS * speed,
    )
