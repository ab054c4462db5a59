"""The comparison of two results, in a browser."""

import itertools
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from bodycheck.site import changes, links
from bodycheck.site.catalogue import Catalogue, Entry
from bodycheck.site.changes import Change
from bodycheck.site.pages import compare
from bodycheck.site.submissions.submission import Submission
from tests.site import submissions
from tests.site.browsing import built
from tests.site.submissions import FREE, catalogued, ended, run, submission
from tests.support import axe
from tests.support.browser import visiting

#: Errors and bounds whose pairs lie on both sides of every limit of the rule.
ERRORS = (0.0, 1e-3, 1.005e-3, 1.02e-3, 2e-3, 1e-9, 1.5e-9, 0.7, 0.9)
BOUNDS = (1e-12, 1e-4)

#: A case that is tagged as chaotic, and an engine in single precision.
CHAOTIC, SINGLE = submissions.MECHANISM, "mjx32"

VERSIONS = ("3.0", "4.0")


def both_sides(engine: str, subject: str) -> Iterator[submissions.Row]:
    """The rows of each version: runs of as many methods as there are pairs of errors and bounds, and endings."""
    pairs = list(itertools.product(ERRORS, ERRORS, BOUNDS))
    endings = list(itertools.product(("ok", "diverged", "crashed"), repeat=2))
    for side, version in enumerate(VERSIONS):
        told = {"engine": engine, "version": version, "case": subject}
        for place, (*errors, bound) in enumerate(pairs):
            yield run(**told, integrator=f"m{place}", attitude_error=errors[side], truth_error=bound)
        for place, statuses in enumerate(endings):
            status, named = statuses[side], told | {"integrator": f"s{place}"}
            yield run(**named) if status == "ok" else ended(status, "not finite", **named)
        yield run(**told, integrator=("gone", "new")[side])


def measured() -> list[submissions.Row]:
    """The rows of a study of releases, in which some of the methods have measured allowances."""
    return [
        submissions.release(version, integrator=f"m{place}", attitude_error=0.1, attitude_error_allowance=10.0 ** -(place % 7))
        for version in VERSIONS
        for place in range(0, len(ERRORS) ** 2, 3)
    ]


@pytest.fixture(scope="module")
def catalogue() -> Catalogue:
    """Two versions of an engine with measured allowances of some runs, and of one in single precision."""
    rows = [row for given in (("mujoco", FREE), ("mujoco", CHAOTIC), (SINGLE, FREE)) for row in both_sides(*given)]
    old, new = ([row for row in rows if row["version"] == version] for version in VERSIONS)
    drake = [run(engine="drake", version=version, attitude_error=error) for version, error in (("1.4", 0.1), ("1.5", 0.2))]
    precisions = {"precisions": {"mujoco": "float64", SINGLE: "float32", "drake": "float64"}}
    return catalogued(
        submission([*old, drake[0]], day="2026-01-01", **precisions),
        submission([*new, drake[1]], day="2026-02-01", **precisions),
        submission({"releases.csv": measured()}, day="2026-01-15"),
    )


