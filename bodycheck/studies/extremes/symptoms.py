"""Find the symptoms of a wrong motion: in its states, in the quantities that mechanics conserves, and against the truth."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact_observables import penetration
from bodycheck.reference.flight.closed_form import flip_period
from bodycheck.reference.kinematics import conjugate, geodesic_angle, normalise, rotate
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Body, Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth, distance

#: Attitude error from which the attitude counts as lost.
ATTITUDE_LOST_RAD = 1.0

#: Position error relative to the distance travelled, or penetration relative to the radius of gyration, that is a symptom.
POSITION_LOST_FRACTION = 0.01

#: Change of the energy relative to its initial value that is a symptom.
ENERGY_CHANGE_LIMIT = 0.01

#: Rank correlation of energy and time from which a change is not an oscillation; two full periods of one have 0.4.
SECULAR_CORRELATION = 0.6

#: Smallest visible motion or error, relative to the radius of gyration or in rad.
VISIBLE_MOTION = 1e-6

#: Remaining fraction of the angular momentum after one sampling interval, below which it counts as lost.
MOMENTUM_LOST_FRACTION = 1e-3

#: Ratio of an unexplained displacement to the usual one, from which it is a jump.
JUMP_RATIO = 10.0

#: Largest relative change of the energy that is reported, because the energy of finite states may overflow.
MAX_RELATIVE_ENERGY = 1e300

#: Smallest number of samples between two flips with which flips can be counted.
MIN_SAMPLES_PER_FLIP = 4


@dataclass(frozen=True)
class Symptom:
    """A symptom: the status that it implies, and its description."""

    status: str
    text: str


def of_itself(scene: Scene, trajectory: Trajectory) -> Iterator[Symptom]:
    """Yield the symptoms of a motion that are visible without comparison with a truth."""
    if (text := restart(scene, trajectory)) is not None:
        yield Symptom("diverged", f"{text}, of which the engine says nothing")
    yield from _frozen(scene.body, trajectory)
    if scene.plane is not None and (depth := penetration(scene, trajectory).max()) > POSITION_LOST_FRACTION * gyration(
        scene.body
    ):
        yield Symptom("inaccurate", f"sinks {depth:.3g} m into the plane")
    yield from _energy(scene, trajectory)


def of_truth(scene: Scene, trajectory: Trajectory, truth: Truth) -> Iterator[Symptom]:
    """Yield the symptoms of a motion that differs too much from the truth, which must have the same instants."""
    exact, body = truth.trajectory, scene.body
    position, attitude = errors(scene, trajectory, truth)
    way = float(np.nansum(np.linalg.norm(np.diff(exact.position, axis=0), axis=1)))
    if (position - truth.bounds.position_error > max(POSITION_LOST_FRACTION * way, VISIBLE_MOTION * gyration(body))).any():
        yield Symptom("inaccurate", f"centre of mass {np.fmax.reduce(position):.3g} m off after a path of {way:.3g} m")
    lost = attitude - truth.bounds.error > ATTITUDE_LOST_RAD
    if lost.any():
        yield Symptom("inaccurate", f"attitude lost at t = {trajectory.t[np.argmax(lost)]:.3g} s")
    spacing = float(np.diff(trajectory.t).max(initial=0.0))
    if scene.plane is None and flip_period(scene) > MIN_SAMPLES_PER_FLIP * spacing:
        seen, expected = flips(body, trajectory), flips(body, exact)
        # The last flip may happen just before or after the end, so a difference of one alone is not a symptom.
        if abs(seen - expected) > 1 or (seen != expected and lost.any()):
            yield Symptom("inaccurate", f"{seen} flips instead of {expected}")


def errors(scene: Scene, trajectory: Trajectory, truth: Truth) -> tuple[Array, Array]:
    """Return the errors of the centre of mass (n,), in m, and of the attitude (n,), in rad, at the truth's instants.

    On a plane, the centre of mass is compared only along the plane, because penetration is a symptom of its own.
    """
    exact, along = truth.trajectory, slice(3 if scene.plane is None else 2)
    attitude = geodesic_angle(exact.quaternion, normalise(trajectory.quaternion))
    return distance(trajectory.position[:, along], exact.position[:, along]), attitude


def restart(scene: Scene, trajectory: Trajectory) -> str | None:
    """Return how and when a motion was interrupted and began anew; None if it was not.

    A motion was interrupted if, from one instant to the next, the centre of mass moves farther than the speeds at both allow,
    and much farther than usual, or if the angular momentum of a flight vanishes.
    """
    t, position = trajectory.t, trajectory.position
    if len(t) < 2:
        return None
    apart, span = np.diff(t), np.abs(position).max()
    speed = np.linalg.norm(trajectory.velocity, axis=1)
    mean = (trajectory.velocity[1:] + trajectory.velocity[:-1]) / 2
    beside = np.linalg.norm(np.diff(position, axis=0) - mean * apart[:, None], axis=1)
    allowed = (speed[1:] + speed[:-1] + scene.gravity * apart) * apart + 1e-12 * span
    usual = np.median(np.sort(beside)[:-1]) if len(beside) > 1 else 0.0
    moved = (beside > allowed) & (beside > JUMP_RATIO * usual)
    momentum = np.linalg.norm(observe(scene, trajectory).body_angular_momentum, axis=1)
    stopped = momentum[1:] < MOMENTUM_LOST_FRACTION * momentum[:-1] if scene.plane is None else np.zeros(len(apart), dtype=bool)
    if not (moved | stopped).any():
        return None
    first = int(np.argmax(moved | stopped))
    what = f"the centre of mass has jumped {beside[first]:.3g} m" if moved[first] else "the angular momentum is gone"
    return f"{what} by t = {t[first + 1]:.6g} s"


def energy_change(scene: Scene, trajectory: Trajectory) -> Array:
    """Return the relative change (n,) of the energy since the start, at most `MAX_RELATIVE_ENERGY`.

    In flight, it is the energy of rotation, because the energy of a fall would hide its changes; it is relative to its initial
    value, or to the kinetic energy if the body does not rotate. On a plane, it is the total energy, relative to the sum of the
    kinetic energy and the energy of a fall by the radius of gyration.
    """
    seen, body = observe(scene, trajectory), scene.body
    kinetic = float(seen.kinetic_energy[0])
    if scene.plane is None:
        energy, size = seen.rotational_energy, float(seen.rotational_energy[0]) or kinetic
    else:
        energy, size = seen.total_energy, kinetic + body.mass * scene.gravity * gyration(body)
    return np.asarray(np.minimum((energy - energy[0]) / (size or 1.0), MAX_RELATIVE_ENERGY))


def flips(body: Body, trajectory: Trajectory) -> int:
    """Return the number of reversals of the spin about the intermediate axis, counted where this is most of the spin."""
    rates = rotate(conjugate(np.array(body.axes)), trajectory.angular_velocity)
    middle = rates[:, sorted(range(3), key=body.moments.__getitem__)[1]]
    mostly = middle[np.abs(middle) > np.linalg.norm(rates, axis=1) / 2]
    return int((np.diff(np.sign(mostly)) != 0).sum())


def gyration(body: Body) -> float:
    """Return the radius of gyration (m) about the centre of mass: m r^2 is the sum of m x^2 over the body."""
    return math.sqrt(sum(body.moments) / (2 * body.mass))


def _frozen(body: Body, trajectory: Trajectory) -> Iterator[Symptom]:
    """Yield the coordinates that stay equal to the last bit in the second half of a run, although the velocity is not zero."""
    middle = len(trajectory) // 2
    duration = float(trajectory.t[-1] - trajectory.t[middle])
    ways = np.abs(trajectory.velocity[middle:].mean(axis=0)) * duration
    stands = (trajectory.position[middle:] == trajectory.position[-1]).all(axis=0)
    for axis, way in zip(np.array(["x", "y", "z"])[stands], ways[stands], strict=True):
        if way > VISIBLE_MOTION * gyration(body):
            yield Symptom("frozen", f"{axis} stands still where it should go {way:.3g} m")
    turn = float(np.linalg.norm(trajectory.angular_velocity[middle:].mean(axis=0))) * duration
    if turn > VISIBLE_MOTION and (trajectory.quaternion[middle:] == trajectory.quaternion[-1]).all():
        yield Symptom("frozen", f"the attitude stands still where it should turn by {turn:.3g} rad")


def _energy(scene: Scene, trajectory: Trajectory) -> Iterator[Symptom]:
    change = energy_change(scene, trajectory)
    if scene.plane is not None:
        if change.max() > ENERGY_CHANGE_LIMIT:
            yield Symptom("energy-gain", f"energy up by {change.max():.3g} of what a slide may lose")
        return
    late = float(change[-max(1, len(change) // 10) :].mean())
    if abs(late) > ENERGY_CHANGE_LIMIT and abs(rank_correlation(change)) >= SECULAR_CORRELATION:
        yield Symptom(
            "energy-gain" if late > 0 else "energy-loss", f"energy of rotation {1 + change[-1]:.3g} times the initial one"
        )
    elif np.abs(change).max() > ENERGY_CHANGE_LIMIT:
        yield Symptom(
            "inaccurate", f"energy of rotation from {1 + change.min():.3g} to {1 + change.max():.3g} times the initial one"
        )


def rank_correlation(values: Array) -> float:
    """Return Spearman's rank correlation of values (n,) with their order; NaN for a single value.

    Equal values rank in their order, so that a quantity that reaches a value and keeps it counts as rising.
    """
    from scipy.stats import rankdata, spearmanr  # few motions need it, and it takes long to import

    return float(spearmanr(np.arange(len(values)), rankdata(values, method="ordinal")).statistic)
