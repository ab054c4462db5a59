"""The truths of members: their stored columns, and their comparison with witnesses.

The truth of every member has its a-priori bounds. Witnesses, which cost far more, are computed for every thousandth member and
for the worst ones.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bodycheck.casefile.case import Case, parse_stored
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.flight.flights import Flights, flights
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import computed, truth
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.reference.witness import as_way, distances, excess
from bodycheck.running.instants import sampling_times
from bodycheck.running.members.chunk_files import BOUND_COLUMNS
from bodycheck.running.members.chunk_workers import Role
from bodycheck.studies.ensemble.drawing import members

#: The interval between members whose truths are compared with witnesses.
VOUCHED = 1000

#: A tumbling body, whose truth is computed so that all libraries are imported.
TUMBLING = Scene(Body(1.0, (1.0, 2.0, 2.5)), State(angular_velocity=(0.1, 1.0, 0.1)))


@dataclass(frozen=True)
class Vouching:
    """The question for the truth of a member, compared with witnesses.

    Attributes
    ----------
    case
        The text of the case of the ensemble.
    drawn
        The drawn numbers of the member, by the names of their columns.
    member, sampling
        The member, and the sampling of its runs.
    """

    case: str
    drawn: Mapping[str, float]
    member: int
    sampling: float


def of_case(case: Case, sampling: float) -> Truth | NoTruth:
    """Return the truth of a case for runs with a sampling, with its a-priori bounds, or the reason why there is none."""
    try:
        return truth(case.scene, sampling_times(case.instants, sampling), vouched=False)
    except (NotModelled, OutOfReach) as error:
        return NoTruth(str(error))


def columns(
    case: Case, drawn: Mapping[str, Array], block: range, sampling: float, block_truths: Flights | tuple[Truth | NoTruth, ...]
) -> dict[str, Any]:
    """Return the stored columns (m,) of the truths of a block, by name.

    Parameters
    ----------
    case
        The case of the ensemble.
    drawn
        The drawn numbers (m,) of the members, by the names of their columns.
    block, sampling
        The members, and the sampling of their runs.
    block_truths
        The truths of the members.
    """
    by_name = _of_flights(block_truths) if isinstance(block_truths, Flights) else _of_cases(block_truths)
    by_name |= {"witnessed": np.zeros(len(block), dtype=bool), "witness_difference": np.full(len(block), np.nan)}
    for index, member in enumerate(block):
        if member % VOUCHED == 0:
            numbers = {name: float(values[index]) for name, values in drawn.items()}
            for name, value in _vouched(case, numbers, member, sampling).items():
                by_name[name][index] = value
    return by_name


def prepare(group: None) -> None:
    """Import what witnesses need, and let their libraries start their threads."""
    computed(TUMBLING, np.array([0.0, 0.1]))


def vouch(question: Vouching) -> dict[str, Any]:
    """Return the columns of the truth of a member that a comparison with witnesses changes."""
    return _vouched(parse_stored(question.case, "the case"), question.drawn, question.member, question.sampling)


def _of_flights(block_truths: Flights) -> dict[str, Any]:
    return {
        "model": np.array([f"closed form: {form}" for form in block_truths.forms], dtype=object),
        "reason": np.full(len(block_truths.forms), "", dtype=object),
        **{column: getattr(block_truths.bounds, name).max(axis=-1) for name, column in zip(NAMES, BOUND_COLUMNS, strict=True)},
    }


def _of_cases(block_truths: tuple[Truth | NoTruth, ...]) -> dict[str, Any]:
    def largest(one: Truth | NoTruth, name: str) -> float:
        return np.nan if isinstance(one, NoTruth) else float(getattr(one.bounds, name).max())

    return {
        "model": np.array(["" if isinstance(one, NoTruth) else one.model for one in block_truths], dtype=object),
        "reason": np.array([one.reason if isinstance(one, NoTruth) else "" for one in block_truths], dtype=object),
        **{
            column: np.array([largest(one, name) for one in block_truths])
            for name, column in zip(NAMES, BOUND_COLUMNS, strict=True)
        },
    }


def _vouched(case: Case, drawn: Mapping[str, float], member: int, sampling: float) -> dict[str, Any]:
    """Return the columns that a comparison of a member's truth with witnesses changes; none if there is no truth.

    The compared motion is the motion with which runs of the ensemble are compared. The witnesses start from the member as its
    case file would state it.
    """
    columns = {name: np.array([value]) for name, value in drawn.items()}
    scenes = members.scenes(case, members.of_columns(case, columns), member)
    scene = scenes.like if isinstance(scenes, Scenes) else scenes[0].scene
    instants = sampling_times((case if isinstance(scenes, Scenes) else scenes[0]).instants, sampling)
    try:
        if isinstance(scene, Mechanism):
            return _vouched_mechanism(scene, instants)
        computed_truth = computed(scene, instants)
    except (NotModelled, OutOfReach):
        return {}
    motion, bounds = (
        _first(flights(scenes, instants))
        if isinstance(scenes, Scenes)
        else (computed_truth.truth.trajectory, computed_truth.own_bounds)
    )
    way, whole, apart = as_way("", motion, bounds), bounds, []
    for witness in computed_truth.witnesses:
        whole = whole.plus(excess(scene, motion, bounds, witness))
        apart += [float(difference.max()) for name, difference in distances(way, witness).items() if name == "error"]
    return {
        **{column: float(getattr(whole, name).max()) for name, column in zip(NAMES, BOUND_COLUMNS, strict=True)},
        "witnessed": True,
        "witness_difference": max(apart, default=np.nan),
    }


def _vouched_mechanism(mechanism: Mechanism, instants: Array) -> dict[str, Any]:
    """Return the columns of the truth of a mechanism, whose bounds are made with its witnesses."""
    bounds = truth(mechanism, instants).bounds
    largest = {column: float(getattr(bounds, name).max()) for name, column in zip(NAMES, BOUND_COLUMNS, strict=True)}
    return {**largest, "witnessed": True}


def _first(several: Flights) -> tuple[Trajectory, Bounds]:
    """Return the motion of the first of several scenes, with the bounds of its errors."""
    whole = several.trajectory
    states = (whole.position[0], whole.quaternion[0], whole.velocity[0], whole.angular_velocity[0])
    return Trajectory(whole.t, *states), Bounds(*(getattr(several.bounds, name)[0] for name in NAMES))


#: The role of worker processes that compare truths with witnesses.
VOUCHER = Role(vouch, prepare)
