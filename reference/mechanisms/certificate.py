"""The cross-check of the truth of a mechanism: its ways, compared with one another and with arithmetic of more digits.

The ways are the truth, the recursion if the truth is a closed form, the Lagrangian, and the recursion in arithmetic so wide
that its rounding errors, with their growth, stay far below the error that is to be measured. This last way has the equations of
the recursion: it measures rounding, and only the Lagrangian checks the equations.
"""

import contextlib
import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from bodycheck.reference.certified import BITS, SPARE_BITS, TRUTH_WAY, Certificate, contradiction
from bodycheck.reference.errors import NotModelled, OutOfReach, within_range
from bodycheck.reference.integration.rotation import WideArray
from bodycheck.reference.mechanisms import recursion
from bodycheck.reference.mechanisms.followed import (
    RECURSION,
    Followed,
    arithmetic,
    followed,
    growth_instants,
    growth_with_loops,
    with_doubts,
)
from bodycheck.reference.mechanisms.growth import FEWEST_ROUNDINGS, Growth, rounding_errors
from bodycheck.reference.mechanisms.lagrangian import solution
from bodycheck.reference.mechanisms.loops import ways as loops
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.modelled import require_modelled
from bodycheck.reference.mechanisms.truth import joined, printed
from bodycheck.reference.mechanisms.ways import Motion, Way, apart, sizes
from bodycheck.reference.mechanisms.witnesses import errors_of_witness, lagrangian, roundings_of_lagrangian, witness_of
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.witness import Witness

#: Relative error that the witness of a mechanism with loops may have in addition to the error of the way, from its tolerance.
LOOPS_TOLERANCE = 1e-12


def certify_mechanism(mechanism: Mechanism, times: Array) -> Certificate:
    """The cross-check of the truth of a mechanism at ascending times (n,) >= 0, s. Raises what `mechanism_truth` raises."""
    times = np.asarray(times, dtype=float)
    with within_range("the motion"):
        course = followed(mechanism, times)
        witness = witness_of(mechanism, times, course)
        truth = joined(mechanism, times, course, witness).truth
        rounded = printed(mechanism, times, course)
        assert truth.joints is not None  # the truth of a mechanism always has joints
        stated = Motion(truth.joints.position, truth.joints.velocity, truth.trajectory)
        ways = [Way(TRUTH_WAY, stated, rounded.bounds.of_states()), *_other_ways(mechanism, times, course, witness)]
        differences = {
            (one.name, other.name): apart(mechanism, one.motion, other.motion) for one, other in combinations(ways, 2)
        }
    stated_ways = combinations((Witness(way.name, **way.errors, digits=way.digits, events=None) for way in ways), 2)
    faults = [fault for one, other in stated_ways if (fault := contradiction(one, other, differences[one.name, other.name]))]
    best = min(ways[1:], key=lambda way: float(np.max(way.errors["error"], initial=0.0)), default=None)
    if best is None:
        bound = rounded.bounds.error
    else:
        bound = np.maximum.accumulate(differences[TRUTH_WAY, best.name]["error"] + best.errors["error"])
    return Certificate(
        truth=truth,
        differences={pair: np.maximum.accumulate(each["error"]) for pair, each in differences.items()},
        bound=bound,
        digits=0 if best is None else best.digits,
        others=best is not None,
        faults=tuple(faults),
        growth=truth.growth,
    )


def _other_ways(mechanism: Mechanism, times: Array, course: Followed, witness: Way | None) -> Iterator[Way]:
    """Every way except the truth's, with bounds of its errors. witness: the truth's witness."""
    grown = course.growth
    if mechanism.loops and witness is not None:
        yield from _ways_with_loops(mechanism, times, course, witness)
    if mechanism.loops or grown is None:
        return
    if course.form and witness is not None:
        yield witness
    if (way := lagrangian(mechanism, times) if course.form else witness) is not None:
        yield replace(way, errors=errors_of_witness(mechanism, times, course, way))
    yield from _wide_way(mechanism, times, grown)


def _ways_with_loops(mechanism: Mechanism, times: Array, course: Followed, witness: Way) -> Iterator[Way]:
    """The witness of a mechanism with loops and, if it is the Lagrangian, the equations of all bodies if they can follow it."""
    grown = growth_with_loops(mechanism, growth_instants(times))
    if grown is None or course.growth is None or not witness.name.startswith(solution.NAME):
        yield replace(witness, errors=_errors_with_loops(mechanism, course, witness))
        return
    count = roundings_of_lagrangian(mechanism, times, grown)
    rounding = rounding_errors(mechanism, witness.motion, course.growth, count, float(np.finfo(arithmetic()[0]).eps))
    yield replace(witness, errors={name: course.way.errors[name] + rounding[name] for name in rounding})
    with contextlib.suppress(OutOfReach, NotModelled):
        bodies = loops.witness(mechanism, times)
        yield replace(bodies, errors=_errors_with_loops(mechanism, course, bodies))


def _errors_with_loops(mechanism: Mechanism, course: Followed, way: Way) -> dict[str, Array]:
    """Errors (n,) of a witness with loops by collocation: the errors of the truth's way, plus the tolerance of the witness."""
    largest = sizes(mechanism, way.motion)
    return {name: course.way.errors[name] + LOOPS_TOLERANCE * (1 + np.maximum.accumulate(largest[name])) for name in largest}


def _wide_way(mechanism: Mechanism, times: Array, grown: Growth) -> Iterator[Way]:
    """The recursion in multiprecision with spare digits for the growth of rounding errors, if it can follow the motion."""
    needed = SPARE_BITS + math.log2(float(np.max(grown.of_any, initial=1.0)))
    bits = next((bits for bits in BITS if bits >= needed), None)
    with contextlib.suppress(OutOfReach, NotModelled, ImportError):
        import heyoka as hy

        require_modelled(mechanism)
        if bits is not None:
            states = recursion.follow(mechanism, times, hy.real, bits)
            bodies = states.bodies
            parts = (bodies.position, bodies.quaternion, bodies.velocity, bodies.angular_velocity)
            states = replace(
                states,
                position=rounded_to_wide(states.position),
                velocity=rounded_to_wide(states.velocity),
                bodies=Trajectory(times, *(rounded_to_wide(each) for each in parts)),
            )
            motion = Motion(states.position, states.velocity, states.bodies)
            stored = rounding_errors(mechanism, motion, grown, 0.0, float(np.finfo(np.longdouble).eps))
            integrated = with_doubts(mechanism, states, grown, FEWEST_ROUNDINGS, 2.0 ** (1 - bits))
            errors = {name: stored[name] + integrated[name] for name in stored}
            yield Way(f"{RECURSION}, heyoka-{bits}-bit", motion, errors, math.floor(bits * math.log10(2)))


def rounded_to_wide(values: WideArray) -> WideArray:
    """Multiprecision numbers, rounded to the widest type of NumPy."""
    head: Any = values.astype(float)
    return np.asarray(head.astype(np.longdouble) + (values - head).astype(float))
