"""Find the symptoms of a wrong motion in its states, in the quantities that mechanics conserves, and in its errors.

The comparison with the truth is the same for every scene. Without a truth, a motion is judged by conditions that every correct
motion satisfies: a body in flight keeps turning and conserves its energy of rotation, a body on the plane does not gain energy,
joints hold together, and bodies that touch neither sink into the plane nor gain energy.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bodycheck.figures.conservation import energy_size
from bodycheck.figures.touching import energy_from_plane, gained
from bodycheck.reference.bodies import bodies, motions, of_bodies
from bodycheck.reference.contact.observables import depth
from bodycheck.reference.contact.touching import touching
from bodycheck.reference.contact_observables import penetration, reach
from bodycheck.reference.flight.closed_form import flip_period
from bodycheck.reference.kinematics import conjugate, geodesic_angle, normalise, rotate
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.mechanisms.observables import observe as observe_mechanism
from bodycheck.reference.observables import observe
from bodycheck.reference.requirements import grips, slides, touches
from bodycheck.reference.scene import Body, Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth, distance

#: Attitude error (rad) above which the attitude counts as lost.
ATTITUDE_LOST_RAD = 1.0

#: Limit of the position error relative to the distance travelled, and of the penetration relative to the radius of gyration.
#: Larger values are symptoms.
POSITION_LOST_FRACTION = 0.01

#: Relative change of the energy above which it is a symptom.
ENERGY_CHANGE_LIMIT = 0.01

#: Rank correlation of energy and time from which a change is not an oscillation; two full periods of an oscillation have 0.4.
SECULAR_CORRELATION = 0.6

#: Smallest motion or error that counts as visible, relative to the radius of gyration or in rad.
VISIBLE_MOTION = 1e-6

#: Remaining fraction of the angular momentum after one sampling interval, below which it counts as lost.
MOMENTUM_LOST_FRACTION = 1e-3

#: Ratio of an unexplained displacement to the usual displacement above which it is a jump.
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


def of_itself(scene: AnyScene, trajectory: Trajectory) -> Iterator[Symptom]:
    """Yield the symptoms of a motion that are visible without a comparison with the truth."""
    if touches(scene):
        yield from _of_touching(scene, trajectory)
    elif isinstance(scene, Mechanism):
        gap = kinematics.gaps(scene, trajectory).max(initial=0.0)
        if gap > POSITION_LOST_FRACTION * _reach(scene, trajectory):
            yield Symptom("inaccurate", f"joints or loops come apart by {gap:.3g} m")
        if scene.conserves:
            yield from _energy(scene, trajectory)
    else:
        if (text := restart(scene, trajectory)) is not None:
            yield Symptom("diverged", f"{text}, of which the engine says nothing")
        yield from _frozen(scene.body, trajectory)
        if (deepest := penetration(scene, trajectory).max()) > POSITION_LOST_FRACTION * gyration(scene.body):
            yield Symptom("inaccurate", f"sinks {deepest:.3g} m into the plane")
        yield from _energy(scene, trajectory)


def of_truth(scene: AnyScene, trajectory: Trajectory, truth: Truth) -> Iterator[Symptom]:
    """Yield the symptoms in which a motion differs from the truth. The trajectory and the truth must have the same instants."""
    position, attitude = errors(scene, trajectory, truth)
    paths = np.linalg.norm(np.diff(of_bodies(truth.trajectory).position, axis=-2), axis=-1)
    longest = float(np.nansum(paths, axis=-1).max())
    several = touches(scene) or isinstance(scene, Mechanism)
    if (position - truth.bounds.position_error > _far(scene, trajectory, truth, longest)).any():
        subject = "a body is" if several else "centre of mass"
        yield Symptom("inaccurate", f"{subject} {np.fmax.reduce(position):.3g} m off after a path of {longest:.3g} m")
    lost = attitude - truth.bounds.error > ATTITUDE_LOST_RAD
    if lost.any():
        subject = "an attitude is" if several else "attitude"
        yield Symptom("inaccurate", f"{subject} lost at t = {trajectory.t[np.argmax(lost)]:.3g} s")
    spacing = float(np.diff(trajectory.t).max(initial=0.0))
    if isinstance(scene, Scene) and scene.plane is None and flip_period(scene) > MIN_SAMPLES_PER_FLIP * spacing:
        seen, expected = flips(scene.body, trajectory), flips(scene.body, truth.trajectory)
        # The last flip may happen just before or after the end. Therefore a difference of one flip alone is not a symptom.
        if abs(seen - expected) > 1 or (seen != expected and lost.any()):
            yield Symptom("inaccurate", f"{seen} flips instead of {expected}")


def errors(scene: AnyScene, trajectory: Trajectory, truth: Truth) -> tuple[Array, Array]:
    """Return the position errors of the centre of mass (n,), m, and the attitude errors (n,), rad: the largest over the bodies.

    The trajectory and the truth must have the same n instants. Errors are NaN at instants at which mechanics determines no
    motion. A body that slides on the plane is compared only along the plane, because penetration is a separate symptom.
    """
    run, exact = of_bodies(trajectory), of_bodies(truth.trajectory)
    along = slice(2 if slides(scene) else 3)
    position = distance(run.position[..., along], exact.position[..., along])
    attitude = geodesic_angle(exact.quaternion, normalise(run.quaternion))
    return np.asarray(position.max(axis=0)), np.asarray(attitude.max(axis=0))


def _far(scene: AnyScene, trajectory: Trajectory, truth: Truth, longest: float) -> float:
    """Return the position error (m) above which it is a symptom. longest: the longest path of a body in the truth (m)."""
    if touches(scene):
        return POSITION_LOST_FRACTION * max(longest, _size(scene, trajectory))
    visible = _reach(scene, truth.trajectory) if isinstance(scene, Mechanism) else gyration(scene.body)
    return max(POSITION_LOST_FRACTION * longest, VISIBLE_MOTION * visible)


def _of_touching(scene: AnyScene, trajectory: Trajectory) -> Iterator[Symptom]:
    """Yield the symptoms of bodies that touch: penetration of the plane, and gain of energy."""
    for body, motion in zip(touching(scene), motions(scene, trajectory), strict=scene.plane is not None):
        if (deepest := depth(body, motion).max()) > POSITION_LOST_FRACTION * _size(scene, trajectory):
            yield Symptom("inaccurate", f"sinks {deepest:.3g} m into the plane")
            break
    if grips(scene):  # the efforts of fingers do work
        return
    gain = gained(scene, trajectory).max() / (float(energy_from_plane(scene, trajectory)[0]) or 1.0)
    if gain > ENERGY_CHANGE_LIMIT:
        counted = "" if scene.plane is None else ", which is counted from the plane"
        yield Symptom("energy-gain", f"energy up by {gain:.3g} of the initial one{counted}")


def restart(scene: Scene, trajectory: Trajectory) -> str | None:
    """Return how and when a motion was interrupted and restarted, in words; None if it was not interrupted.

    A motion was interrupted if, from one instant to the next, the centre of mass moves farther than the speeds at both instants
    allow, and much farther than usual, or if the angular momentum of a flight vanishes.
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