@pytest.fixture(scope="module")
def site(catalogue: Catalogue, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built(catalogue, tmp_path_factory.mktemp("compare") / "site")


def rows(page: Any) -> dict[tuple[str, str], str]:
    """What is said of each run that is shown, by its scene and integrator."""
    page.wait_for_function("document.getElementById('told').textContent.includes('both')")
    cells = "(rows) => rows.map((row) => [0, 1, 5].map((column) => row.cells[column].textContent))"
    found = page.locator("#found tbody tr").evaluate_all(cells)
    return {(case, method.partition(" at ")[0]): text for case, method, text in found}


def runs(page: Any) -> set[tuple[str, str]]:
    """The scenes and integrators of the rows that are shown."""
    return set(rows(page))


def address(engine: str, before: Submission, after: Submission) -> str:
    """What follows the path of the page in the address of a comparison."""
    sides = (next(entry for entry in _entries(source) if entry.engine == engine) for source in (before, after))
    return links.compare(engine, *sides).removeprefix(links.COMPARE)


def change_of(catalogue: Catalogue, before: Entry, after: Entry) -> Change | None:
    """What `changes.change` says of two runs."""
    return changes.change(catalogue, catalogue.scenes[before.row["case"]], after, before)


def told_of(catalogue: Catalogue, before: Entry, after: Entry) -> str:
    """The beginning of what the page says of two runs; empty for runs that do not differ."""
    change = change_of(catalogue, before, after)
    if change is None:
        return ""
    if change.quantity != changes.STATUS:
        return "▲ worse" if change.worse else "▼ better"
    return {True: f"{after.get('status')} now", False: "completes now", None: f"{after.get('status')} now"}[change.worse]


@pytest.mark.parametrize("engine", ["mujoco", SINGLE])
@pytest.mark.parametrize("forwards", [True, False])
def test_the_page_shows_what_changes_says(browser: Any, site: Path, catalogue: Catalogue, engine: str, forwards: bool) -> None:
    old, _, new = catalogue.submissions if forwards else reversed(catalogue.submissions)
    then, now = (
        {(entry.row["case"], entry.row["integrator"]): entry for entry in _entries(source) if entry.engine == engine}
        for source in (old, new)
    )
    both = then.keys() & now.keys()
    expected = {key: said for key in both if (said := told_of(catalogue, then[key], now[key]))}
    assert 0.2 * len(both) < len(expected) < 0.8 * len(both)
    with visiting(browser, site / "compare.html", site=site, place=address(engine, old, new)) as visit:
        shown = rows(visit.page)
        assert shown.keys() == expected.keys()
        assert [key for key, text in shown.items() if not text.startswith(expected[key])] == []
        told = visit.page.locator("#told").inner_text()
        assert told.startswith(f"{len(expected)} of {len(both)} runs that both have differ by more than rounding.")
        assert f"{len(then) - len(both)} run{'s'[: len(then) - len(both) - 1]} only before." in told


def test_the_data_has_the_differences_between_any_two_results_of_an_engine(catalogue: Catalogue) -> None:
    found = {file.path: json.loads(file.content) for file in compare.pages(catalogue) if file.path.endswith(".json")}
    assert found.keys() == {f"{links.changes(engine)}.json" for engine in catalogue.engines}
    read = found[f"{links.changes('mujoco')}.json"]
    results = [_runs(catalogue, **result) for result in read["results"]]
    assert len(results) == 4, "two dates, and two releases of a study"
    listed = {(pair["before"], pair["after"]): pair["differences"] for pair in read["pairs"]}
    for (before, earlier), (after, later) in itertools.combinations(enumerate(results), 2):
        expected: dict[str, set[int]] = {}
        for key in earlier.keys() & later.keys():
            if change := change_of(catalogue, earlier[key], later[key]):
                expected.setdefault(change.quantity, set()).add(earlier[key].place)
        differences = listed.get((before, after), {})
        assert {quantity: set(places) for quantity, places in differences.items()} == expected
        assert all(len(set(places)) == len(places) for places in differences.values())
    assert {"status", "attitude_error"} <= set().union(*listed.values())


def test_of_very_many_versions_in_one_submission_some_are_compared(browser: Any, tmp_path: Path) -> None:
    study = [submissions.release(f"{number}.0", attitude_error=2.0**-number) for number in range(compare.MOST_RESULTS + 2)]
    catalogue = catalogued(submission({"releases.csv": study}, engines={"mujoco": "1.0"}))
    (read,) = (json.loads(file.content) for file in compare.pages(catalogue) if file.path.endswith(".json"))
    assert len(read["results"]) == compare.MOST_RESULTS
    *_, before, after = catalogue.entries("releases.csv")
    place = links.compare("mujoco", before, after).removeprefix(links.COMPARE)
    page = built(catalogue, tmp_path / "site") / links.COMPARE
    with visiting(browser, page, site=tmp_path / "site", place=place) as visit:
        visit.page.get_by_text("of a submission with very many versions, only some are compared").wait_for()


def test_the_page_opens_on_the_two_results_that_differ_in_most_runs(browser: Any, tmp_path: Path) -> None:
    one, same, other = (
        submission(
            [run(version=version, attitude_error=error), run(version=version, integrator="RK4", attitude_error=error)], day=day
        )
        for version, error, day in (("3.0", 0.1, "2026-01-01"), ("3.1", 0.1, "2026-01-02"), ("4.0", 0.2, "2026-01-03"))
    )
    alike = submission([run(engine="drake", version="1.5")], day="2026-01-04")
    catalogue = catalogued(one, same, other, alike)
    with visiting(browser, built(catalogue, tmp_path / "site") / links.COMPARE, site=tmp_path / "site") as visit:
        visit.page.get_by_text("2 of 2 runs that both have differ").wait_for()
        assert visit.page.locator("[name=engine]").input_value() == "mujoco"
        visit.page.locator("[name=engine]").select_option("drake")
        visit.page.get_by_text("There is one set of results of drake").wait_for()
        assert visit.page.locator("#found tr").count() == 0


def test_the_address_says_what_is_compared(browser: Any, site: Path, catalogue: Catalogue) -> None:
    old, _, new = catalogue.submissions
    with visiting(browser, site / "compare.html", site=site, place=address(SINGLE, new, old)) as visit:
        page = visit.page
        backwards = runs(page)
        row = page.locator("#found tbody tr").filter(has=page.get_by_role("cell", name="s1 at 2 ms", exact=True))
        assert "completes now; diverged before" in row.inner_text()
        page.get_by_role("button", name="Swap").click()
        page.wait_for_function("document.getElementById('told').textContent.includes('both')")
        assert "diverged now; completed before" in row.inner_text()
        assert runs(page) == backwards
        page.get_by_label("also what does not differ").check()
        page.get_by_text("only after", exact=True).wait_for()
        assert runs(page) > backwards
        page.go_back()
        page.go_back()
        page.locator("#found caption", has_text="Runs that differ").wait_for()
        assert "completes now; diverged before" in row.inner_text()


def test_numbers_lead_to_their_raw_rows(browser: Any, site: Path) -> None:
    with visiting(browser, site / "compare.html", site=site, place="#engine=mujoco") as visit:
        runs(visit.page)
        visit.page.locator("#found tbody td a").first.click()
        visit.page.get_by_role("heading", name="Command that reproduces it").wait_for()


@pytest.mark.parametrize("place", ["#engine=nobody&left=x&right=y", "#engine=drake", "#left=%00"])
def test_any_address_is_answered(browser: Any, site: Path, place: str) -> None:
    with visiting(browser, site / "compare.html", site=site, place=place) as visit:
        runs(visit.page)


@pytest.mark.parametrize(("width", "scheme"), [(390, "light"), (1280, "dark"), (2560, "light")])
def test_the_page_can_be_used_by_everyone(browser: Any, site: Path, width: int, scheme: Any) -> None:
    with visiting(browser, site / "compare.html", width, scheme=scheme, site=site, place="#engine=drake") as visit:
        assert len(runs(visit.page)) == 1
        axe.check(visit.page)
        assert visit.page.evaluate("document.documentElement.scrollWidth") <= width


def _runs(catalogue: Catalogue, submission: str, version: str, table: str) -> dict[tuple[Any, ...], Entry]:
    """The runs of results of mujoco in a submission, by case and method."""
    entries = [entry for entry in catalogue.entries(table) if entry.source.key == submission]
    return {
        (entry.row["case"], *entry.method): entry for entry in entries if (entry.engine, entry.version) == ("mujoco", version)
    }


def _entries(source: Submission) -> list[Entry]:
    return [Entry(source, "results.csv", place) for place in range(len(source.tables["results.csv"]))]
