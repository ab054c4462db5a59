"""Figures of mechanisms: errors of joint coordinates, gaps of joints and loops, and drifts of conserved momenta."""

from collections.abc import Callable, Iterator

import numpy as np

from bodycheck.figures.definition import AnyObservables, Comparison, Exact, Figure
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.observables import MechanismObservables, floats, masses
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import distance

#: An angular momentum below this fraction of the largest possible is due to rounding of zero.
ROUNDED = 1e-12


def joint_position_error(mechanism: Mechanism, compared: Comparison) -> Array | None:
    """Return the largest difference (n,), rad, between joint angles of run and truth; None if no joint has an angle.

    For a ball or a free joint, the difference is the angle of the single rotation between the two attitudes.
    """
    angles = [np.abs(one - other) for one, other in _pairs(mechanism, compared, "a")]
    turns = [geodesic_angle(one, other)[:, None] for one, other in _pairs(mechanism, compared, "q")]
    return _largest([*angles, *turns])


def joint_slide_error(mechanism: Mechanism, compared: Comparison) -> Array | None:
    """Return the largest distance (n,), m, between joint displacements of run and truth; None if no joint has any."""
    return _largest([distance(one, other)[:, None] for one, other in _pairs(mechanism, compared, "l")])


def constraint_error(mechanism: Mechanism, compared: Comparison) -> Array | None:
    """Return the largest gap (n,), m, of the joints and loops; None if there are neither."""
    return kinematics.gaps(mechanism, compared.trajectory) if mechanism.joints or mechanism.loops else None


def limit_violation(mechanism: Mechanism, compared: Comparison) -> Array | None:
    """Return the largest distance (n,), rad or m, of a joint beyond its stops; None if no joint has any."""
    seen, _ = compared.joints
    beyond = []
    for joint, (of_joint, _) in zip(mechanism.joints, places(mechanism), strict=True):
        if joint.stops is not None:
            lower, upper = joint.stops.lower, joint.stops.upper
            if lower is not None:
                beyond.append(lower - seen[:, of_joint])
            if upper is not None:
                beyond.append(seen[:, of_joint] - upper)
    largest = _largest(beyond)
    return None if largest is None else np.maximum(largest, 0.0)


def momentum_drift(compared: Comparison) -> Array | None:
    """Return the relative distance (n,) of the momenta from their initial values; None if no momentum is conserved."""
    mechanism, seen, expected = compared.mechanism, compared.seen, compared.expected
    if mechanism is None or not floats(mechanism):
        return None
    assert isinstance(seen, MechanismObservables)
    size = angular_momentum_size(mechanism, compared.truth, expected)
    drift = distance(seen.angular_momentum, seen.angular_momentum[:1]) / size
    if mechanism.gravity:
        return drift
    return np.maximum(drift, distance(seen.momentum, seen.momentum[:1]) / momentum_size(mechanism, compared.truth.trajectory))


def momentum_size(mechanism: Mechanism, exact: Trajectory) -> float:
    """Return the size (kg m/s) to which linear momenta are relative: the total mass times the largest speed of a body.

    It is 1 kg m/s if nothing moves.
    """
    return float(masses(mechanism).sum() * np.linalg.norm(exact.velocity, axis=-1).max()) or 1.0


def angular_momentum_size(mechanism: Mechanism, truth: Exact, expected: AnyObservables) -> float:
    """Return the size (kg m^2/s) to which angular momenta about the centre of mass are relative, from the truth.

    It is the initial angular momentum or, if that is zero up to rounding or up to its bound, the angular momentum of the total
    mass that moves with the largest kinetic energy at the largest distance of a body from the centre; 1 kg m^2/s if that is
    zero too.
    """
    mass, exact = masses(mechanism)[:, None, None], truth.trajectory
    centre = (mass * exact.position).sum(axis=0) / mass.sum()
    reach = np.linalg.norm(exact.position - centre, axis=-1).max()
    most = float(np.sqrt(2 * expected.kinetic_energy.max() * mass.sum()) * reach)
    initial = float(np.linalg.norm(expected.angular_momentum[0]))
    nothing = initial <= ROUNDED * most or initial <= truth.bounds.angular_momentum_error[0]
    return (most if nothing else initial) or 1.0


def _pairs(mechanism: Mechanism, compared: Comparison, letter: str) -> Iterator[tuple[Array, Array]]:
    """Yield for each joint its coordinates (n, k), in the run and in the truth, of a kind in `joint_types.LETTERS`."""
    if not any(letter in joint.form.coordinates for joint in mechanism.joints):
        return
    one, other = compared.joints
    for joint, (of_joint, _) in zip(mechanism.joints, places(mechanism), strict=True):
        if letter in joint.form.coordinates:
            columns = joint.form.columns(letter)
            yield one[:, of_joint][:, columns], other[:, of_joint][:, columns]


def _largest(columns: list[Array]) -> Array | None:
    return np.asarray(np.hstack(columns).max(axis=1)) if columns else None


Compute = Callable[[Mechanism, Comparison], Array | None]


def _of_mechanisms(compute: Compute) -> Callable[[Comparison], Array | None]:
    """Return a function that computes a figure of mechanisms, and returns None for other scenes."""

    def computed(compared: Comparison) -> Array | None:
        mechanism = compared.mechanism
        return None if mechanism is None else compute(mechanism, compared)

    return computed


FIGURES = (
    Figure(
        name="joint_position_error",
        title="Joint position error",
        meaning="difference between the angle of a joint and the exact angle; that of a ball is the angle of one rotation",
        unit="rad",
        largest=True,
        remark="of a mechanism",
        compute=_of_mechanisms(joint_position_error),
        scale=lambda scales: scales.angle,
        bounded_by="truth_error",
        plotted=True,
    ),
    Figure(
        name="joint_slide_error",
        title="Joint slide error",
        meaning="distance of the displacement of a joint from the exact displacement",
        unit="m",
        largest=True,
        remark="of a mechanism",
        compute=_of_mechanisms(joint_slide_error),
        scale=lambda scales: scales.length,
        bounded_by="truth_position_error",
        plotted=True,
    ),
    Figure(
        name="constraint_error",
        title="Constraint error",
        meaning="distance by which the bodies of a joint, or the points of a loop, have come apart",
        unit="m",
        largest=True,
        remark="of a mechanism",
        compute=_of_mechanisms(constraint_error),
        scale=lambda scales: scales.length,
        plotted=True,
    ),
    Figure(
        name="momentum_drift",
        title="Momentum drift",
        meaning=(
            "change of the linear momentum, or of the angular momentum about the common centre of mass, relative to its size"
        ),
        largest=True,
        remark="of a mechanism that nothing holds to the world; the linear momentum counts without gravity",
        compute=momentum_drift,
        scale=lambda scales: scales.angular_momentum,
        bounded_by="truth_angular_momentum_error",
        plotted=True,
    ),
    Figure(
        name="limit_violation",
        title="Limit violation",
        meaning="angle or distance by which a joint is beyond its stop; elastic stops give way in the exact motion too",
        unit="rad or m",
        largest=True,
        remark="of a mechanism with limits",
        compute=_of_mechanisms(limit_violation),
        scale=lambda scales: max(scales.angle, scales.length),
        plotted=True,
    ),
)
