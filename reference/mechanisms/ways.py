"""Ways to the motion of a mechanism, the differences of two ways, and the bounds of figures from errors of states."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.reference.bounds import STATES, Bounds
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.kinematics import dot
from bodycheck.reference.mechanisms import exact, observables
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.witness import DOUBLE_DIGITS, angle_between


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of a mechanism at n instants, in a floating-point type that may be wider than double.

    Attributes
    ----------
    position, velocity
        (n, c) coordinates and (n, u) velocities of the joints, in the layout of `coordinates`.
    bodies
        The states (b, n, ...) of all bodies.
    """

    position: WideArray
    velocity: WideArray
    bodies: Trajectory

    def part(self, rows: Any) -> "Motion":
        """The motion at some of the instants, selected by a slice, by indices or by a mask (n,)."""
        return Motion(self.position[rows], self.velocity[rows], self.bodies.part(rows))


@dataclass(frozen=True, eq=False)
class Way:
    """A motion that was computed in one way.

    Attributes
    ----------
    name
        The names of the way and of the software that computed it.
    motion
        The motion.
    errors
        (n,) bounds of its errors, by the names of `bounds.STATES`; empty if they are not known.
    digits
        Decimal digits of the arithmetic.
    """

    name: str
    motion: Motion
    errors: dict[str, Array]
    digits: int = DOUBLE_DIGITS


#: A function that follows a mechanism at ascending times in parts, the first of which begins at t = 0, and yields the motion of
#: each part before it follows the next one.
Follow = Callable[[Mechanism, Sequence[Array]], Iterator[Motion]]


def letters(mechanism: Mechanism) -> tuple[str, str]:
    """Return the meanings of a mechanism's coordinates and velocities, with a letter of `joint_types.LETTERS` for each."""
    forms = [joint.form for joint in mechanism.joints]
    return "".join(form.coordinates for form in forms), "".join(form.velocities for form in forms)


def apart(mechanism: Mechanism, one: Motion, other: Motion) -> dict[str, Array]:
    """Return the differences (n,) of two motions at each instant, by the names of `bounds.STATES`.

    Each is the largest over all bodies and joints. Angles of joints count with attitudes (rad), slides with positions (m), and
    their rates with angular velocities (rad/s) and velocities (m/s). Differences are computed in the wider of the two types.
    """
    held, moving = letters(mechanism)
    turned = _angles(one.bodies.quaternion, other.bodies.quaternion)
    for joint, (slots, _) in zip(mechanism.joints, places(mechanism), strict=True):
        if joint.form.has_quaternion:
            turned = np.maximum(turned, angle_between(one.position[:, slots][:, -4:], other.position[:, slots][:, -4:]))
    return {
        "error": np.maximum(turned, _differences(one.position, other.position, held, "a")),
        "position_error": np.maximum(
            _lengths(one.bodies.position, other.bodies.position), _differences(one.position, other.position, held, "l")
        ),
        "velocity_error": np.maximum(
            _lengths(one.bodies.velocity, other.bodies.velocity), _differences(one.velocity, other.velocity, moving, "l")
        ),
        "angular_velocity_error": np.maximum(
            _lengths(one.bodies.angular_velocity, other.bodies.angular_velocity),
            _differences(one.velocity, other.velocity, moving, "a"),
        ),
    }


def sizes(mechanism: Mechanism, motion: Motion) -> dict[str, Array]:
    """The largest sizes (n,) of the quantities that `apart` compares: angles of joints, positions, speeds and rates."""
    held, moving = letters(mechanism)
    bodies = motion.bodies

    def largest(vectors: WideArray, joints: WideArray, kinds: str, letter: str) -> Array:
        return np.maximum(_lengths(vectors, np.zeros_like(vectors)), _differences(joints, np.zeros_like(joints), kinds, letter))

    return {
        "error": _differences(motion.position, np.zeros_like(motion.position), held, "a"),
        "position_error": largest(bodies.position, motion.position, held, "l"),
        "velocity_error": largest(bodies.velocity, motion.velocity, moving, "l"),
        "angular_velocity_error": largest(bodies.angular_velocity, motion.velocity, moving, "a"),
    }


def _angles(one: WideArray, other: WideArray) -> Array:
    """The largest angle (n,), over all bodies, between attitudes (b, n, 4)."""
    b, n, _ = one.shape
    return np.asarray(angle_between(one.reshape(-1, 4), other.reshape(-1, 4)).reshape(b, n).max(axis=0))


