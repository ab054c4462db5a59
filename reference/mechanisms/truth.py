"""The truth of a mechanism: its motion together with a bound of the motion's own error.

The way is the closed form if the mechanism has one, and otherwise the articulated-body recursion; see `followed`. Its witness
is another way: for a closed form the recursion, and for the recursion the Lagrangian, which starts from the numbers of the
mechanism and shares no formula with the recursion. The bound has three parts.

- The rounding of the stated numbers to double precision.
- The bound of the error that the way itself states; see `followed`.
- Twice the largest disagreement with the witness so far beyond the bounds of both, until errors may be as large as the motion.
  It is zero if both bounds hold. Otherwise one of the two is wrong, and nothing tells which; if the witness were exact, the
  error would be the disagreement. The witness of a mechanism with loops has no bound of its own, so that its errors count as
  disagreement.

If energy is conserved, it must not drift by more than the bound allows, and the centre of mass of a chain that floats freely
must stay on its parabola; otherwise all bounds are multiplied by the ratio of the deviation to the allowed deviation.
"""

from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.bounds import EPS, STATES, Bounds
from bodycheck.reference.errors import NotModelled, OutOfReach, Stopped, within_range
from bodycheck.reference.mechanisms import kinematics, observables
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.followed import Followed, followed
from bodycheck.reference.mechanisms.forms.momentum import floating
from bodycheck.reference.mechanisms.hybrid.acting import with_acting_stops
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.modelled import sudden
from bodycheck.reference.mechanisms.ways import Way, apart, bounds_of, sizes
from bodycheck.reference.mechanisms.witnesses import errors_of_witness, followed_with_witness, witness_of
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Computed, Truth

#: The factor by which the error may exceed the excess of a disagreement with a witness: see the docstring of the module.
DISAGREEMENT = 2.0

#: Number of roundings of attitudes and angles, and of the joints' angles that follow from attitudes in double precision.
PRINTED_ROUNDINGS = 4.0

#: Number of roundings of an energy that is computed from states, relative to its terms.
OBSERVED_ROUNDINGS = 32.0

#: Error (rad) up to which a motion counts as known.
KNOWN = 1e-9


def mechanism_truth(mechanism: Mechanism, times: Array, *, vouched: bool = True) -> Truth:
    """The truth of a mechanism at ascending times (n,) >= 0, s.

    If errors grow so much that less and less of the motion is known, the bounds grow with them: see `known_until`.

    vouched: whether the motion is compared with its witness. If not, or if the witness cannot follow the motion, the bounds are
    the bounds that the way itself states.

    Raises `NotModelled` if the reference has no model of the mechanism, and `OutOfReach` if it cannot follow the motion.
    """
    return computed_mechanism(mechanism, times, vouched=vouched).truth


def known_until(truth: Truth, error: float = KNOWN) -> float | None:
    """The last instant (s) of a truth until which the bound of its attitudes and angles is at most `error` (rad).

    Returns None if the bound is larger from the first instant on.
    """
    known = truth.bounds.error <= error
    last = len(known) if known.all() else int(np.argmin(known))
    return float(truth.trajectory.t[last - 1]) if last else None


def computed_mechanism(mechanism: Mechanism, times: Array, *, vouched: bool = True) -> Computed:
    """The truth of a mechanism with the bounds of its way; the arguments and exceptions are those of `mechanism_truth`."""
    times = np.asarray(times, dtype=float)
    with within_range("the motion"):
        if vouched:
            return joined(mechanism, times, *course_and_witness(mechanism, times))
        return joined(mechanism, times, course_of(mechanism, times), None)


def course_of(mechanism: Mechanism, times: Array) -> Followed:
    """The motion of a mechanism at ascending times (n,), s, with the rigid stops that act. Raises as `mechanism_truth`."""
    return followed(with_acting_stops(mechanism, float(times[-1]) if len(times) else 0.0), times)


def course_and_witness(mechanism: Mechanism, times: Array) -> tuple[Followed, Way | None]:
    """The motion of `course_of` with its witness, which decides by itself which stops act. Raises as `mechanism_truth`."""
    if sudden(mechanism):
        course = course_of(mechanism, times)
        return course, witness_of(mechanism, times, course)
    return followed_with_witness(mechanism, times)


def end_of_stops(mechanism: Mechanism, instants: Array) -> tuple[float, str] | None:
    """Return the last of ascending instants (n,), s, until which the motion with rigid stops can be followed, and why it ends.

    The instant is 0 if the motion ends before the second one. Returns None if it does not end.
    """
    until: float | None = None
    reason = ""
    while until != 0:
        try:
            with within_range("the motion"):
                course_of(replace(mechanism, stops_until=until), instants)
        except (NotModelled, OutOfReach) as error:
            end = error.time if isinstance(error, Stopped) else 0.0
            if until is not None and end > until:  # the motion without stops ends there
                return until, reason
            until, reason = float(instants[max(int(np.searchsorted(instants, end)) - 1, 0)]), str(error)
        else:
            return None if until is None else (until, reason)
    return 0.0, reason


