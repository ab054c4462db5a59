"""The certificate of a truth: a proof or a cross-check, and the contradictions that make it fail."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import Literal

import numpy as np

from bodycheck.reference.bounds import EPS, Bounds
from bodycheck.reference.mechanisms.coordinates import JointMotion, places
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.proof.enclosure import COORDINATES, Enclosure
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.reference.witness import Witness, event_distances

#: Name of the way that is the truth.
TRUTH_WAY = "truth"

#: How well a truth is known: it is proved, compared with other ways, or neither.
Word = Literal["enclosed", "cross-checked", "estimated"]

#: Bits of the mantissa that stay correct after rounding errors have grown along the motion: the error of the way is then below
#: 1e-20.
SPARE_BITS = 72

#: Sizes of the mantissa (bits) to choose from; the equations are compiled once for each size.
BITS = (128, 192, 256, 320)

#: The quantities in which ways are compared: the name of the bound, its unit, and the name of the quantity in messages.
COMPARED = (
    ("error", "rad", ""),
    ("angular_velocity_error", "rad/s", " in angular velocity"),
    ("position_error", "m", " in position"),
    ("velocity_error", "m/s", " in velocity"),
)

#: The quantities that a proof compares in addition, likewise.
CONSERVED = (("energy_error", "J", " in energy"), ("angular_momentum_error", "kg m^2/s", " in angular momentum"))


@dataclass(frozen=True, eq=False)
class Certificate:
    """A truth with the differences between all ways of computing it, at its n instants.

    Attributes
    ----------
    truth
        The truth.
    differences
        (n,) largest angles so far between the attitudes of two ways (rad), by the names of the two ways.
    bound
        (n,) measured bound of the attitude error of the truth (rad), never decreasing: its distance from the most accurate
        other way, plus that way's own error. It is not the bound that the truth prints.
    digits
        Decimal digits of the arithmetic of the most accurate other way; 0 if there is none.
    others
        Whether another way follows the motion.
    faults
        What contradicts the truth, one sentence each: pairs of ways that are farther apart than their own bounds allow, and
        printed bounds that are smaller than a proved distance.
    growth
        (n,) attitude error (rad) per unit of relative error made at the worst earlier moment; None where it is not known. See
        `integration.sensitivity`.
    enclosure
        The proof; None if there is none.
    not_enclosed
        Why there is no proof, as a noun phrase; empty if there is one, and before one was sought.
    """

    truth: Truth
    differences: dict[tuple[str, str], Array]
    bound: Array
    digits: int
    others: bool
    faults: tuple[str, ...]
    growth: Array | None
    enclosure: Enclosure | None = None
    not_enclosed: str = ""

    @property
    def certified(self) -> bool:
        """True if nothing contradicts the truth."""
        return not self.faults

    @property
    def word(self) -> Word:
        """The word that says how well the truth is known."""
        if self.enclosure is not None:
            return "enclosed"
        return "cross-checked" if self.others else "estimated"

    @property
    def distance(self) -> float:
        """The largest distance (rad) of the printed attitudes from the exact ones, proved, or measured by the other ways."""
        return float(self.bound[-1]) if self.enclosure is None else self.enclosure.distance


def contradiction(one: Witness, other: Witness, apart: dict[str, Array]) -> str | None:
    """Return in words by how much two ways differ if it is more than their own bounds allow, otherwise None.

    apart: the distances (n,) of the two ways, by the names of their bounds; see `witness.distances`.
    """
    for name, unit, what in COMPARED:
        if name not in apart:
            continue
        allowed = np.broadcast_to(getattr(one, name) + getattr(other, name), apart[name].shape)
        worst = int(np.argmax(np.where(np.isnan(allowed), -np.inf, apart[name] - allowed)))
        if apart[name][worst] > allowed[worst]:
            return (
                f"{one.name} and {other.name} are {apart[name][worst]:.2g} {unit} apart{what}, "
                f"their bounds allow {allowed[worst]:.2g}"
            )
    return None


def contradiction_of_events(one: Witness, other: Witness, last: float) -> str | None:
    """Return in words the first event of one way that the other does not have, otherwise None. last: the last instant (s)."""
    if one.events is None or other.events is None:
        return None
    for name, events, another, others in (
        (one.name, one.events, other.name, other.events),
        (other.name, other.events, one.name, one.events),
    ):
        for event, apart in zip(events, event_distances(events, others, last), strict=True):
            if apart:
                known = "does not have it" if math.isinf(apart) else f"has it {apart:.2g} s before or after"
                return f"{name} has the event {event.kind} at t = {event.time:.12g} s, {another} {known}"
    return None


def proved(certificate: Certificate, enclosure: Enclosure) -> Certificate:
    """Return a certificate with a proof, whose faults say where a printed bound is smaller than a proved distance."""
    truth = certificate.truth
    faults = (*certificate.faults, *_faults_of_figures(truth, enclosure), *_faults_of_events(truth, enclosure))
    return replace(certificate, enclosure=enclosure, faults=faults)


def _faults_of_figures(truth: Truth, enclosure: Enclosure) -> Iterator[str]:
    """Yield where a printed bound of states, energy, angular momentum or coordinates of joints is smaller than the distance."""
    printed = [(name, unit, what, getattr(truth.bounds, name)) for name, unit, what in (*COMPARED, *CONSERVED)]
    if COORDINATES[0] in enclosure.nearest:
        assert isinstance(truth.scene, Mechanism)
        assert truth.joints is not None  # the truth of a mechanism has joints
        of_joints = joint_bounds(truth.scene, truth.trajectory, truth.joints, truth.bounds)
        units = (("rad or m", " of a joint's coordinate"), ("rad/s or m/s", " of a joint's velocity"))
        printed += [(name, *words, bound) for name, words, bound in zip(COORDINATES, units, of_joints, strict=True)]
    for name, unit, what, bound in printed:
        proof = enclosure.nearest[name]
        excess = np.where(np.isnan(proof), -np.inf, proof - bound)
        if not excess.size or not excess.max() > 0:
            continue
        worst = np.unravel_index(int(np.argmax(excess)), excess.shape)
        yield (
            f"the printed bound of the error{what}, {np.broadcast_to(bound, proof.shape)[worst]:.2g} {unit} "
            f"at t = {truth.trajectory.t[worst[0]]:.6g} s, is smaller than the proved distance, {proof[worst]:.2g} {unit}"
        )


def _faults_of_events(truth: Truth, enclosure: Enclosure) -> Iterator[str]:
    """Yield where the events of a truth are not those of a proof, or farther from them than their printed bounds allow."""
    if enclosure.events is None:
        return
    last = truth.trajectory.t[-1] if enclosure.until is None else enclosure.until
    printed = [event for event in truth.events if event.time <= last]
    kinds = {(event.kind, event.body) for event in printed} | {(event.kind, event.body) for event in enclosure.events}
    for kind, body in sorted(kinds):
        events = [event for event in printed if (event.kind, event.body) == (kind, body)]
        proofs = [event for event in enclosure.events if (event.kind, event.body) == (kind, body)]
        for event, proof in zip_longest(events, proofs):
            if proof is None:
                yield f"the truth has the event {kind} at t = {event.time:.12g} s, the proof does not have it"
            elif event is None:
                if proof.end < last:
                    yield f"the proof has the event {kind} at t = {proof.begin:.12g} s, the truth does not have it"
            elif (apart := proof.distance(event.time)) > event.error:
                yield (
                    f"the printed bound of the instant of the event {kind} at t = {event.time:.12g} s, {event.error:.2g} s, "
                    f"is smaller than the proved distance, {apart:.2g} s"
                )
            else:
                continue
            break


def joint_bounds(mechanism: Mechanism, trajectory: Trajectory, joints: JointMotion, bounds: Bounds) -> tuple[Array, Array]:
    """Return bounds (n, c) and (n, u) of the errors of the coordinates of joints and of their velocities.

    The angle of a hinge is wrong by at most the errors of the attitudes of both its bodies, and the displacement of a slider by
    those of their positions and, where its parent turns, of the parent's attitude times their distance. The world has no error.
    The bounds include the rounding of the coordinate. They are infinite
    for types of joints other than hinges, sliders and balls.
    """
    position, velocity = EPS * np.abs(joints.position), EPS * np.abs(joints.velocity)
    for joint, (held, moving) in zip(mechanism.joints, places(mechanism), strict=True):
        for_position, for_velocity = _of(joint, trajectory, bounds)
        position[:, held] += for_position[:, None]
        velocity[:, moving] += for_velocity[:, None]
    return position, velocity


def _of(joint: Joint, trajectory: Trajectory, bounds: Bounds) -> tuple[Array, Array]:
    """Bounds (n,) of the errors of the coordinates of a joint and of their velocities, without rounding."""
    angle, place, speed, rate = bounds.error, bounds.position_error, bounds.velocity_error, bounds.angular_velocity_error
    if joint.type not in ("revolute", "prismatic", "spherical"):
        return np.full(len(angle), np.inf), np.full(len(angle), np.inf)
    turns = joint.type != "prismatic"
    if joint.parent == WORLD:
        return (angle, rate) if turns else (place, speed)
    parent, child = trajectory.body(joint.parent), trajectory.body(joint.child)
    spin = np.linalg.norm(parent.angular_velocity, axis=-1)
    if turns:
        return 2 * angle, 2 * rate + 2 * angle * spin
    apart = np.linalg.norm(child.position - parent.position, axis=-1)
    parting = np.linalg.norm(child.velocity - parent.velocity, axis=-1)
    return 2 * place + angle * apart, 2 * speed + rate * apart + spin * 2 * place + angle * (parting + spin * apart)