def _lengths(one: WideArray, other: WideArray) -> Array:
    """The largest distance (n,), over all bodies, between vectors (b, n, 3)."""
    difference = one - other
    return np.asarray(np.sqrt((difference * difference).sum(axis=-1)).astype(float).max(axis=0))


def _differences(one: WideArray, other: WideArray, letters: str, letter: str) -> Array:
    """The largest difference (n,) between the coordinates (n, c) whose letter in `letters` is `letter`."""
    columns = [column for column, each in enumerate(letters) if each == letter]
    differences = np.abs(one[:, columns] - other[:, columns]).astype(float)
    return np.asarray(differences.max(axis=1, initial=0.0))


def bounds_of(mechanism: Mechanism, motion: Trajectory, joints: Array, errors: dict[str, Array]) -> Bounds:
    """The bounds (n,) of the errors of all figures, from bounds of the errors of the states, in any direction.

    Energy and angular momentum are computed by `observables.observe`, whose rounding the bounds do not include.

    Parameters
    ----------
    mechanism
        The mechanism.
    motion
        The states (b, n, ...) of its bodies.
    joints
        (n, c) coordinates of its joints.
    errors
        (n,) bounds of the errors of the states, by the names of `bounds.STATES`.
    """
    of_states = {name: errors[name] for name in STATES}
    masses = observables.masses(mechanism)[:, None]
    moments = np.array([np.trace(observables.tensor(body)) / 2 for body in mechanism.bodies])[:, None]
    speeds, spins = (np.sqrt(dot(each, each)) for each in (motion.velocity, motion.angular_velocity))
    shift, slip, spun = errors["position_error"], errors["velocity_error"], errors["angular_velocity_error"]
    turned = np.minimum(errors["error"], 2.0)  # a unit vector that is turned by any angle moves by at most 2
    energy = masses * (slip * (speeds + slip) + mechanism.gravity * shift) + moments * spun * (spins + spun)
    whole = masses.sum() or 1.0  # bodies without mass have no momentum
    centre = (masses[..., None] * motion.position).sum(axis=0) / whole
    common = (masses[..., None] * motion.velocity).sum(axis=0) / whole
    arms, drifts = (
        np.linalg.norm(each - mean, axis=-1) for each, mean in ((motion.position, centre), (motion.velocity, common))
    )
    momentum = masses * ((arms + shift) * 2 * slip + drifts * 2 * shift) + moments * (spun + spins * turned)
    return Bounds(
        **of_states,
        energy_error=energy.sum(axis=0) + _of_joints(mechanism, joints, motion, of_states),
        angular_momentum_error=momentum.sum(axis=0),
    )


def _of_joints(mechanism: Mechanism, position: Array, motion: Trajectory, errors: dict[str, Array]) -> Array:
    """The bound (n,), J, of the error of the energies of armatures, springs, elastic stops and efforts.

    A joint's rate is at most the difference of the velocities of its two bodies, and its error is at most twice their error.
    """
    total = np.zeros(len(motion))
    rates = {
        True: 2 * np.linalg.norm(motion.angular_velocity, axis=-1).max(axis=0),
        False: 2 * np.linalg.norm(motion.velocity, axis=-1).max(axis=0),
    }
    for joint, (held, _) in zip(mechanism.joints, places(mechanism), strict=True):
        if not observables.has_energy(joint):
            continue
        turns = joint.type == "revolute"
        moved = 2 * errors["error" if turns else "position_error"]
        slipped = 2 * errors["angular_velocity_error" if turns else "velocity_error"]
        stretch = np.abs(position[:, held][:, 0] - joint.rest)
        total += joint.armature * slipped * (rates[turns] + slipped)
        total += (joint.stiffness * (stretch + moved) + abs(joint.effort)) * moved
        if joint.stops is not None and joint.stops.stiffness:
            beyond = observables.stretch_of_stops(joint.stops, position[:, held][:, 0])
            total += joint.stops.stiffness * (beyond + moved) * moved
    return total


def reach(mechanism: Mechanism) -> float:
    """The largest length in a mechanism (m), from an origin of a joint to another or to a centre of mass; 1 if all are 0."""
    lengths = [np.linalg.norm(joint.position) for joint in mechanism.joints]
    lengths += [np.linalg.norm(exact.nearest_inertia(body).centre) for body in mechanism.bodies]
    return float(max(lengths, default=0.0)) or 1.0
