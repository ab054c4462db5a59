"""The front page in a browser: filters, the address, keys, and accessibility."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.site import submissions
from tests.site.browsing import built, served
from tests.site.submissions import CONTACT, FREE, MECHANISM, catalogued, ended, run, submission
from tests.support import axe
from tests.support.browser import Visit, visiting

#: Widths (px) of a telephone, a desk and a wall.
WIDTHS = (390, 1280, 2560)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A site of two engines and three scenes, in one of which one engine changed."""
    before = submission([run(case=FREE, version="3.0", attitude_error=1e-3)], day="2026-01-01")
    after = submission(
        [
            run(case=FREE, attitude_error=1e-5, role="default"),
            run(case=FREE, integrator="RK4", attitude_error=1e-9, role="recommended"),
            submissions.broken(case=CONTACT),
            ended("unsupported", "mujoco refuses the model: no", case=MECHANISM),
        ],
        day="2026-02-01",
    )
    drake = {"engine": "drake", "version": "1.5"}
    other = submission([run(case=FREE, **drake), ended("diverged", "not finite", case=CONTACT, **drake)], day="2026-02-02")
    return built(catalogued(before, after, other), tmp_path_factory.mktemp("front") / "site")


@pytest.fixture
def visit(browser: Any, site: Path) -> Iterator[Visit]:
    with visiting(browser, site / "index.html", site=site) as found:
        yield found


def scenes(page: Any) -> list[str]:
    return [text.strip() for text in page.locator("#matrix th[scope=row]:visible").all_inner_texts()]


#: Script that returns what can be seen in the cells, without what is said to those who cannot see it.
SEEN = """() => [...document.querySelectorAll("#matrix td")]
  .filter((cell) => cell.checkVisibility())
  .map((cell) => cell.firstElementChild)
  .map((one) => (one.checkVisibility({ visibilityProperty: true }) ? one.firstChild.nodeValue : ""))"""


def texts(page: Any) -> list[str]:
    return list(page.evaluate(SEEN))


def test_the_matrix_has_all_scenes_by_kind_and_all_engines(visit: Visit) -> None:
    assert scenes(visit.page) == [FREE, CONTACT, MECHANISM]
    assert texts(visit.page) == ["2.1", "1e-5", "✗", "!0.25", "·", "⊘"]


def test_filters_go_into_the_address_and_the_address_into_the_filters(visit: Visit, browser: Any, site: Path) -> None:
    page = visit.page
    page.locator("[name=q]").fill("sliding")
    assert scenes(page) == [CONTACT]
    page.locator("#engines").click()
    page.get_by_label("drake", exact=True).check()
    assert texts(page) == ["✗"]
    assert page.locator("#shown").inner_text() == "1 of 3 scenes, 1 of 2 engines"
    place = page.evaluate("location.hash")
    with visiting(browser, site / "index.html", site=site, place=place) as again:
        assert scenes(again.page) == [CONTACT]
        assert texts(again.page) == ["✗"]
    page.go_back()
    assert texts(page) == ["✗", "!0.25"]
    page.get_by_role("button", name="Show all").click()
    assert scenes(page) == [FREE, CONTACT, MECHANISM]
    assert page.evaluate("location.hash") == ""


@pytest.mark.parametrize(
    ("place", "there", "numbers"),
    [
        ("#kind=contact", [CONTACT], ["✗", "!0.25"]),
        ("#verdicts=failed,refused", [CONTACT, MECHANISM], ["✗", "", "", "⊘"]),
        ("#changed=1", [FREE], ["", "1e-5"]),
        ("#method=best", [FREE, CONTACT, MECHANISM], ["2.1", "1e-9", "✗", "!0.25", "·", "⊘"]),
        ("#method=recommended", [FREE, CONTACT, MECHANISM], ["·", "1e-9", "·", "·", "·", "·"]),
        ("#engines=nobody", [FREE, CONTACT, MECHANISM], []),
        ("#q=nothing+such", [], []),
        ("#kind=%22%3E%3Cb%3E&verdicts=,,&engines=%00", [], []),
    ],
)
def test_a_state_in_the_address_is_shown(browser: Any, site: Path, place: str, there: list[str], numbers: list[str]) -> None:
    with visiting(browser, site / "index.html", site=site, place=place) as visit:
        assert scenes(visit.page) == there
        assert texts(visit.page) == numbers


def test_the_default_methods_come_back_after_the_best_and_the_recommended_ones(visit: Visit) -> None:
    before = visit.page.locator("#matrix tbody").all_inner_texts()
    visit.page.locator("[name=method]").select_option("best")
    assert texts(visit.page) == ["2.1", "1e-9", "✗", "!0.25", "·", "⊘"]
    visit.page.locator("[name=method]").select_option("recommended")
    assert texts(visit.page) == ["·", "1e-9", "·", "·", "·", "·"]
    visit.page.locator("[name=method]").select_option("")
    assert visit.page.locator("#matrix tbody").all_inner_texts() == before


def test_the_matrix_is_one_stop_of_the_tab_key_and_arrows_lead_through_it(visit: Visit) -> None:
    page = visit.page
    stops = page.locator("#matrix [tabindex='0']")
    assert stops.count() == 1
    stops.focus()
    focused = "document.activeElement.closest('th, td').innerText.trim()"
    assert page.evaluate(focused) == FREE
    for key, there in (("ArrowRight", "2.1"), ("ArrowDown", "✗ failed"), ("End", "!0.25"), ("ArrowDown", "⊘ refused")):
        page.keyboard.press(key)
        assert page.evaluate(focused).replace("\n", " ") == there
        assert stops.count() == 1
    assert "no" in page.locator("#details").inner_text()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Enter")
    page.get_by_role("heading", name=f"{CONTACT} · mujoco 4.0.0 · Euler").wait_for()


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_can_be_used_by_everyone(browser: Any, site: Path, width: int, scheme: Any) -> None:
    with visiting(browser, site / "index.html", width, scheme=scheme, site=site) as visit:
        axe.check(visit.page)
        assert visit.page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_page_works_from_a_web_host_under_the_same_policy(browser: Any, site: Path) -> None:
    with served(site) as address:
        page = browser.new_page()
        told: list[str] = []
        page.on("console", lambda line: told.append(line.text))
        for name in ("index.html#method=best", "compare.html#engine=mujoco", "row.html"):
            page.goto(address + name)
            page.wait_for_load_state("networkidle")
        assert told == []
        assert page.locator("html.scripts").count() == 1
        page.close()


def test_results_are_there_without_scripts(browser: Any, site: Path) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto((site / "index.html").as_uri())
    assert page.locator("#matrix td a").first.inner_text() == "2.1"
    assert not page.locator("[name=q]").is_visible()
    page.goto((site / "compare.html").as_uri())
    assert "needs JavaScript" in page.locator("main").inner_text()
    context.close()


def test_skipping_to_the_content_keeps_the_filters(browser: Any, site: Path) -> None:
    with visiting(browser, site / "index.html", site=site, place="#kind=contact") as visit:
        visit.page.keyboard.press("Tab")
        visit.page.keyboard.press("Enter")
        assert visit.page.evaluate("document.activeElement.id") == "main"
        assert visit.page.evaluate("location.hash") == "#kind=contact"
        assert scenes(visit.page) == [CONTACT]
