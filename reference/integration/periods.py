"""Any number of turns of a body without torque, continued from one period of its angular velocity.

Seen from the body, the angular velocity of a rotation without torque repeats itself after a time T. One period turns the body
as a whole by an angle alpha about the fixed angular momentum: R(t + T) = D R(t). So R(n T + tau) = D^n R(tau), where D^n is
the turn by n alpha.
"""

from typing import Any, Protocol

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration.rotation import Rotation, WideArray
from bodycheck.reference.trajectory import Array

#: Part of the error of a motion that is negligible.
NEGLIGIBLE = 0.1

#: Largest number of corrections of a guess of the period.
MAX_CORRECTIONS = 8

#: Number of instants in a search for the period.
SEARCHED = 4001


class Motion(Protocol):
    """A rotation without torque that can be followed, and its equations."""

    def follow(self, instants: WideArray) -> Rotation:
        """Attitudes and angular velocities at times (n,) >= 0 (s), in any order."""

    def acceleration(self, angular_velocity: WideArray) -> WideArray:
        """The angular accelerations (n, 3), rad/s^2, at angular velocities (n, 3), rad/s, of this motion."""


def periodic(motion: Motion, axis: WideArray, guess: Any, times: Array, allowed: float) -> Rotation:
    """Return a rotation at any times, continued from one period of it.

    Parameters
    ----------
    motion
        The motion.
    axis
        (3,) direction of the angular momentum in the world, as a unit vector.
    guess
        A guess of the period (s); it is corrected until the angular velocity repeats itself. For a steady spin, any time.
    times
        (n,) times >= 0 (s), in any order.
    allowed
        The relative difference that the angular velocity may have after a period: the error of the motion.

    Returns
    -------
    Rotation
        Attitudes and angular velocities at the times, in the type of `axis`.

    Raises
    ------
    OutOfReach
        If the motion cannot be followed, or no period is found near the guess.
    """
    period = _in_type(guess, axis)
    for _ in range(MAX_CORRECTIONS):
        whole = np.floor(times / float(period[0]))
        within = 0 * axis[:1] + times.astype(axis.dtype) - whole.astype(axis.dtype) * period
        # Rounding can put an instant just before the start.
        early = within < 0
        within, whole = np.where(early, within + period, within), np.where(early, whole - 1, whole)
        seen = motion.follow(np.concatenate([within, period, 0 * period]))
        shift, mismatch = return_shift(motion, seen.angular_velocity[-1], seen.angular_velocity[-2], allowed)
        speed = float(np.sqrt((seen.angular_velocity[-1] ** 2).sum()))
        # An instant is shifted by the error of all periods before it. Terms of second order in this error are left out.
        late = whole * abs(float(shift))
        change = (
            motion.acceleration(seen.angular_velocity[:-2]) if speed * late.max(initial=0.0) > NEGLIGIBLE * allowed else None
        )
        second_order = 0.0 if change is None else 0.5 * late**2 * np.linalg.norm(change.astype(float), axis=1)
        period = period + shift
        if mismatch <= allowed * speed and np.all(second_order <= NEGLIGIBLE * allowed * (1 + whole)):
            return _continued(seen, whole.astype(axis.dtype), shift, axis, change)
        if not 0.5 < float(period[0]) / float(guess) < 2:
            break
    raise OutOfReach(f"no period near {float(guess):.6g} s is found")


def return_shift(motion: Motion, first: WideArray, last: WideArray, allowed: float) -> tuple[Any, float]:
    """The time (s) after which an angular velocity `last` (3,) comes closest to `first` (3,), and their distance then (rad/s).

    The time is exact to first order. `allowed` is the relative error of the angular velocities: if they change by no more than
    this error, the time cannot be determined, and is zero.
    """
    difference, change = first - last, motion.acceleration(first[None])[0]
    square, noise = (change * change).sum(), (first * first).sum() * _in_type(allowed, first)[0]
    shift = (difference * change).sum() / (square + noise * noise)
    left = difference - shift * change
    return shift, float(np.sqrt((left * left).sum()))


def searched_period(motion: Motion, end: float, dtype: Any) -> float:
    """The time (s) after which the angular velocity of a motion first returns.

    Raises `OutOfReach` if it does not return before `end` (s).
    """
    instants = np.linspace(0.0, end, SEARCHED)
    rates = motion.follow(instants.astype(dtype)).angular_velocity.astype(float)
    away = np.linalg.norm(rates - rates[0], axis=1)
    step = float(np.linalg.norm(np.diff(rates, axis=0), axis=1).max())
    left = np.flatnonzero(away > 3 * step)
    back = np.flatnonzero((away < step) & (np.arange(SEARCHED) > (left[0] if len(left) else SEARCHED)))
    if not len(back):
        raise OutOfReach(f"the angular velocity does not return within {end:.6g} s")
    return float(instants[back[0]])


def _in_type(value: Any, like: WideArray) -> WideArray:
    """A number, in double precision or NumPy's widest type, as an array (1,) of the type and precision of another array."""
    head = np.array([float(value)])
    return np.asarray(0 * like[:1] + head.astype(like.dtype) + np.array([float(value - head[0])]).astype(like.dtype))


def _continued(seen: Rotation, whole: WideArray, shift: Any, axis: WideArray, change: WideArray | None) -> Rotation:
    """The rotation after whole numbers (n,) of periods plus instants (n,) within a period.

    seen: the rotation at these n instants, and after them at the period and at 0.

    shift: the period minus the time that was assumed for it. change: (n, 3) angular accelerations at the instants; None where
    the shift is too small to move an instant.
    """
    quaternion, rates = seen.quaternion, seen.angular_velocity
    # The turn D = R(T) R(0)^-1 up to the correction of T, about the angular momentum.
    turn = product(quaternion[-2:-1], inverse(quaternion[-1:]))[0]
    angle = 2 * np.arctan2((turn[1:] * axis).sum(), turn[0]) + shift * (rates[-1] * _to_body(quaternion[-1], axis)).sum()
    half = whole * angle / 2
    turned = np.concatenate([np.cos(half)[:, None], np.sin(half)[:, None] * axis], axis=1)
    within, rates = quaternion[:-2], rates[:-2]
    if change is not None:
        # The instants within a period are whole * shift earlier than those that were followed.
        back = -(whole * shift)[:, None]
        sizes = np.sqrt((rates * rates).sum(axis=1))[:, None]
        small = np.concatenate([np.cos(back * sizes / 2), np.sin(back * sizes / 2) * (rates / sizes)], axis=1)
        within, rates = product(within, small), rates + back * change
    later = product(turned, within)
    return Rotation(later / np.sqrt((later * later).sum(axis=1))[:, None], rates)


def _to_body(q: WideArray, v: WideArray) -> WideArray:
    """Body components (3,) of a vector (3,) in world components, for a quaternion (4,), body to world."""
    pure = np.concatenate([0 * v[:1], v])[None]
    return np.asarray(product(product(inverse(q[None]), pure), q[None])[0, 1:])


def inverse(q: WideArray) -> WideArray:
    """The inverses (n, 4) of unit quaternions w, x, y, z (n, 4)."""
    return np.concatenate([q[:, :1], -q[:, 1:]], axis=1)


def product(p: WideArray, q: WideArray) -> WideArray:
    """The products (n, 4) of quaternions w, x, y, z (n, 4)."""
    (a, b, c, d), (w, x, y, z) = p.T, q.T
    return np.stack(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ],
        axis=1,
    )