def energy_change(scene: AnyScene, trajectory: Trajectory) -> Array:
    """Return the relative change (n,) of the energy since the start, at most `MAX_RELATIVE_ENERGY`.

    For a mechanism, the change of the total energy is divided by the kinetic energy. For a body in flight, the change of the
    energy of rotation is divided by its initial value, or by the initial kinetic energy if the body does not rotate; the total
    energy is not used, because the energy of a fall would hide the changes. For a body on a plane, the change of the total
    energy is divided by the sum of the initial kinetic energy and the energy of a fall by the radius of gyration.
    """
    if isinstance(scene, Mechanism):
        total = observe_mechanism(scene, trajectory)
        change = (total.total_energy - total.total_energy[0]) / energy_size(total, 0.0)
        return np.asarray(np.minimum(change, MAX_RELATIVE_ENERGY))
    seen, body = observe(scene, trajectory), scene.body
    kinetic = float(seen.kinetic_energy[0])
    if scene.plane is None:
        energy, size = seen.rotational_energy, float(seen.rotational_energy[0]) or kinetic
    else:
        energy, size = seen.total_energy, kinetic + body.mass * scene.gravity * gyration(body)
    return np.asarray(np.minimum((energy - energy[0]) / (size or 1.0), MAX_RELATIVE_ENERGY))


