"""The cross-check of a truth: every applicable computation of one motion, compared with every other.

Here a way is one such computation: the truth itself, its witnesses, or an integration in arithmetic so wide that the growth of
its rounding errors stays far below the error that is to be measured.
"""

import contextlib
import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from bodycheck.reference import truth
from bodycheck.reference.certified import (
    BITS,
    SPARE_BITS,
    TRUTH_WAY,
    Certificate,
    contradiction,
    contradiction_of_events,
)
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.start import start
from bodycheck.reference.independent import closed_form as second_closed_form
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sliding import ways as slides
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Witness, as_way, distances
from bodycheck.reference.witnesses import FARTHEST_RAD, course, wide_witness


def certify(scene: AnyScene, times: Array) -> Certificate:
    """The cross-check of the truth of a scene, at ascending times (n,) >= 0, s. It raises as `truth.truth` does."""
    if isinstance(scene, Mechanism) and not touches(scene):
        from bodycheck.reference.mechanisms.certificate import certify_mechanism  # imported where it is needed

        return certify_mechanism(scene, times)
    computed = truth.computed(scene, times)
    truth_way = as_way(TRUTH_WAY, computed.truth.trajectory, computed.own_bounds, computed.own_events)
    ways = (truth_way, *_other_ways(scene, times, computed.witnesses))
    apart = {(one.name, other.name): distances(one, other) for one, other in combinations(ways, 2)}
    last = float(np.max(times, initial=0.0))
    faults = [
        fault
        for one, other in combinations(ways, 2)
        for fault in (contradiction(one, other, apart[one.name, other.name]), contradiction_of_events(one, other, last))
        if fault is not None
    ]
    others = [way for way in ways[1:] if way.quaternion is not None]
    if others:
        best = min(others, key=lambda way: float(np.nanmax(way.error)))
        bound = np.fmax.accumulate(apart[TRUTH_WAY, best.name]["error"] + best.error)
    else:
        bound = computed.own_bounds.error
    return Certificate(
        truth=computed.truth,
        differences={pair: np.maximum.accumulate(each["error"]) for pair, each in apart.items() if "error" in each},
        bound=np.asarray(bound),
        digits=best.digits if others else 0,
        others=bool(others),
        faults=tuple(faults),
        growth=_growth(scene, times),
    )


def _other_ways(scene: AnyScene, times: Array, witnesses: tuple[Witness, ...]) -> tuple[Witness, ...]:
    """Every way except the truth.

    For a slide, they include the integration that the truth is taken from, with its own bounds.
    """
    if touches(scene):
        return witnesses
    assert isinstance(scene, Scene)  # mechanisms whose bodies do not touch have a certificate of their own
    if scene.plane is not None:
        return slides.ways(scene, times)
    included = any(witness.name == second_closed_form.NAME for witness in witnesses)
    second = () if included else (second_closed_form.witness(scene, times),)
    return (*witnesses, *second, *_wide_way(scene, times))


def _wide_way(scene: Scene, times: Array) -> Iterator[Witness]:
    """Yield the independent way in multiprecision, with digits to spare for the growth of rounding, if it is possible."""
    begin = start(scene)
    if not any(begin.rates):
        return
    growth = float(np.max(course(begin, times).growth, initial=1.0))
    needed = SPARE_BITS + math.log2(growth) if growth < math.inf else math.inf
    bits = next((bits for bits in BITS if bits >= needed), None)
    with contextlib.suppress(OutOfReach, ImportError):
        if bits is not None:
            yield wide_witness(scene, times, bits)


def _growth(scene: AnyScene, times: Array) -> Array | None:
    """The growth of an error along a flight; None without heyoka, on a plane, or if the motion is too long."""
    try:
        from bodycheck.reference.integration import sensitivity
    except ImportError:
        return None
    if isinstance(scene, Mechanism) or scene.plane is not None:
        return None
    turning = math.hypot(*scene.initial.angular_velocity) * float(np.max(times, initial=0.0))
    return sensitivity.growth(scene, times).of_any if turning <= FARTHEST_RAD else None
