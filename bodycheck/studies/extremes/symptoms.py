"""What can be seen to be wrong with a motion: in its own states, by what mechanics conserves, and against the truth."""

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
from bodycheck.reference.truth import Truth, distance

#: rad, of an attitude that is lost.
ATTITUDE_LOST = 1.0

#: Of the way travelled; of the radius of gyration, into a plane.
POSITION_LOST = 0.01

#: Of the energy at the start.
ENERGY_CHANGED = 0.01

#: Rank correlation of energy and time from which a change is no oscillation: two whole periods of one have 0.4.
SECULAR = 0.6

#: Of the radius of gyration, or rad: a motion, or an error of it, that can be seen.
VISIBLE = 1e-6

#: Of an angular momentum, of which less than this is left from one instant to the next.
GONE = 1e-3

#: How much farther than usual a centre of mass goes beside what its speeds allow when it jumps.
RARE = 10.0

#: Beyond it, energies of states that are numbers may be none.
LARGEST = 1e300

#: Instants between two flips from which they can be counted.
LEAST_SAMPLES = 4


@dataclass(frozen=True)
class Symptom:
    """The status that it amounts to, and what it is in words."""

    status: str
    text: str


def of_itself(scene: Scene, trajectory: Trajectory) -> Iterator[Symptom]:
    """What a motion shows without any other to compare it with."""
    if (text := restart(scene, trajectory)) is not None:
        yield Symptom("diverged", f"{text}, of which the engine says nothing")
    yield from _frozen(scene.body, trajectory)
    if scene.plane is not None and (depth := penetration(scene, trajectory).max()) > POSITION_LOST * gyration(scene.body):
        yield Symptom("inaccurate", f"sinks {depth:.3g} m into the plane")
    yield from _energy(scene, trajectory)


def of_truth(scene: Scene, trajectory: Trajectory, truth: Truth) -> Iterator[Symptom]:
    """How a motion differs from the truth at its instants, where it is lost."""
    exact, body = truth.trajectory, scene.body
    position, attitude = errors(scene, trajectory, truth)
    way = float(np.linalg.norm(np.diff(exact.position, axis=0), axis=1).sum())
    if (position - truth.position_error > max(POSITION_LOST * way, VISIBLE * gyration(body))).any():
        yield Symptom("inaccurate", f"centre of mass {position.max():.3g} m off after a way of {way:.3g} m")
    lost = attitude - truth.error > ATTITUDE_LOST
    if lost.any():
        yield Symptom("inaccurate", f"attitude lost at t = {trajectory.t[np.argmax(lost)]:.3g} s")
    spacing = float(np.diff(trajectory.t).max(initial=0.0))
    if scene.plane is None and flip_period(body, scene.initial.angular_velocity) > LEAST_SAMPLES * spacing:
        seen, expected = flips(body, trajectory), flips(body, exact)
        # The last flip may fall on either side of the end, and by itself says nothing.
        if abs(seen - expected) > 1 or (seen != expected and lost.any()):
            yield Symptom("inaccurate", f"{seen} flips instead of {expected}")


def errors(scene: Scene, trajectory: Trajectory, truth: Truth) -> tuple[Array, Array]:
    """Distances from the truth at its instants: of the centre of mass (n,), m, and of the attitude (n,), rad.

    On a plane the centre of mass is compared along it: how far a body sinks in is another thing.
    """
    exact, along = truth.trajectory, slice(3 if scene.plane is None else 2)
    attitude = geodesic_angle(exact.quaternion, normalise(trajectory.quaternion))
    return distance(trajectory.position[:, along], exact.position[:, along]), attitude