def flips(body: Body, trajectory: Trajectory) -> int:
    """Return how often the spin about the axis of the intermediate moment of inertia reverses.

    Only instants at which this component is more than half of the angular velocity are counted.
    """
    rates = rotate(conjugate(np.array(body.axes)), trajectory.angular_velocity)
    middle = rates[:, sorted(range(3), key=body.moments.__getitem__)[1]]
    mostly = middle[np.abs(middle) > np.linalg.norm(rates, axis=1) / 2]
    return int((np.diff(np.sign(mostly)) != 0).sum())


def gyration(body: Body) -> float:
    """Return the radius of gyration r (m) of a body: m r^2 is the integral of |x|^2 dm, with x from the centre of mass."""
    return math.sqrt(sum(body.moments) / (2 * body.mass))


def _frozen(body: Body, trajectory: Trajectory) -> Iterator[Symptom]:
    """Yield a symptom for each position coordinate, and for the attitude, that is frozen although the velocity is not zero.

    A quantity is frozen if all its values in the second half of the run are equal to the last bit.
    """
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


def _energy(scene: AnyScene, trajectory: Trajectory) -> Iterator[Symptom]:
    """Yield a symptom if the energy changes too much: if it grows on a plane, or if it changes where it is conserved."""
    change = energy_change(scene, trajectory)
    if scene.plane is not None:
        if change.max() > ENERGY_CHANGE_LIMIT:
            yield Symptom("energy-gain", f"energy up by {change.max():.3g} of what a slide may lose")
        return
    single = isinstance(scene, Scene)
    late = float(change[-max(1, len(change) // 10) :].mean())
    if abs(late) > ENERGY_CHANGE_LIMIT and abs(rank_correlation(change)) >= SECULAR_CORRELATION:
        of_rotation = f"energy of rotation {1 + change[-1]:.3g} times the initial one"
        text = of_rotation if single else f"energy changed by {change[-1]:.3g} of the kinetic energy"
        yield Symptom("energy-gain" if late > 0 else "energy-loss", text)
    elif np.abs(change).max() > ENERGY_CHANGE_LIMIT:
        of_rotation = f"energy of rotation from {1 + change.min():.3g} to {1 + change.max():.3g} times the initial one"
        text = of_rotation if single else f"energy off by {change.min():.3g} to {change.max():.3g} of the kinetic energy"
        yield Symptom("inaccurate", text)


def _reach(mechanism: Mechanism, trajectory: Trajectory) -> float:
    """Return the largest distance (m) of any body from the initial position of the first body, and from its own joint.

    The size of a body counts too, so that a mechanism at rest has a reach.
    """
    moved = float(np.fmax.reduce(np.linalg.norm(trajectory.position - trajectory.position[0, 0], axis=-1), axis=None))
    sizes = [math.sqrt(float(np.trace(body.tensor)) / 2 / body.mass) for body in bodies(mechanism) if body.mass]
    apart = [math.hypot(*nearest_inertia(body).centre) for body in mechanism.bodies]
    return max(moved, *sizes, *apart)


def _size(scene: AnyScene, trajectory: Trajectory) -> float:
    """Return the extent (m) of a touching body from its centre of mass towards the plane at the start: the largest of all.

    Without a plane, the extent is that along z.
    """
    normal = (0.0, 0.0, 1.0) if scene.plane is None else scene.plane.normal
    first = [motion.quaternion[:1] for motion in motions(scene, trajectory)]
    shapes = [(body.shape, turn) for body, turn in zip(bodies(scene), first, strict=True)]
    return max(float(reach(shape, turn, normal)[0]) for shape, turn in shapes if shape is not None)


def rank_correlation(values: Array) -> float:
    """Return Spearman's rank correlation of values (n,) with their indices; NaN for a single value.

    Equal values are ranked by their indices, so that a quantity that reaches a value and keeps it counts as rising.
    """
    from scipy.stats import rankdata, spearmanr  # few motions need it, and it takes long to import

    return float(spearmanr(np.arange(len(values)), rankdata(values, method="ordinal")).statistic)
