"""Pages of engines and releases in a browser: readable for all, no wider than the window, and without a complaint."""

from pathlib import Path
from typing import Any, Literal

import pytest

from bodycheck.site import build, links
from tests.site import submissions as make
from tests.site import upgrades as example
from tests.support import axe
from tests.support.browser import visiting


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A site with every table, an engine that was not run, and a method with a long name."""
    long = make.run(integrator=f"Euler:{','.join(f'option{place}=a-long-value' for place in range(8))}", version="4.0.0")
    folder = tmp_path_factory.mktemp("engines") / "site"
    catalogue = example.catalogue(
        make.submission(example.STUDIES, day="2026-01-04"),
        make.submission([long], day="2026-01-05"),
        make.submission({"audit.csv": [make.audit(engine="dart", version="6.20.0")]}, day="2026-01-06"),
    )
    build.write(list(build.files(catalogue)), folder)
    return folder


@pytest.mark.parametrize(
    ("path", "width", "scheme"),
    [
        (links.engine("mujoco"), 390, "light"),
        (links.engine("mujoco"), 2560, "dark"),
        (links.engine("dart"), 1280, "light"),
        (links.release("mujoco", "4.0.0"), 390, "dark"),
    ],
)
def test_pages_are_accessible_and_fit(
    browser: Any, site: Path, path: str, width: int, scheme: Literal["light", "dark"]
) -> None:
    with visiting(browser, site / path, width=width, scheme=scheme, site=site) as visit:
        assert visit.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        axe.check(visit.page)


def test_labels_of_a_chart_do_not_overlap(browser: Any, site: Path) -> None:
    with visiting(browser, site / links.engine("mujoco"), site=site) as visit:
        boxes = (
            visit.page.locator("svg.trend")
            .first.locator("text")
            .evaluate_all("all => all.map(one => { const box = one.getBBox(); return [box.x, box.y, box.width, box.height]; })")
        )
    assert len(boxes) > 5
    for place, (x, y, width, height) in enumerate(boxes):
        for other_x, other_y, other_width, other_height in boxes[:place]:
            apart = x >= other_x + other_width or other_x >= x + width
            assert apart or y >= other_y + 0.8 * other_height or other_y >= y + 0.8 * height
