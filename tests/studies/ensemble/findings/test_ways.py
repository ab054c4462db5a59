from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bodycheck.casefile.case import parse
from bodycheck.studies.ensemble.findings import stored, ways
from bodycheck.studies.ensemble.findings.ways import Way, chosen
from tests.support.cases import a_case, expecting

#: Errors of the attitude of 200 members with a method: 1 to 199 mrad, and none of the member that has diverged.
ERRORS = [member * 1e-3 for member in range(200)]
DIVERGED = 40


def chosen_of(folder: Path, errors: list[float], *expect: dict[str, Any]) -> dict[int, tuple[Way, tuple[Way, ...]]]:
    """The worst members, by their numbers."""
    count = len(errors)
    statuses = ["diverged" if member == DIVERGED else "ok" for member in range(count)]
    columns: dict[str, Any] = {
        "engine": ["mujoco"] * count,
        "version": ["4.0"] * count,
        "integrator": ["Euler"] * count,
        "timestep": [0.01] * count,
        "member": range(count),
        "status": statuses,
        "passed": pa.nulls(count, pa.bool_()),
        "attitude_error": [None if status != "ok" else error for status, error in zip(statuses, errors, strict=True)],
        "position_error": [0.0] * count,
        "mean_load": [1.0] * count,
    }
    for path, table in (("runs/mujoco/spin", columns), ("members/spin", {"member": range(count)})):
        (folder / path).mkdir(parents=True)
        pq.write_table(pa.table(table), folder / path / "part.parquet")
    found = chosen(parse(a_case(expect=expect), "spin"), stored.read(folder, "spin"))
    return {first.member: (first, others) for first, others in found}


def limited(**limits: Any) -> dict[str, Any]:
    return expecting("mujoco", "Euler", 0.01, **limits)


def test_the_largest_figure_has_to_stay_above_that_of_most_members(tmp_path: Path) -> None:
    found = chosen_of(tmp_path, ERRORS)
    assert list(found) == [DIVERGED, 199]  # and none for the figure that is zero, and the one that is not to be small
    way = found[199][0]
    assert (way.status, way.value, way.is_largest) == ("ok", 0.199, True)
    assert way.limit is not None
    assert (way.limit.name, way.limit.at_most) == ("attitude_error", 0.198)  # with two digits, 0.2, it would be above the value
    assert [way.shown("ok", {"attitude_error": value}) for value in (0.198, 0.1981)] == [False, True]
    assert not way.shown("diverged", {})
    assert not way.shown("ok", {})


def test_what_stands_out_has_to_stay_above_half_of_itself(tmp_path: Path) -> None:
    found = chosen_of(tmp_path, [*ERRORS[:-1], 2.5])
    limit = found[199][0].limit
    assert limit is not None
    assert limit.at_most == 1.3  # 1.25, with two digits


def test_a_status_counts_unless_the_case_expects_it(tmp_path: Path) -> None:
    way = chosen_of(tmp_path / "one", ERRORS)[DIVERGED][0]
    assert (way.status, way.expected, way.limit) == ("diverged", "ok", None)
    found = chosen_of(tmp_path / "other", ERRORS, limited(status="diverged"))
    assert DIVERGED not in found
    assert (found[0][0].status, found[0][0].expected) == ("ok", "diverged")


@pytest.mark.parametrize(
    ("limits", "member"),
    [({"attitude_error": 0.1}, 199), ({"attitude_error": {"at_least": 0.05, "at_most": 0.19}}, 0)],
)
def test_the_member_that_breaks_an_expectation_most_is_taken(tmp_path: Path, limits: dict[str, Any], member: int) -> None:
    found = chosen_of(tmp_path, ERRORS, limited(**limits))
    way, others = found[member]
    assert not way.is_largest
    assert (
        way.explanation == f"The case expects {parse(a_case(expect=[limited(**limits)]), '').expectations[0].limits[0].text}."
    )
    if member == 199:  # it has the largest value too, which its file says
        assert [other.is_largest for other in others] == [True]


def test_what_is_known_to_fail_is_no_way_of_failing(tmp_path: Path) -> None:
    known = limited(attitude_error=0.1, known="https://example.org", until="2100-01-01")
    assert chosen_of(tmp_path, ERRORS, known)[199][0].is_largest


def test_the_number_of_files_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ways, "MOST_FILES", 1)
    assert list(chosen_of(tmp_path, ERRORS)) == [DIVERGED]
