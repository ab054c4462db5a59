"""Coverage: what is measured of members, and the coverage and width that follow from it."""

from dataclasses import replace
from pathlib import Path

import pytest

from bodycheck.errors import BadInput
from bodycheck.results import journal
from bodycheck.running import campaign
from bodycheck.studies.estimate import calibration, factors
from bodycheck.studies.estimate.calibration import Portion, factor_of, interval, is_known, portions, printed, smallest
from bodycheck.studies.estimate.members import PAIRS, Measured, Member, measured

#: A run whose errors are 8, 4, 2 and 1 times 1e-6, and whose method has order 1.
ERRORS = (8e-6, 4e-6, 2e-6, 1e-6)
EVEN = Measured(
    "free-brick",
    "Euler",
    2e-3,
    "attitude_error",
    level=1,
    differences=tuple(ERRORS[coarse] - ERRORS[fine] for coarse, fine in PAIRS),
    nudge=2e-16,
    steps=(100, 200, 400, 800),
    claimed=1.0,
    error=ERRORS[1],
)


def test_the_interval_of_a_run_whose_error_falls_evenly_contains_the_error() -> None:
    for level, error in enumerate(ERRORS):
        ends = interval(replace(EVEN, level=level), 1.25)
        assert ends is not None
        assert ends.low <= error <= ends.high


def test_coverage_is_the_share_of_intervals_that_contain_the_error() -> None:
    wrong = replace(EVEN, error=2 * EVEN.error)
    seen = factor_of("MuJoCo", [EVEN, EVEN, EVEN, wrong, replace(EVEN, refused="chaotic")], 1.25)
    assert (seen.coverage, seen.sample, seen.refused) == (0.75, 4, 1)
    assert not replace(seen, coverage=0.94, width=1.0).holds("smooth")
    assert not replace(seen, coverage=0.96, width=2.1).holds("smooth")
    assert not replace(seen, sample=0, coverage=1.0).holds("smooth")
    assert replace(seen, coverage=0.96, width=1.9).holds("smooth")
    assert replace(seen, coverage=0.91, width=2.1).holds("impacts")


def test_the_smallest_factor_contains_the_errors_that_are_asked_for() -> None:
    late = replace(
        EVEN, level=3, error=1.9 * ERRORS[3]
    )  # of the finest run, whose interval ends at the factor times the estimate
    assert smallest("smooth", "MuJoCo", [EVEN] * 10).factor == calibration.TRIED[0]
    assert smallest("smooth", "MuJoCo", [late] * 10).factor == pytest.approx(1.9, abs=0.051)


def test_an_error_that_is_not_known_well_enough_does_not_count() -> None:
    assert is_known("smooth", EVEN)
    assert not is_known("smooth", replace(EVEN, bound=EVEN.error / 2))
    assert is_known("impacts", EVEN)
    # 200 x 64 steps of the finer run, in each of which half of 2e-16 may be added, are 1.3e-12.
    assert not is_known("impacts", replace(EVEN, error=1e-12))


def test_the_portions_contain_each_member_once_with_the_classes_in_turns() -> None:
    cut = portions("mujoco", 3, 60)
    for kind in factors.KINDS:
        assert [one.number for part in cut if part.kind == kind for one in part.members] == list(range(60))
    assert {part.kind for part in cut[: len(factors.KINDS)]} == set(factors.KINDS)


def test_a_member_is_the_same_each_time_and_its_interval_contains_its_error() -> None:
    member = Member("mujoco", "smooth", 5, 0)
    one = measured(member)
    assert one is not None
    assert one == measured(member)
    ends = interval(one, 2.0)
    assert ends is not None
    assert ends.low <= one.error <= ends.high


def test_what_a_folder_has_is_not_measured_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = portions("mujoco", 5, 1)
    head = campaign.header((), {}, {})
    key = calibration.identity(head, wanted)
    with journal.begin(tmp_path / calibration.RECORDS, {**head, "identity": key}) as log:
        for part in wanted:
            log.add(calibration.record(part, [replace(EVEN, case=part.kind)]))
    monkeypatch.setattr(calibration, "perform", None)  # nothing may be measured
    seen = calibration.samples(wanted, tmp_path, head, 1, True)
    assert {kind: [one.case for one in of_kind] for kind, of_kind in seen.items()} == {kind: [kind] for kind in factors.KINDS}


def test_a_number_of_members_that_is_not_positive_is_bad_input() -> None:
    with pytest.raises(BadInput, match="--members 0: must be at least 1"):
        printed((), 0, 3, 1, None, json=False, quiet=True)


def test_a_portion_measures_its_members() -> None:
    seen = calibration.perform(Portion("mujoco", "smooth", 5, 0, 2))
    assert [one.quantity for one in seen]
