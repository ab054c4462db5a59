"""The comparison of two results, in a browser."""

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from bodycheck.site import changes, links
from bodycheck.site.catalogue import Catalogue, Entry
from tests.site import submissions
from tests.site.browsing import built
from tests.site.submissions import CONTACT, catalogued, ended, run, submission
from tests.support import axe
from tests.support.browser import launched, visiting

#: Errors and bounds whose pairs lie on both sides of every limit of the rule.
ERRORS = (1e-3, 1.005e-3, 1.02e-3, 2e-3, 1e-9, 1.5e-9)
BOUNDS = (1e-12, 1e-4, 1e-9)


def paired() -> tuple[list[submissions.Row], list[submissions.Row]]:
    """Runs of as many methods as there are pairs of errors and bounds, and endings."""
    before, after = [], []
    for place, (then, now, bound) in enumerate(itertools.product(ERRORS, ERRORS, BOUNDS)):
        before.append(run(integrator=f"m{place}", version="3.0", attitude_error=then, truth_error=bound))
        after.append(run(integrator=f"m{place}", version="4.0", attitude_error=now, truth_error=bound))
    statuses = ("ok", "diverged", "crashed")
    for place, (then, now) in enumerate(itertools.product(statuses, statuses)):
        for rows, status, version in ((before, then, "3.0"), (after, now, "4.0")):
            told = {"integrator": f"s{place}", "version": version, "case": CONTACT}
            rows.append(run(**told) if status == "ok" else ended(status, "not finite", **told))
    before.append(run(integrator="gone", version="3.0"))
    after.append(run(integrator="new", version="4.0", engine="mujoco"))
    return before, after


@pytest.fixture(scope="module")
def catalogue() -> Catalogue:
    before, after = paired()
    drake = [run(engine="drake", version="1.5")]
    return catalogued(submission([*before, *drake], day="2026-01-01"), submission(after, day="2026-02-01"))


@pytest.fixture(scope="module")
def site(catalogue: Catalogue, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built(catalogue, tmp_path_factory.mktemp("compare") / "site")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with launched() as found:
        yield found


def methods(page: Any) -> list[str]:
    page.wait_for_function("document.getElementById('told').textContent.includes('both')")
    return [text.partition(" at ")[0] for text in page.locator("#found tbody td:nth-child(2)").all_inner_texts()]


def test_the_page_finds_the_differences_that_the_rule_of_changes_finds(browser: Any, site: Path, catalogue: Catalogue) -> None:
    old, new = catalogue.submissions
    then = {entry.row["integrator"]: entry for entry in _entries(old, "3.0")}
    now = {entry.row["integrator"]: entry for entry in _entries(new, "4.0")}
    expected = {
        name
        for name in then.keys() & now.keys()
        if changes.change(now[name], then[name], catalogue.scenes[now[name].row["case"]].quantity)
    }
    assert 0 < len(expected) < len(then)
    with visiting(browser, site / "compare.html", site=site, place="#engine=mujoco") as visit:
        assert set(methods(visit.page)) == expected
        told = visit.page.locator("#told").inner_text()
        assert told == (
            f"{len(expected)} of {len(then) - 1} runs that both have differ by more than rounding. "
            "1 run only before. 1 run only after."
        )


def test_the_address_says_what_is_compared(browser: Any, site: Path, catalogue: Catalogue) -> None:
    old, new = catalogue.submissions
    address = links.compare("mujoco", Entry(new, "results.csv", 0), Entry(old, "results.csv", 0))
    place = address.removeprefix(links.COMPARE)
    with visiting(browser, site / "compare.html", site=site, place=place) as visit:
        page = visit.page
        backwards = methods(page)
        assert "1 run only before" in page.locator("#told").inner_text()
        row = page.locator("#found tbody tr").filter(has=page.get_by_role("cell", name="s1 at 2 ms", exact=True))
        assert "completes now; diverged before" in row.inner_text()
        page.get_by_role("button", name="Swap").click()
        page.get_by_text("completed before").first.wait_for()
        assert methods(page) == backwards
        page.get_by_label("also what does not differ").check()
        page.get_by_text("only after", exact=True).wait_for()
        assert len(methods(page)) > len(backwards)
        page.go_back()
        page.go_back()
        page.get_by_text("completes now; diverged before").wait_for()


def test_numbers_lead_to_their_raw_rows(browser: Any, site: Path) -> None:
    with visiting(browser, site / "compare.html", site=site, place="#engine=mujoco") as visit:
        methods(visit.page)
        visit.page.locator("#found tbody td a").first.click()
        visit.page.get_by_role("heading", name="Command that reproduces it").wait_for()


@pytest.mark.parametrize("place", ["#engine=nobody&left=x&right=y", "#engine=drake", "#left=%00"])
def test_any_address_is_answered(browser: Any, site: Path, place: str) -> None:
    with visiting(browser, site / "compare.html", site=site, place=place) as visit:
        methods(visit.page)


@pytest.mark.parametrize(("width", "scheme"), [(390, "light"), (1280, "dark"), (2560, "light")])
def test_the_page_can_be_used_by_everyone(browser: Any, site: Path, width: int, scheme: Any) -> None:
    with visiting(browser, site / "compare.html", width, scheme=scheme, site=site, place="#engine=mujoco") as visit:
        methods(visit.page)
        axe.check(visit.page)
        assert visit.page.evaluate("document.documentElement.scrollWidth") <= width


def _entries(source: Any, version: str) -> list[Entry]:
    rows = source.tables["results.csv"]
    return [Entry(source, "results.csv", place) for place, row in enumerate(rows) if row["version"] == version]
