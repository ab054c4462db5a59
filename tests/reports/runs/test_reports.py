"""Reports say what was measured, show foreign strings as text, load nothing and stay small."""

import re
import shlex
import shutil
from dataclasses import replace
from pathlib import Path

from bodycheck import load, reports
from bodycheck.adapters.contract import Method
from bodycheck.figures.bounds import within_truth
from bodycheck.figures.columns import FIGURES
from bodycheck.judging import frames, judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reports.quantities import QUANTITIES, bound, number
from bodycheck.reports.runs import html_report, markdown_report
from bodycheck.reports.runs.contents import Contents, gather
from bodycheck.reports.runs.kinds import kind_of
from bodycheck.reports.runs.run_table import WITHIN_TRUTH
from bodycheck.reports.runs.summary import headline
from bodycheck.reports.tables import pieces
from bodycheck.results import store
from bodycheck.results.outcome import Diverged, Unsupported
from bodycheck.results.store import Results
from tests.support import pages
from tests.support.pages import HOSTILE, Page, attributes_of, markdown_tables
from tests.support.report_cases import FLIGHT, FLIP
from tests.support.wording import facts


def altered(results: Results, verdicts: list[Verdict], **strings: str) -> list[ResultSet]:
    """The same results, the strings of the flip's case replaced."""
    case = results.cases[FLIP]
    other = replace(results)
    other.__dict__["cases"] = results.cases | {FLIP: replace(case, **strings)}
    return [ResultSet(other, verdicts)]


def test_written_side_by_side_and_small(results: Results, verdicts: list[Verdict], tmp_path: Path) -> None:
    paths = reports.write([ResultSet(results, verdicts)], tmp_path)
    assert [path.name for path in paths][:2] == ["report.html", "report.md"]
    assert 0.5e6 < paths[0].stat().st_size < 2e6
    assert paths[1].stat().st_size < 60_000


def test_a_page_stands_alone(page: str) -> None:
    pages.check(page)


def test_tables_have_the_measured_numbers(page: str, verdicts: list[Verdict]) -> None:
    seen = Page(page)
    for verdict in verdicts:
        row = verdict.row()
        first = kind_of(load(verdict.run.case).scene).quantity
        names = ["position_error", "velocity_error", "attitude_error", "energy_drift", "rotational_energy_drift"]
        names = sorted((*names, "angular_momentum_drift"), key=lambda name: name != first)
        figures = [row[name] for name in names if within_truth(FIGURES[name], row) is None]
        expected = [*(float(number(figure)) for figure in figures), float(number(1e6 * row["time_per_step"], 3))]
        place = next(i for i, values in enumerate(seen.values) if values == expected)
        shown = row["integrator"] + (" (demonstration)" if row["integrator"] == "body-twist-euler" else "")
        assert seen.rows[place][:3] == [row["engine"], shown, "2 ms"]
        assert f"{row['engine']} {row['version']}" in page


def test_a_figure_leads_to_its_curve_and_to_the_command_that_makes_it(page: str, contents: Contents) -> None:
    """Each figure of each row, in the page too; where a quantity is not drawn only the method leads to the command."""
    ids = set(re.findall(r' id="([^"]+)"', page))
    titles = {QUANTITIES[name].label: name for name in QUANTITIES}
    for section in contents.sections:
        assert section.table is not None
        for run, row, made in zip(section.table.runs, section.table.rows, section.commands, strict=True):
            assert made.anchor == run
            assert run in ids
            words = shlex.split(made.text)
            assert words[:3] == ["bodycheck", "run", section.name]
            assert words[words.index("--engine") + 1] == row[0].text.split()[0]
            assert words[words.index("--integrator") + 1] == row[1].text.removesuffix(" (demonstration)")
            assert float(words[words.index("--timestep") + 1]) * 1e3 == float(row[2].text.removesuffix(" ms"))
            assert row[1].link == run
            for column, entry in zip(section.table.columns, row, strict=True):
                if column in titles and entry.value is not None:
                    name = titles[column]
                    curve = name in section.curves.drawn
                    assert entry.link == (f"curve-{section.name}-{name}" if curve else "")
                    assert not curve or entry.link in ids
    links = re.findall(r'<td><a href="#curve-', page.partition("<tfoot>")[0])
    assert len(links) > 4