def restart(scene: Scene, trajectory: Trajectory) -> str | None:
    """How and when a motion breaks off and another begins; None where it goes on.

    From one instant to the next, the centre of mass goes farther than the speeds at both allow, which it does not do all the
    time, or in flight the angular momentum vanishes.
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
    moved = (beside > allowed) & (beside > RARE * usual)
    momentum = np.linalg.norm(observe(scene, trajectory).body_angular_momentum, axis=1)
    stopped = momentum[1:] < GONE * momentum[:-1] if scene.plane is None else np.zeros(len(apart), dtype=bool)
    if not (moved | stopped).any():
        return None
    first = int(np.argmax(moved | stopped))
    what = f"the centre of mass has jumped {beside[first]:.3g} m" if moved[first] else "the angular momentum is gone"
    return f"{what} by t = {t[first + 1]:.6g} s"


def energy_change(scene: Scene, trajectory: Trajectory) -> Array:
    """How far energy (n,) is from its value at the start, relative; at most `LARGEST`.

    In flight it is that of the rotation, which a fall would hide, relative to the whole kinetic energy where there is none.
    On a plane it is the total, relative to the kinetic energy and that of a fall by the radius of gyration.
    """
    seen, body = observe(scene, trajectory), scene.body
    kinetic = float(seen.kinetic_energy[0])
    if scene.plane is None:
        energy, size = seen.rotational_energy, float(seen.rotational_energy[0]) or kinetic
    else:
        energy, size = seen.total_energy, kinetic + body.mass * scene.gravity * gyration(body)
    return np.asarray(np.minimum((energy - energy[0]) / (size or 1.0), LARGEST))


def flips(body: Body, trajectory: Trajectory) -> int:
    """How often the spin about the axis of the middle moment is reversed, counted where it is most of the spin."""
    rates = rotate(conjugate(np.array(body.axes)), trajectory.angular_velocity)
    middle = rates[:, sorted(range(3), key=body.moments.__getitem__)[1]]
    mostly = middle[np.abs(middle) > np.linalg.norm(rates, axis=1) / 2]
    return int((np.diff(np.sign(mostly)) != 0).sum())


def gyration(body: Body) -> float:
    """The radius of gyration (m) about the centre of mass: m r^2 is the sum of m x^2 over the body."""
    return math.sqrt(sum(body.moments) / (2 * body.mass))


def _frozen(body: Body, trajectory: Trajectory) -> Iterator[Symptom]:
    """What stands still, to the last bit, for the second half of a run, though its own velocity is not zero."""
    middle = len(trajectory) // 2
    duration = float(trajectory.t[-1] - trajectory.t[middle])
    ways = np.abs(trajectory.velocity[middle:].mean(axis=0)) * duration
    stands = (trajectory.position[middle:] == trajectory.position[-1]).all(axis=0)
    for axis, way in zip(np.array(["x", "y", "z"])[stands], ways[stands], strict=True):
        if way > VISIBLE * gyration(body):
            yield Symptom("frozen", f"{axis} stands still where it should go {way:.3g} m")
    turn = float(np.linalg.norm(trajectory.angular_velocity[middle:].mean(axis=0))) * duration
    if turn > VISIBLE and (trajectory.quaternion[middle:] == trajectory.quaternion[-1]).all():
        yield Symptom("frozen", f"the attitude stands still where it should turn by {turn:.3g} rad")


def _energy(scene: Scene, trajectory: Trajectory) -> Iterator[Symptom]:
    change = energy_change(scene, trajectory)
    if scene.plane is not None:
        if change.max() > ENERGY_CHANGED:
            yield Symptom("energy-gain", f"energy up by {change.max():.3g} of what a slide may lose")
        return
    late = float(change[-max(1, len(change) // 10) :].mean())
    if abs(late) > ENERGY_CHANGED and abs(_rank_correlation(change)) >= SECULAR:
        yield Symptom(
            "energy-gain" if late > 0 else "energy-loss", f"energy of rotation {1 + change[-1]:.3g} times the initial one"
        )
    elif np.abs(change).max() > ENERGY_CHANGED:
        yield Symptom(
            "inaccurate", f"energy of rotation from {1 + change.min():.3g} to {1 + change.max():.3g} times the initial one"
        )


def _rank_correlation(values: Array) -> float:
    """Return Spearman's rank correlation of values (n,) with their order; NaN for a single value.

    Equal values rank in their order, so that what reaches a value and keeps it counts as rising.
    """
    from scipy.stats import rankdata, spearmanr  # few motions need it, and it takes long to import

    return float(spearmanr(np.arange(len(values)), rankdata(values, method="ordinal")).statistic)
