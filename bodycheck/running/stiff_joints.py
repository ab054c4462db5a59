"""Explain the failure of a run of a mechanism by joints that are too stiff for its time step.

A force that grows with the velocity or the displacement of a joint limits the steps of explicit schemes: on x' = -c x they are
stable up to h c = 2 (Euler) or 2.785 (Runge-Kutta 4), and on x'' = -w^2 x up to h w = 2 (semi-implicit Euler) or 2.828
(Runge-Kutta 4; Hairer, Wanner, Solving Ordinary Differential Equations II, section IV.2). Dry friction is bounded, but an
explicit step may turn a hinge so far that its next force is that of another motion. The gains kd and kp of a continuous
controller without a limit of its effort act as damping and stiffness.

The inertia of a joint is that at the start with everything else loose: 1 / (M^-1)_ii with the mass matrix M. With several
damped joints, the largest c of the mechanism, an eigenvalue of M^-1 D, is at least the c of each joint, so that a joint beyond
the limit is a sufficient reason.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms import mimicry
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.results.outcome import Diverged

#: The largest h c and h w at which schemes are stable, by whether they are of order 4.
OF_DAMPING, OF_SPRINGS = {False: 2.0, True: 2.785}, {False: 2.0, True: 2.828}

#: The largest turn (rad) that dry friction may cause in a step.
OF_FRICTION = 1.0


@dataclass(frozen=True)
class _Stiff:
    """A joint that is beyond a limit of explicit schemes.

    Attributes
    ----------
    text
        The number that is beyond the limit, in words.
    excess
        The factor by which the time step is too long.
    """

    text: str
    excess: float


def explained(failure: Diverged, scene: AnyScene, method: Method, order: int | None) -> Diverged:
    """Return the outcome of a failed run, with the joint in its reason that is stiffest for the time step, if there is one.

    order: the order of the integrator; None if it is not known. Nothing is added for methods that choose their own steps, for
    single bodies, and for mechanisms with loops, which may hold what is stiff.
    """
    if not isinstance(scene, Mechanism) or scene.loops or method.accuracy is not None:
        return failure
    stiff = sorted(_stiff(scene, method.timestep, order == 4), key=lambda joint: -joint.excess)
    if not stiff:
        return failure
    others = f" (and {len(stiff) - 1} more)" if len(stiff) > 1 else ""
    needed = f"an explicit step needs h < {method.timestep / stiff[0].excess:.2g} s"
    return replace(failure, reason=f"{failure.reason}; {stiff[0].text}: {needed}{others}")


def _stiff(mechanism: Mechanism, step: float, fourth_order: bool) -> Iterator[_Stiff]:
    """Yield the joints that are beyond a limit of explicit schemes with a time step (s), once for each such limit."""
    joints, rules = mechanism.joints, [mimicry.rule(mechanism.joints, index) for index in range(len(mechanism.joints))]
    gains = {law.joint: law for law in mechanism.controllers if law.rate is None and law.effort_limit is None}
    dampings = [joint.damping + (gains[n].kd if n in gains else 0.0) for n, joint in enumerate(joints)]
    stiffnesses = [joint.stiffness + (gains[n].kp if n in gains else 0.0) for n, joint in enumerate(joints)]
    for index, inertia in _inertias(mechanism):
        moved = [(n, float(rule.multiplier)) for n, rule in enumerate(rules) if rule.leader == index]
        name = joints[index].name
        kd = " + kd" if any(n in gains and gains[n].kd for n, _ in moved) else ""
        kp = " + kp" if any(n in gains and gains[n].kp for n, _ in moved) else ""
        damping = step / inertia * sum(ratio**2 * dampings[n] for n, ratio in moved)
        spring = step * math.sqrt(max(sum(ratio**2 * stiffnesses[n] for n, ratio in moved), 0.0) / inertia)
        friction = step**2 / inertia * sum(abs(ratio) * joints[n].friction for n, ratio in moved)
        if damping > (limit := OF_DAMPING[fourth_order]):
            yield _Stiff(f"{name}: {f'(damping{kd})' if kd else 'damping'} × h / inertia = {damping:.3g}", damping / limit)
        if spring > (limit := OF_SPRINGS[fourth_order]):
            yield _Stiff(f"{name}: h × √({f'(stiffness{kp})' if kp else 'stiffness'} / inertia) = {spring:.3g}", spring / limit)
        if joints[index].type == "revolute" and friction > OF_FRICTION:
            yield _Stiff(f"{name}: friction × h² / inertia = {friction:.3g} rad", math.sqrt(friction / OF_FRICTION))


def _inertias(mechanism: Mechanism) -> Iterator[tuple[int, float]]:
    """Yield the joints that follow no other, once for each velocity, with the inertia of the velocity (kg m^2 or kg)."""
    from bodycheck.reference.mechanisms import start  # exact arithmetic, which the process of an engine otherwise does not need

    moved, matrix = start.mass_matrix(mechanism)
    try:
        inverse = np.linalg.inv(matrix.astype(np.float64))
    except np.linalg.LinAlgError:
        return
    for (joint, _), reciprocal in zip(moved, np.diag(inverse), strict=True):
        if joint is not None and reciprocal > 0:
            yield joint, 1 / float(reciprocal)