def test_an_error_below_the_truths_own_is_called_so(page: str, verdicts: list[Verdict]) -> None:
    for row in (verdict.row() for verdict in verdicts if verdict.run.case == FLIGHT):
        assert row["attitude_error"] <= row["truth_error"]
        assert f"within the truth&#39;s own error ({bound(row['truth_error'])} rad)" in page


def test_every_figure_within_the_truths_own_error_is_called_so(results: Results, verdicts: list[Verdict]) -> None:
    """Marked are the figures that do not exceed their bounds, and no others; that of the energy is made large for this."""
    least = min(verdict.row()["energy_drift"] for verdict in verdicts if verdict.run.case == FLIP)
    planted = [
        replace(v, discrepancy=replace(v.discrepancy, largest=v.discrepancy.maxima() | {"truth_energy_error": 2 * least}))
        for v in verdicts
        if v.discrepancy is not None
    ]
    contents, expected, seen = gather([ResultSet(results, planted)]), [], []
    for verdict in planted:
        row = verdict.row()
        expected += [f"≤ {bound(row[f.bounded_by])}" for f in FIGURES.values() if f.tabled and within_truth(f, row) is not None]
    for section in contents.sections:
        assert section.table is not None
        marked = [entry for entries in section.table.rows for entry in entries if entry.text.startswith("≤")]
        assert (WITHIN_TRUTH in section.table.notes) == bool(marked)
        assert all("within the truth's own error (" in entry.meaning for entry in marked)
        seen += [entry.text for entry in marked]
    assert sorted(seen) == sorted(expected)
    assert f"≤ {bound(2 * least)}" in seen


def test_answers_are_about_methods_that_users_choose(contents: Contents, verdicts: list[Verdict]) -> None:
    """The chosen method has the smallest error of the table; of a method that demonstrates its drift, only its rows tell."""
    frame = frames.table(verdicts)
    told = {finding.subject: finding for finding in (*contents.answers, *contents.findings)}
    assert not any("body-twist-euler" in finding.text for finding in told.values())
    assert not any("emonstration" in finding.text for finding in told.values())
    flip = frame[(frame["case"] == FLIP) & (frame["integrator"] != "body-twist-euler")]
    best = flip.loc[flip["attitude_error"].idxmin()]
    choice = told["Free flight of a turning body"]
    assert "RK4 at 2 ms" in choice.text or "rk4 at 2 ms" in choice.text
    assert bound(best["attitude_error"], 1)[-3:] in choice.text
    default = told["Default"]
    worst = flip.loc[flip["attitude_error"].idxmax()]
    assert number(worst["attitude_error"], 2) in default.text
    assert default.where == FLIP
    alike = ("mujoco Euler", "pinocchio semi-implicit-euler", "one algorithm")
    assert facts(told["Same algorithm"].text, *alike)[:3] == list(alike)
    assert "semi-implicit-euler" not in told["Alike"].text  # which is about methods that err alike and are not the same


def test_a_method_that_demonstrates_something_is_said_to_do_so_in_its_row(contents: Contents, page: str) -> None:
    why = contents.header["demonstrations"]["pinocchio"]["body-twist-euler"]
    for section in contents.sections:
        assert section.table is not None
        names = [row[section.table.columns.index("Integrator")].text for row in section.table.rows]
        assert [name for name in names if "demonstration" in name] == ["body-twist-euler (demonstration)"]
        assert f"pinocchio body-twist-euler is there to demonstrate {why}." in section.table.notes
    assert why in Page(page).text
    assert {column.integrator for matrix in contents.matrices for column in matrix.columns if column.demonstrates} == {
        "body-twist-euler"
    }


