"""The page of the study of releases: its sentences, its chart, and studies of several machines."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
import vl_convert

from bodycheck.errors import BadInput
from bodycheck.reports import html, markdown
from bodycheck.results.header import LATER
from bodycheck.studies.releases import rows as release_rows
from bodycheck.studies.releases.page import present
from bodycheck.studies.releases.rows import UNOBTAINABLE, Found
from tests.support import journals, pages
from tests.support.commands import call
from tests.support.release_rows import HEADER, change, failed, row, told
from tests.support.wording import facts

#: What a sentence may name.
NAMES = (
    *("RK4", "Euler", "implicit", "spin", "top", "status", "unsupported", "ok", "attitude error", "in attitude"),
    *("second", "fourth", "averaged Runge-Kutta 4", "Runge-Kutta-Munthe-Kaas 4"),
    *("semi-implicit Euler", "linearly implicit Euler"),
)

#: What is told of the change of `change()` before its numbers.
ORDER = ["1.0", "2.0", "RK4", "second", "fourth", "in attitude"]


def test_an_order_that_changed_is_told_in_words() -> None:
    (sentence,) = told([change(before=2.1e-5, after=3.3e-9)])
    assert facts(sentence, *NAMES) == [*ORDER, "attitude error", "2.1e-5", "3.3e-9", "spin", "1"]
    named = change(integrator="RK4", scheme_before="averaged Runge-Kutta 4", scheme_after="Runge-Kutta-Munthe-Kaas 4")
    assert facts(told([named])[0], *NAMES)[:8] == [*ORDER, "averaged Runge-Kutta 4", "Runge-Kutta-Munthe-Kaas 4"]


def test_a_change_without_another_order_is_told_by_its_scheme_or_its_figure() -> None:
    same = change(before=0.683, after=0.659, order_before=1.02, order_after=0.98, factor=1.04)
    (sentence,) = told([same])
    assert facts(sentence, *NAMES) == ["1.0", "2.0", "attitude error", "RK4", "0.683", "0.659", "spin", "1"]
    scheme = replace(same, scheme_before="semi-implicit Euler", scheme_after="linearly implicit Euler")
    (sentence,) = told([scheme])
    assert facts(sentence, *NAMES) == [
        *("1.0", "2.0", "RK4", "semi-implicit Euler", "linearly implicit Euler"),
        *("attitude error", "0.683", "0.659", "spin", "1"),
    ]
    close = change(before=0.1234567, after=0.1234568, order_before=None)
    assert "0.1234567 to 0.1234568 rad" in told([close])[0] or "0.123457 to 0.123457" not in told([close])[0]


def test_one_sentence_a_method_and_upgrade_with_what_says_most() -> None:
    more = [
        change(quantity="energy_drift", order_before=None, factor=1e9),
        change(),
        change(case="top", factor=2.0),
        change(case="top", factor=2.0, timestep=0.002),
    ]
    (sentence,) = told(more)
    assert facts(sentence, *NAMES) == [*ORDER, "attitude error", "2e-5", "3e-9", "spin", "1", "1"]
    later = change(from_version="2.0", to_version="10.0")
    first, second, third = told([later, change(), change(integrator="implicit"), change(integrator="Euler", after=4e-9)])
    changed = ["second", "fourth", "in attitude", "attitude error"]
    assert facts(first, *NAMES) == ["1.0", "2.0", "RK4", "implicit", *changed, "2e-5", "3e-9", "spin", "1"]
    assert facts(second, *NAMES) == ["1.0", "2.0", "Euler", *changed, "2e-5", "4e-9", "spin", "1"]
    assert facts(third, *NAMES)[:3] == ["2.0", "10.0", "RK4"]


def test_what_came_or_went_is_told_together() -> None:
    gone = change(quantity="status", before="unsupported", after="ok", factor=None, order_before=None, order_after=None)
    (sentence,) = told([gone, replace(gone, integrator="Euler"), replace(gone, case="top")])
    assert facts(sentence, *NAMES) == ["1.0", "2.0", "status", "RK4", "Euler", "unsupported", "ok", "spin", "1"]


def test_that_nothing_changed_is_told() -> None:
    (sentence,) = told([])
    assert facts(sentence, *NAMES, "agree", "rounding") == ["2", "2", "agree", "rounding"]
    assert not told([], [row("1.0")])


def test_what_could_not_be_measured_is_said_first() -> None:
    header = HEADER | {"unmeasured": {"2.0": "no wheel"}, "notices": ["no index"]}
    report = present({"": Found(header, (row("1.0"), failed("2.0", UNOBTAINABLE)), ())})
    assert report.notices == ("no index.", "2.0 was not measured: no wheel.")


def found_on(machine: str, error: float = 3e-9) -> Found:
    hostile = failed("3.0", "crashed", pages.HOSTILE)
    header = HEADER | {"machine": HEADER["machine"] | {"processor": machine}}
    return Found(header, (row("1.0", 2e-5), row("2.0", error), hostile), (change(after=error),))


@pytest.mark.parametrize("machines", [("abacus",), ("abacus", "slide rule"), ("abacus", "abacus")])
def test_the_report_of_one_machine_or_two(machines: tuple[str, ...]) -> None:
    found = [found_on(machine) for machine in machines]
    labels = release_rows.labels(found)
    report = present(dict(zip(labels, found, strict=True)))
    expected = {("abacus",): [""], ("abacus", "slide rule"): ["abacus", "slide rule"]}.get(machines, ["machine 1", "machine 2"])
    assert labels == expected
    (part,) = report.parts
    assert [line.results for line in part.lines] == expected
    (finding,) = report.findings  # what is the same on both machines is said once
    assert [f"RK4 ({label})" in finding.text for label in labels] == list(map(bool, labels))
    page, text = html.render_study(report), markdown.render_study(report)
    pages.check(page)
    for label in filter(None, labels):
        assert label in pages.Page(page).text
        assert label in text


def test_studies_of_different_cases_are_not_merged() -> None:
    one = found_on("abacus")
    other = replace(one, header=one.header | {"cases": {"spin": "1"}})
    with pytest.raises(BadInput, match="spin: the case differs"):
        present({"one": one, "other": other})
    with pytest.raises(BadInput, match="different engines"):
        present({"one": one, "other": replace(one, header=one.header | {"engines": {"pinocchio": "1.0"}})})


def test_reports_are_made_again_from_what_is_saved(tmp_path: Path) -> None:
    for machine in ("abacus", "slide rule"):
        release_rows.write(found_on(machine), tmp_path / machine)
    assert call("report", tmp_path / "abacus", tmp_path / "slide rule", "--out", tmp_path / "both") == 0
    assert "RK4 (abacus) and RK4 (slide rule)" in (tmp_path / "both" / "report.md").read_text()
    assert call("report", tmp_path / "abacus") == 0
    assert "Between 1.0 and 2.0, RK4 went" in (tmp_path / "abacus" / "report.md").read_text()
    saved = tmp_path / "abacus" / "releases.jsonl"
    saved.write_text("\n".join(saved.read_text().splitlines()[:-1]) + "\n")
    with pytest.raises(BadInput, match="was interrupted"):
        call("report", tmp_path / "abacus")


def test_studies_of_earlier_versions_of_bodycheck_are_read(tmp_path: Path) -> None:
    """Their headers lack what was added since."""
    written = found_on("abacus")
    release_rows.write(written, tmp_path)
    lines = journals.records(tmp_path / release_rows.RECORDS)
    for name in LATER:
        del lines[0][name]
    journals.write_without_checksums(tmp_path / release_rows.RECORDS, lines)
    assert release_rows.read(tmp_path) == written


def test_the_chart_has_a_line_a_method_and_a_ring_where_it_changed() -> None:
    rows = [row("1.0", 2e-5), row("2.0", 3e-9), failed("10.0", "crashed"), row("11.0", 3e-9)]
    header = HEADER | {"versions": ["1.0", "2.0", "10.0", "11.0"]}
    report = present({"": Found(header, tuple(rows), (change(),))})
    (chart,) = report.parts[0].charts
    (layer,) = chart.specification["layer"]
    values = layer["data"]["values"]
    assert [(one["version"], one["value"], one["changed"]) for one in values] == [
        ("1.0", 2e-5, False),
        ("2.0", 3e-9, True),
        ("10.0", None, False),
        ("11.0", 3e-9, False),
    ]
    assert layer["encoding"]["x"]["sort"] == ["1.0", "2.0", "10.0", "11.0"]
    svg = vl_convert.vegalite_to_svg(json.dumps(chart.specification))
    # The line is broken at the release without a figure, and one symbol is a ring.
    assert svg.count('stroke-width="1.6"') == 1
    assert facts(chart.alt, "mujoco RK4")[-4:] == ["mujoco RK4", "2e-5", "3e-9", "2.0"]


def test_a_figure_of_another_definition_is_named_and_compared_with_no_other_study() -> None:
    rows = (row("1.0", energy_drift=0.1, energy_drift_allowance=1e-9), row("2.0", energy_drift=0.2))
    changes = (change(), change(quantity="energy_drift"))
    now = Found(HEADER, rows, changes)
    before = replace(now, header=HEADER | {"revisions": {}})
    assert release_rows.comparable([now, now]) == [now, now]
    assert release_rows.comparable([before]) == [before]
    (told,) = present({"": before}).notices
    assert {"energy_drift", "another definition"} <= set(facts(told, "energy_drift", "another definition"))
    apart = release_rows.comparable([before, now])
    for one in apart:
        assert {name for own in one.rows for name in own if "drift" in name} == set()
        assert [own.quantity for own in one.changes] == ["attitude_error"]
    notices = present({"before": apart[0], "now": apart[1]}).notices
    left_out = "Left out, since its definition differs between these studies: energy_drift."
    assert notices == (f"before: {left_out}", f"now: {left_out}")