def joined(mechanism: Mechanism, times: Array, course: Followed, witness: Way | None) -> Computed:
    """The truth of a mechanism at times (n,), s, from its way and the witness of the way."""
    rounded = printed(mechanism, times, course)
    errors = rounded.bounds.of_states()
    if witness is not None:
        for name, difference in _excess(mechanism, times, course, witness).items():
            errors[name] = errors[name] + DISAGREEMENT * difference
    truth = Truth(
        mechanism,
        rounded.trajectory,
        _explained(mechanism, rounded, errors),
        course.model,
        course.reason,
        course.backend,
        () if witness is None else (witness.name,),
        joints=rounded.joints,
        growth=None if course.growth is None else course.growth.of_start,
    )
    return Computed(truth, rounded.bounds, ())


def _excess(mechanism: Mechanism, times: Array, course: Followed, witness: Way) -> dict[str, Array]:
    """Return the largest disagreements (n,) so far of a way and its witness beyond the bounds of both, by their names.

    If the disagreement is within the bounds of the way alone, the bounds of the witness are not computed. After the end of the
    witness, the disagreements stay as they are.
    """
    motion, count = course.way.motion, len(witness.motion.position)
    differences = apart(mechanism, motion.part(slice(count)), witness.motion)
    over = {name: difference - course.way.errors[name][:count] for name, difference in differences.items()}
    if any((values > 0).any() for values in over.values()):
        course = replace(course, growth=None if course.growth is None else course.growth.until(times[:count]))
        for name, error in errors_of_witness(mechanism, times, course, witness).items():
            over[name] = over[name] - error
    largest = {name: np.maximum.accumulate(np.maximum(values, 0.0)) for name, values in over.items()}
    return {
        name: np.pad(values, (0, len(times) - count), mode="edge" if count else "constant") for name, values in largest.items()
    }


@dataclass(frozen=True, eq=False)
class Printed:
    """A motion in double precision, and the bounds of its errors that the way itself states, with this rounding."""

    trajectory: Trajectory
    joints: JointMotion
    bounds: Bounds


def printed(mechanism: Mechanism, times: Array, course: Followed) -> Printed:
    """The motion of a way at times (n,), s, rounded to double precision."""
    motion = course.way.motion
    states = motion.bodies.position, motion.bodies.quaternion, motion.bodies.velocity, motion.bodies.angular_velocity
    trajectory = Trajectory(times, *(values.astype(float) for values in states))
    largest = sizes(mechanism, motion)
    errors = {name: course.way.errors[name] + EPS * largest[name] for name in STATES}
    errors["error"] = errors["error"] + PRINTED_ROUNDINGS * EPS
    joints = JointMotion(motion.position.astype(float), motion.velocity.astype(float))
    return Printed(trajectory, joints, bounds_of(mechanism, trajectory, joints.position, errors))


def _explained(mechanism: Mechanism, rounded: Printed, errors: dict[str, Array]) -> Bounds:
    """The bounds of all figures, increased if energy or a centre of mass drifts by more than they allow."""
    trajectory, joints = rounded.trajectory, rounded.joints.position
    bounds = bounds_of(mechanism, trajectory, joints, errors)
    if not len(trajectory):
        return bounds
    short = np.maximum(_drifted(mechanism, trajectory, bounds), _fallen(mechanism, trajectory, bounds))
    if not (short > 1).any():
        return bounds
    return bounds_of(mechanism, trajectory, joints, {name: values * np.maximum(short, 1.0) for name, values in errors.items()})


def _drifted(mechanism: Mechanism, trajectory: Trajectory, bounds: Bounds) -> Array:
    """Return the largest drift (n,) of the energy so far, in units of the allowed drift; zero if energy is not conserved."""
    if not mechanism.conserves:
        return np.zeros(len(trajectory))
    seen = observables.observe(mechanism, trajectory)
    start = observables.observe(mechanism, kinematics.initial(mechanism)).total_energy[0]
    weights = observables.masses(mechanism)[:, None] * mechanism.gravity * np.abs(trajectory.position[..., 2])
    terms = seen.kinetic_energy + np.abs(seen.potential_energy) + weights.sum(axis=0)
    allowed = bounds.energy_error + OBSERVED_ROUNDINGS * EPS * np.maximum.accumulate(terms)
    return _largest_ratio(np.abs(seen.total_energy - start), allowed)


def _fallen(mechanism: Mechanism, trajectory: Trajectory, bounds: Bounds) -> Array:
    """Return the largest distance (n,) so far of floating trees from their parabolas, in units of the bound of positions."""
    largest = np.zeros(len(trajectory))
    masses = observables.masses(mechanism)
    for tree in floating(mechanism, trajectory.t):
        bodies = list(tree.bodies)
        places = trajectory.position[bodies]
        mean = (masses[bodies, None, None] * places).sum(axis=0) / masses[bodies].sum()
        off = np.linalg.norm((mean - tree.centre).astype(float), axis=1)
        rounding = OBSERVED_ROUNDINGS * EPS * np.maximum.accumulate(np.linalg.norm(places, axis=2).max(axis=0))
        largest = np.maximum(largest, _largest_ratio(off, bounds.position_error + rounding))
    return largest


def _largest_ratio(values: Array, allowed: Array) -> Array:
    """The largest ratios (n,) so far of values to allowed values; zero where the allowed value is zero."""
    return np.asarray(np.maximum.accumulate(values / np.where(allowed > 0, allowed, np.inf)))