def test_a_broken_expectation_is_said_first(page: str, contents: Contents) -> None:
    assert contents.headline == "1 of 10 runs failed"
    (failure,) = contents.failures
    assert (failure.case, failure.method, failure.status) == (FLIP, "mujoco Euler", "expectation broken")
    text = Page(page).text
    assert text.index(contents.headline) < text.index("attitude_error is") < text.index("The default of")
    # The figures of the file itself, whose path stands in the commands.
    told = [f"{step.why}: {step.what}" for step in failure.steps]
    assert any(command in line for line in told for command in ("bodycheck bisect mujoco ", f"--case {FLIP}"))
    markdown = markdown_report.render(contents)
    for step in failure.steps:
        assert f"{step.why}: {step.what}" in text
        assert f"`{step.what}`" in markdown


def test_an_interrupted_run_is_called_that(folder: Path, tmp_path: Path) -> None:
    place = tmp_path / "cut"
    shutil.copytree(folder, place)
    lines = (place / store.RECORDS).read_text("utf-8").splitlines(keepends=True)
    runs = [line for line in lines if '"record": "run"' in line and FLIP in line]
    (place / store.RECORDS).write_text("".join(line for line in lines[:-1] if line not in runs[2:]), "utf-8")
    cut = store.read(place)
    contents = gather([ResultSet(cut, judgement.judge(cut))])
    for text in (Page(html_report.render(contents)).text, markdown_report.render(contents)):
        assert "Interrupted. " in text
        assert "The command was interrupted after 7 runs" in text


def test_nothing_finished(results: Results) -> None:
    contents = gather([ResultSet(replace(results, records=(), complete=False), [])])
    assert contents.headline == "Interrupted. No run finished"
    for text in (Page(html_report.render(contents)).text, markdown_report.render(contents)):
        assert text.count("No run of this case finished.") == 2


def test_a_case_that_no_engine_supports_has_no_table(results: Results, verdicts: list[Verdict]) -> None:
    refused = Unsupported("it does not turn")
    flip = [
        replace(one, run=replace(one.run, outcome=refused), outcome=refused, discrepancy=None, passed=None)
        for one in verdicts
        if one.run.case == FLIP
    ]
    contents = gather([ResultSet(results, [*flip, *(one for one in verdicts if one.run.case != FLIP)])])
    assert {section.name: section.table is None for section in contents.sections} == {FLIP: True, FLIGHT: False}
    assert [matrix.kind.name for matrix in contents.matrices] == ["translation"]
    for text in (Page(html_report.render(contents)).text, markdown_report.render(contents)):
        assert text.count("No run of this case has a result.") == 1
        names = ("rotation", "mujoco", "pinocchio", "it does not turn")
        assert facts(text.partition("Without results:")[2], *names)[:4] == list(names)


def test_a_headline_says_why_no_run_has_a_result(results: Results, verdicts: list[Verdict]) -> None:
    """The engine need not be the reason: a scene may have no truth."""

    def told(*reasons: str) -> str:
        refused = map(Unsupported, reasons)
        runs = [replace(one, outcome=end, discrepancy=None, passed=None) for one, end in zip(verdicts, refused, strict=False)]
        return headline(results, runs)

    names = ("None", "it has no truth", "no drag", "engines", "truth")
    assert facts(told("it has no truth", "it has no truth"), *names) == ["None", "2", "it has no truth"]
    assert facts(told("it has no truth", "no drag"), *names) == ["None", "2", "engines", "truth"]


