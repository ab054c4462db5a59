"""The page of a raw row, in a browser."""

from pathlib import Path
from typing import Any

import pytest

from bodycheck.casefile import case as case_files
from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue, Entry
from bodycheck.site.commands import command
from tests.site import submissions
from tests.site.browsing import built
from tests.site.submissions import FREE, catalogued, run, submission
from tests.support import axe
from tests.support.browser import visiting

OWN = "a-case-of-ones-own"


@pytest.fixture(scope="module")
def catalogue() -> Catalogue:
    """Rows of every table on one date, and a run of the same method on another."""
    own = case_files.load("free-brick").text.replace('name = "free-brick"', f'name = "{OWN}"')
    rows = {
        "results.csv": [run(), run(case=OWN, attitude_error=1.234567890123456e-11)],
        "attribution.csv": [submissions.attribution()],
        "tradeoff.csv": [submissions.tradeoff(0.001)],
        "orders.csv": [submissions.order()],
        "releases.csv": [submissions.release("3.2.0")],
        "changes.csv": [submissions.change()],
        "contact.csv": [submissions.contact()],
        "parity.csv": [submissions.parity()],
        "audit.csv": [submissions.audit()],
        "ensemble.csv": [submissions.ensemble()],
    }
    return catalogued(submission(rows, {OWN: own}, day="2026-01-01"), submission([run(version="5.0")], day="2026-02-01"))


@pytest.fixture(scope="module")
def site(catalogue: Catalogue, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built(catalogue, tmp_path_factory.mktemp("row") / "site")


def place(entry: Entry) -> str:
    return links.row(entry).removeprefix(links.ROW)


def test_a_row_of_every_table_has_its_values_its_origin_and_its_command(browser: Any, site: Path, catalogue: Catalogue) -> None:
    source = catalogue.submissions[0]
    with visiting(browser, site / "row.html", site=site) as visit:
        page = visit.page
        for table, rows in source.tables.items():
            page.evaluate("(hash) => { location.hash = hash; }", place(Entry(source, table, 0)))
            page.get_by_text(f"{table}, line 2", exact=True).wait_for()
            told = command(source, table, rows[0])
            assert page.locator("pre").first.inner_text() == told
            there = page.locator("table.columns tbody tr").count()
            assert there == sum(value is not None for value in rows[0].values())
            assert source.header.started in page.locator("main").inner_text()


def test_numbers_have_all_their_digits_and_units_and_the_case_file_can_be_had(
    browser: Any, site: Path, catalogue: Catalogue
) -> None:
    source = catalogue.submissions[0]
    name = source.tables["results.csv"][1]["case"]
    with visiting(browser, site / "row.html", site=site, place=place(Entry(source, "results.csv", 1))) as visit:
        page = visit.page
        page.get_by_text("1.234567890123456e-11 rad", exact=True).wait_for()
        assert "download its file below first" in page.locator("main").inner_text()
        assert page.locator("pre").last.text_content() == source.cases[name]
        with page.expect_download() as download:
            page.get_by_role("link", name=f"Download {name}.case.toml").click()
        assert download.value.suggested_filename == f"{name}.case.toml"
        assert Path(download.value.path()).read_text("utf-8") == source.cases[name]


def test_the_same_row_in_other_results_is_found(browser: Any, site: Path, catalogue: Catalogue) -> None:
    old, new = catalogue.submissions
    with visiting(browser, site / "row.html", site=site, place=place(Entry(old, "results.csv", 0))) as visit:
        page = visit.page
        page.get_by_text("The same row in other results").click()
        page.get_by_role("link", name="2026-02-01 · mujoco 5.0").click()
        page.get_by_role("heading", name=f"{FREE} · mujoco 5.0 · Euler").wait_for()
        assert new.key in page.evaluate("location.hash")
        page.go_back()
        page.get_by_role("heading", name=f"{FREE} · mujoco 4.0.0 · Euler").wait_for()


@pytest.mark.parametrize("hash", ["#", "#0/x", "#../../etc/x.csv/0", "#{key}/results.csv/99", "#{key}/__proto__/0", "#%/%/%"])
def test_an_address_of_no_row_is_told_in_a_sentence(browser: Any, site: Path, catalogue: Catalogue, hash: str) -> None:
    named = hash.replace("{key}", catalogue.submissions[0].key)
    context = browser.new_context()
    page = context.new_page()
    page.goto((site / "row.html").as_uri() + named)
    told = page.get_by_text("Numbers on other pages lead here." if hash == "#" else "The row cannot be shown")
    told.wait_for()
    assert page.locator("#row").inner_text() == ""
    context.close()


@pytest.mark.parametrize(("width", "scheme"), [(390, "light"), (1280, "dark"), (2560, "light")])
def test_the_page_can_be_used_by_everyone(browser: Any, site: Path, catalogue: Catalogue, width: int, scheme: Any) -> None:
    entry = Entry(catalogue.submissions[0], "results.csv", 1)
    with visiting(browser, site / "row.html", width, scheme=scheme, site=site, place=place(entry)) as visit:
        visit.page.get_by_role("heading", name="Case file").wait_for()
        axe.check(visit.page)
        assert visit.page.evaluate("document.documentElement.scrollWidth") <= width
