"""The page of a scene in a browser: motions are played from disk and from a web host, by mouse and keys; tables are sorted."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import load
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reports.runs.motions import tracks as reported
from bodycheck.site import links
from bodycheck.site.submissions import gathering
from tests.site import motions
from tests.site import submissions as made
from tests.site.browsing import built, served
from tests.site.submissions import FREE, MECHANISM
from tests.support import axe
from tests.support.browser import visiting

#: Engines with their versions, and the angle (rad) by which each is wrong at the end.
ENGINES = {"dart": ("6.20.0", 0.1), "drake": ("1.51.1", 0.2), "mujoco": ("4.0.0", 0.3), "pinocchio": ("4.1.0", 0.4)}


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A site with a flight and a mechanism in four engines, and with a robot."""
    folder = tmp_path_factory.mktemp("scenes")
    found = [
        gathering.read(motions.write_folder(folder / engine, [FREE, MECHANISM], engine, version, angle))
        for engine, (version, angle) in ENGINES.items()
    ]
    differs = made.parity(status="differs", quantity="damping", cause="damping-ignored", relative=1.0)
    robot = made.submission({"parity.csv": [made.parity(), differs]})
    return built(made.catalogued(*found, robot), folder / "site")


def opened(page: Any) -> None:
    """Open the player by keys alone."""
    page.locator("#play").focus()
    page.keyboard.press("Enter")
    page.locator(".player .panel").first.wait_for()


def test_the_player_shows_the_truth_and_the_three_worst_engines(browser: Any, site: Path) -> None:
    with visiting(browser, site / links.scene(FREE), site=site) as visit:
        opened(visit.page)
        heads = visit.page.locator(".player .head select")
        assert [heads.nth(k).locator("option:checked").inner_text().split()[0] for k in range(3)] == [
            "drake",
            "mujoco",
            "pinocchio",
        ]
        assert heads.first.locator("option").count() == 4
        # The reader is where the motion is played.
        assert visit.page.evaluate("document.activeElement.textContent") == "Play"


def test_bodies_are_drawn_where_the_engine_had_them(browser: Any, site: Path) -> None:
    """At the end, to the tolerance that the player tells."""
    case = load(FREE)
    exact = motions.exact(case.name).trajectory
    with visiting(browser, site / links.scene(FREE), site=site) as visit:
        opened(visit.page)
        slider = visit.page.locator('.player input[aria-label="Time"]')
        slider.focus()
        visit.page.keyboard.press("End")
        drawn = visit.page.locator(".player svg.scene[data-quaternion]")
        found = [np.fromstring(drawn.nth(k).get_attribute("data-quaternion"), sep=",") for k in range(4)]
        assert float(drawn.first.get_attribute("data-time")) == pytest.approx(case.duration)
    for attitude, angle in zip(found, (0.0, 0.2, 0.3, 0.4), strict=True):
        known = motions.turned(exact, angle).quaternion[-1]
        assert geodesic_angle(attitude, normalise(known)) <= 1.1 * reported.TOLERANCE


def test_the_reader_chooses_among_all_engines(browser: Any, site: Path) -> None:
    with visiting(browser, site / links.scene(MECHANISM), site=site) as visit:
        opened(visit.page)
        first = visit.page.locator(".player .head select").first
        first.select_option("0")
        assert visit.page.locator(".player svg.scene").nth(1).get_attribute("data-body").startswith("dart 6.20.0 Euler")
        # Pictures that stand still are described for those who do not see them.
        visit.page.locator('.player svg.scene[aria-label^="At "][aria-label*="dart"]').wait_for()


def test_motions_are_played_from_a_web_host(browser: Any, site: Path) -> None:
    with served(site) as address:
        context = browser.new_context()
        complaints: list[str] = []
        page = context.new_page()
        page.on("console", lambda line: line.type in ("error", "warning") and complaints.append(line.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(address + links.scene(FREE))
        opened(page)
        context.close()
    assert not complaints


def test_nothing_of_the_player_is_read_before_it_is_opened(browser: Any, site: Path) -> None:
    with visiting(browser, site / links.scene(FREE), site=site) as visit:
        read = visit.page.evaluate("performance.getEntriesByType('resource').map((one) => one.name)")
        scripts = visit.page.locator("script").evaluate_all("(all) => all.map((one) => one.src)")
    assert not [name for name in (*read, *scripts) if "motion-" in name or "player.js" in name]


def test_tables_are_sorted_by_keys_with_what_lacks_a_number_last(browser: Any, site: Path) -> None:
    with visiting(browser, site / links.scene(FREE), site=site) as visit:
        table = visit.page.locator("table.sortable").first
        head = table.locator("th", has_text=re.compile("^Attitude error"))
        orders = []
        for _ in range(2):
            head.locator("button").focus()
            visit.page.keyboard.press("Enter")
            cells = table.locator("tbody tr td:nth-child(6)")
            orders.append([float(cells.nth(k).get_attribute("data-value")) for k in range(cells.count())])
        assert head.get_attribute("aria-sort") == "descending"
    assert orders == [sorted(orders[0]), sorted(orders[0], reverse=True)]


@pytest.mark.parametrize(("width", "scheme"), [(390, "light"), (2560, "dark")])
def test_pages_are_accessible_and_no_wider_than_the_window(browser: Any, site: Path, width: int, scheme: Any) -> None:
    for path in (links.scene(FREE), links.scene(MECHANISM), links.SCENES, links.robot("panda"), links.ROBOTS):
        with visiting(browser, site / path, width, scheme=scheme, site=site) as visit:
            if visit.page.locator("#play").count():
                opened(visit.page)
            for summary in visit.page.locator("summary").all():
                summary.click()
            axe.check(visit.page)
            assert visit.page.evaluate("document.documentElement.scrollWidth") <= width


def test_without_scripts_everything_but_the_player_is_there(browser: Any, site: Path) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto((site / links.scene(FREE)).as_uri())
    assert page.locator("#play").is_hidden()
    assert page.get_by_text("The player needs scripts.").is_visible()
    assert page.locator("table.sortable tbody tr").first.is_visible()
    context.close()
