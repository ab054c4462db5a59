"""Certificate of a truth: every applicable computation of one motion, compared with every other.

Here a way is one such computation: the truth itself, its witnesses, or an integration in arithmetic so wide that the growth of
its rounding errors stays far below what is certified.
"""

import contextlib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bodycheck.reference import truth
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.start import start
from bodycheck.reference.independent import closed_form as second_closed_form
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sliding import ways as slides
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import Truth
from bodycheck.reference.witness import Witness, as_way, distances
from bodycheck.reference.witnesses import FARTHEST_RAD, course, wide_witness

#: Name of the way that is the truth.
TRUTH_WAY = "truth"

#: Why a truth without another way is not certified.
NO_OTHER_WAY = "no other way follows this motion"

#: Bits of a mantissa that are left when rounding has grown along the motion: the error of the way is then below 1e-20.
SPARE_BITS = 72

#: Numbers of bits of a mantissa that are used, for each of which the equations are compiled once.
BITS = (128, 192, 256, 320)

#: The figures that ways are compared in: the name of a bound, its unit, and what differs, in words.
COMPARED = (
    ("error", "rad", ""),
    ("angular_velocity_error", "rad/s", " in angular velocity"),
    ("position_error", "m", " in position"),
    ("velocity_error", "m/s", " in velocity"),
)


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
        (n,) certified bound of the attitude error of the truth (rad), never decreasing: its distance from the most accurate
        other way, plus that way's own error. It is measured, and is not the bound that the truth prints.
    digits
        Decimal digits of the arithmetic of the most accurate other way; 0 if there is none.
    faults
        Why the truth is not certified, one sentence each: pairs of ways that are farther apart than their own bounds allow.
    growth
        (n,) attitude error (rad) per unit of relative error made at the worst earlier moment; None where it is not known. See
        `integration.sensitivity`.
    """

    truth: Truth
    differences: dict[tuple[str, str], Array]
    bound: Array
    digits: int
    faults: tuple[str, ...]
    growth: Array | None

    @property
    def certified(self) -> bool:
        """Whether no two ways contradict each other."""
        return not self.faults


def certify(scene: AnyScene, times: Array) -> Certificate:
    """The certificate of the truth of a scene, at ascending times (n,) >= 0, s. Raises as `truth.truth` does."""
    if touches(scene):
        alone = truth.computed(scene, times)
        return Certificate(alone.truth, {}, np.maximum.accumulate(alone.own.error), 0, (NO_OTHER_WAY,), None)
    if isinstance(scene, Mechanism):
        from bodycheck.reference.mechanisms.certificate import certify_mechanism  # which imports this module

        return certify_mechanism(scene, times)
    found = truth.computed(scene, times)
    own = as_way(TRUTH_WAY, found.truth.trajectory, found.own)
    ways = (own, *_other_ways(scene, times, found.witnesses))
    apart = {(one.name, other.name): distances(one, other) for one, other in combinations(ways, 2)}
    faults = [
        fault
        for one, other in combinations(ways, 2)
        if (fault := contradiction(one, other, apart[one.name, other.name])) is not None
    ]
    others = [way for way in ways[1:] if way.quaternion is not None]
    if others:
        best = min(others, key=lambda way: float(np.max(way.error)))
        bound = np.maximum.accumulate(apart[TRUTH_WAY, best.name]["error"] + best.error)
    else:
        bound = found.own.error
        faults.append(NO_OTHER_WAY)
    return Certificate(
        truth=found.truth,
        differences={pair: np.maximum.accumulate(each["error"]) for pair, each in apart.items() if "error" in each},
        bound=np.asarray(bound),
        digits=best.digits if others else 0,
        faults=tuple(faults),
        growth=_growth(scene, times),
    )


def _other_ways(scene: Scene, times: Array, witnesses: tuple[Witness, ...]) -> tuple[Witness, ...]:
    """Every way but the truth. Those of a slide include the integration that the truth is taken from, with its own bounds."""
    if scene.plane is not None:
        return slides.ways(scene, times)
    known = any(witness.name == second_closed_form.NAME for witness in witnesses)
    second = () if known else (second_closed_form.witness(scene, times),)
    return (*witnesses, *second, *_wide_way(scene, times))


def _wide_way(scene: Scene, times: Array) -> Iterator[Witness]:
    """The independent way in multiprecision that leaves digits for the growth of rounding, where it can follow the motion."""
    begin = start(scene)
    if not any(begin.rates):
        return
    growth = float(np.max(course(begin, times).growth, initial=1.0))
    needed = SPARE_BITS + math.log2(growth) if growth < math.inf else math.inf
    bits = next((bits for bits in BITS if bits >= needed), None)
    with contextlib.suppress(OutOfReach, ImportError):
        if bits is not None:
            yield wide_witness(scene, times, bits)


def _growth(scene: Scene, times: Array) -> Array | None:
    """The growth of an error along a flight, where heyoka is installed and the motion is not too long to be integrated."""
    try:
        from bodycheck.reference.integration import sensitivity
    except ImportError:
        return None
    turning = math.hypot(*scene.initial.angular_velocity) * float(np.max(times, initial=0.0))
    return sensitivity.growth(scene, times).of_any if scene.plane is None and turning <= FARTHEST_RAD else None


def contradiction(one: Witness, other: Witness, apart: dict[str, Array]) -> str | None:
    """By how much two ways differ more than their own bounds allow, in words, or None where they do not."""
    for name, unit, what in COMPARED:
        if name not in apart:
            continue
        allowed = np.broadcast_to(getattr(one, name) + getattr(other, name), apart[name].shape)
        worst = int(np.argmax(apart[name] - allowed))
        if apart[name][worst] > allowed[worst]:
            return (
                f"{one.name} and {other.name} are {apart[name][worst]:.2g} {unit} apart{what}, "
                f"their bounds allow {allowed[worst]:.2g}"
            )
    return None
