"""What counts as a change: beyond measured allowances, or beyond an estimate of rounding; chaotic and lost motions are calm."""

from collections.abc import Sequence
from typing import Any

import pytest

from bodycheck.site import cells, changes
from bodycheck.site.changes import Change
from bodycheck.site.submissions.submission import Row
from tests.site import submissions as make

#: Roundings of 5000 steps in double precision, of numbers of the size 1, as `changes.RULE` has it.
ROUNDING = 16 * 5000 * 2.0**-53


def changed(before: float, after: float, case: str = make.FREE, study: Sequence[Row] = (), **told: Any) -> Change | None:
    """What is said of two runs of RK4 in two releases with these attitude errors."""
    runs = [
        make.run(case=case, version=version, integrator="RK4", attitude_error=error)
        for version, error in (("1.0", before), ("2.0", after))
    ]
    sent = [make.submission([run], day=f"2026-01-0{day}", **told) for day, run in enumerate(runs, start=1)]
    if study:
        sent.append(make.submission({"releases.csv": study}, day="2026-01-03"))
    catalogue = make.catalogued(*sent)
    scene = catalogue.scenes[case]
    found = list(changes.since(catalogue, scene, [run for run in scene.runs if run.version == "2.0"]))
    assert len(found) <= 1
    return found[0] if found else None


@pytest.mark.parametrize(
    ("before", "after", "why"),
    [
        (0.1, 0.1009, "less than 1 %"),
        (1e-11, 2e-11 + ROUNDING / 2, "the difference is what the roundings of the steps may add up to"),
        (1e-9, 9e-9, "grown along the motion, rounding may be all of both, and they are no factor of 10 apart"),
        (0.6, 3.0, "an attitude that is lost has no digits, and these are no factor of 10 apart"),
        (3e-11, 1e-10, "below the truth's own bound"),
    ],
)
def test_nothing_is_said_of_what_rounding_explains(before: float, after: float, why: str) -> None:
    assert changed(before, after) is None, why


@pytest.mark.parametrize(
    ("before", "after"),
    [(0.1, 0.102), (1e-5, 1.02e-5), (1e-11, 1e-9), (3.0, 0.2), (1e-4, 5e-9)],
)
def test_a_difference_beyond_is_said_in_both_directions(before: float, after: float) -> None:
    forward, backward = changed(before, after), changed(after, before)
    assert forward is not None
    assert backward is not None
    assert forward.worse is (after > before)
    assert backward.worse is not forward.worse
    assert forward.factor == backward.factor == max(before, after) / min(before, after)


def test_chaotic_cases_change_by_a_factor_of_ten_alone() -> None:
    assert changed(0.01, 0.09, case=make.MECHANISM) is None
    assert changed(0.01, 0.09) is not None, "the same numbers in a case that is not chaotic"
    assert changed(0.01, 0.11, case=make.MECHANISM) is not None


def test_in_single_precision_rounding_is_larger() -> None:
    single = {"precisions": {"mujoco": "float32"}}
    assert changed(0.1, 0.2, **single) is None
    assert changed(0.1, 0.2) is not None
    assert changed(0.01, 0.2, **single) is not None


def test_measured_allowances_count_before_any_estimate() -> None:
    def allowances(each: float) -> Sequence[Row]:
        told = {"integrator": "RK4", "attitude_error": 0.1, "attitude_error_allowance": each}
        return [make.release(version, **told) for version in ("1.0", "2.0")]

    assert changed(0.1, 0.15, study=allowances(0.026)) is None, "the sum of both allowances is larger than the difference"
    assert changed(0.1, 0.15, study=allowances(0.024)) is not None
    assert changed(0.1, 0.1 + 1e-6, study=allowances(1e-9)) is not None, "less than 1 %, but measured"
    assert changed(0.1, 0.15, study=allowances(0.026)[:1]) is not None, "one alone says nothing"


def test_a_status_is_a_change_and_two_ways_to_fail_are_neither_better_nor_worse() -> None:
    rows = [make.run(version="1.0"), make.ended("diverged", version="2.0"), make.ended("crashed", version="3.0")]
    sent = [make.submission([row], day=f"2026-01-0{day}") for day, row in enumerate(rows, start=1)]
    catalogue = make.catalogued(*sent)
    scene = catalogue.scenes[make.FREE]
    first, second = (list(changes.since(catalogue, scene, [run])) for run in scene.runs[1:])
    assert [(one.quantity, one.worse) for one in (*first, *second)] == [("status", True), ("status", None)]


def test_runs_of_another_time_step_or_of_the_same_submission_are_not_before() -> None:
    later = [make.run(version="2.0"), make.run(engine="mujoco@1.0", version="1.0", attitude_error=1.0)]
    catalogue = make.catalogued(
        make.submission([make.run(version="1.0", timestep=0.001)], day="2026-01-01"), make.submission(later, day="2026-01-02")
    )
    assert cells.cell(catalogue, "mujoco", catalogue.scenes[make.FREE]).changes == ()


def test_nearly_nothing_that_becomes_little_is_not_the_most_severe_change() -> None:
    tiny, large = changed(1e-16, 1e-10 + ROUNDING * 10), changed(1e-4, 1e-2)
    assert tiny is not None
    assert large is not None
    assert tiny.factor is not None
    assert large.factor is not None
    assert tiny.factor > large.factor
    assert tiny.severity < large.severity