def test_ways_to_fail(results: Results, verdicts: list[Verdict]) -> None:
    ends_of_runs = (
        Crashed("RuntimeError: <img src=x>\n| second line"),
        Diverged("not a number at t = 1 s"),
        TimedOut(300.0),
        Unsupported("it does not model drag"),
    )
    more = [
        Verdict(
            replace(verdicts[0].run, method=Method.parse(f"way-{place}", 0.002)),
            end,
            None,
            False if end.failed else None,
            end.reason,
        )
        for place, end in enumerate(ends_of_runs)
    ]
    header = results.header | {"missing": {"drake": "drake is not installed"}}
    contents = gather([ResultSet(replace(results, header=header), [*verdicts, *more])])
    assert contents.headline == "4 of 14 runs failed"
    assert dict(contents.tally) == {
        "runs": 14,
        "completed": 10,
        "passed": 0,
        "failed": 4,
        "crashed": 1,
        "diverged": 1,
        "timeout": 1,
        "unsupported": 1,
        "without expectations": 9,
    }
    seen = Page(html_report.render(contents))
    assert "img" not in seen.tags
    for text in (seen.text, markdown_report.render(contents)):
        assert "drake is not installed" in text
        refused = facts(text.partition("Without results:")[2], "mujoco", "it does not model drag")
        assert refused[:4] == ["mujoco", "1", "4", "it does not model drag"]
        assert "stopped after 300 s" in text
        assert "way-2" in text
        assert "way-3" not in text, "what is unsupported has no row"


def test_hostile_strings_show_as_text(results: Results, verdicts: list[Verdict], page: str) -> None:
    contents = gather(altered(results, verdicts, title=HOSTILE, source="</script><script>alert(2)</script>", tags=("</dl>",)))
    text = html_report.render(contents)
    seen = Page(text)
    assert HOSTILE in seen.text
    assert "</script><script>alert(2)</script>" in seen.text
    scripts = attributes_of(text, "script")
    assert len(scripts) == len(attributes_of(page, "script"))
    assert text.lower().count("</script") == len(scripts)


def test_hostile_strings_in_markdown(results: Results, verdicts: list[Verdict]) -> None:
    text = markdown_report.render(gather(altered(results, verdicts, title=f"{HOSTILE}\n\n# @someone #1 https://example.org")))
    assert "<script" not in text
    assert "\u202e" not in text
    assert "@someone" not in text
    assert "://" not in text
    assert "\n# @" not in text
    for table in markdown_tables(text):
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in table}) == 1


def test_a_title_of_ten_thousand_letters(results: Results, verdicts: list[Verdict]) -> None:
    contents = gather(altered(results, verdicts, title="x" * 10_000))
    assert "x" * 10_000 in Page(html_report.render(contents)).text
    assert len(markdown_report.render(contents)) < 60_000


def test_markdown_leaves_out_what_does_not_fit(contents: Contents) -> None:
    many = replace(contents, sections=contents.sections * 60)
    text = markdown_report.render(many)
    assert len(text) < 65_536
    left_out = int(re.findall(r"(\d+) tables were left out", text)[0])
    # One for each section, and what to do about the failure; all methods fit in the matrices.
    assert text.count("<details>") + left_out == 120 + 1


def test_tables_have_the_margin_to_the_limits_and_the_truths_own_errors(contents: Contents, verdicts: list[Verdict]) -> None:
    for section in contents.sections:
        own = [verdict for verdict in verdicts if verdict.run.case == section.name]
        assert section.table is not None
        columns = section.table.columns
        assert len(section.table.footer) == len(columns)
        attitude = section.table.footer[columns.index("Attitude error, rad")].value
        assert attitude == max(verdict.row()["truth_error"] for verdict in own)
        rooms = [min((margin.room for margin in verdict.margins), default=None) for verdict in own]
        assert ("Margin" in columns) == any(room is not None for room in rooms)
        if "Margin" in columns:
            cells = [row[columns.index("Margin")] for row in section.table.rows]
            assert [cell.value for cell in cells] == rooms
            broken = next(cell for verdict, cell in zip(own, cells, strict=True) if verdict.passed is False)
            assert broken.value is not None
            assert broken.value < 1
            assert "attitude_error at most " in broken.meaning
    assert any(section.table is not None and "Margin" in section.table.columns for section in contents.sections)
    text = markdown_report.render(contents)
    assert text.count("| Truth's own error |") == len(contents.sections)
    laid_out = [piece for section in contents.sections if section.table is not None for piece in pieces(section.table)]
    assert html_report.render(contents).count("<tfoot>") == len(laid_out)
