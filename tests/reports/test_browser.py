"""Reports as a person sees and uses them: in a real browser, from disk."""

import importlib.util
import re
from pathlib import Path
from typing import Any

import pytest

from tests.support import ROOT
from tests.support.browser import Visit, shown_cases, visiting
from tests.support.pages import HOSTILE
from tests.support.report_cases import FLIGHT, FLIP, LONG, SLIDE, TABLE

SCREENS = {1280: 800, 390: 844}

CHART = "#case-intermediate-axis-flip .chart >> nth=0"

CONTRASTS = """() => {
  const linear = (share) => share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  const parts = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const luminance = ([r, g, b]) => 0.2126 * linear(r / 255) + 0.7152 * linear(g / 255) + 0.0722 * linear(b / 255);
  const ground = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const [r, g, b, alpha = 1] = parts(getComputedStyle(at).backgroundColor);
      if (alpha > 0) return [r, g, b];
    }
    return [255, 255, 255];
  };
  const low = [];
  let seen = 0;
  for (const element of document.querySelectorAll("body *")) {
    if (![...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim())) continue;
    if (!element.checkVisibility() || element.closest(".unseen, select")) continue;
    const style = getComputedStyle(element);
    const svg = element instanceof SVGElement;
    if (svg && Number(style.opacity) === 0) continue;
    const [a, b] = [luminance(parts(svg ? style.fill : style.color)), luminance(ground(element))];
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    seen += 1;
    if (contrast < 4.5) low.push(`${contrast.toFixed(2)} ${element.tagName}: ${element.textContent}`);
  }
  return { seen, low };
}"""


def drawn(visit: Visit) -> Any:
    """A locator of the first chart's SVG, once it is drawn."""
    visit.page.locator(CHART).scroll_into_view_if_needed()
    svg = visit.page.locator(CHART).locator("svg.marks")
    svg.wait_for()
    return svg


@pytest.mark.parametrize("which", ["report", "study"])
def test_every_part_shows_quietly_and_can_be_read(browser: Any, request: pytest.FixtureRequest, which: str) -> None:
    """No complaint on the console and no request (`visiting`), no chart undrawn, no text of too little contrast."""
    with visiting(browser, request.getfixturevalue(which)) as visit:
        assert visit.page.locator(".chart").count() >= 2
        for chart in visit.page.locator(".chart").all():
            chart.scroll_into_view_if_needed()
            chart.locator("svg.marks").wait_for()
        for scheme in ("light", "dark"):
            visit.page.emulate_media(color_scheme=scheme)
            contrasts = visit.page.evaluate(CONTRASTS)
            assert contrasts["seen"] > 100
            assert contrasts["low"] == []


@pytest.mark.parametrize("width", SCREENS)
def test_the_verdict_is_on_the_first_screen(browser: Any, report: Path, width: int) -> None:
    height = SCREENS[width]
    with visiting(browser, report, width, height) as visit:
        page = visit.page
        assert page.inner_text("h1") == "2 of 13 runs failed"
        needed = ["h1", ".tally", ".findings div >> nth=0"]
        needed += [".findings div >> nth=1", ".findings div >> nth=2", "#curve-trade-turning"] if width == 1280 else []
        for part in needed:
            box = page.locator(part).bounding_box()
            assert box["y"] + box["height"] <= height, part
        assert page.evaluate("document.documentElement.scrollWidth") == width
        page.locator(".tally a", has_text="failed").click()
        page.wait_for_function("document.getElementById('failures').getBoundingClientRect().top < 100")


@pytest.mark.parametrize("width", SCREENS)
def test_nothing_is_wider_than_the_window(browser: Any, request: pytest.FixtureRequest, width: int) -> None:
    for which in ("report", "study"):
        with visiting(browser, request.getfixturevalue(which), width, SCREENS[width]) as visit:
            visit.page.add_style_tag(content=".case { content-visibility: visible !important }")
            assert visit.page.evaluate("document.documentElement.scrollWidth") == width
            clipped = visit.page.locator("main .scroll").evaluate_all(
                "all => all.map((one) => one.scrollWidth - one.clientWidth)"
            )
            assert len(clipped) > 1
            assert width < 1280 or max(clipped) <= 0, "every table is whole in a window of usual size"


#: Whether a section is in the window and in no fold that is closed, of its name.
IN_SIGHT = """name => {
    const one = document.getElementById(name);
    return one.getBoundingClientRect().top < innerHeight && !one.closest("details:not([open])");
}"""


@pytest.mark.parametrize("width", SCREENS)
def test_the_index_leads_to_every_section(browser: Any, report: Path, width: int) -> None:
    """Also to folded ones, and on a narrow screen, where it is folded itself and folds away again."""
    with visiting(browser, report, width, SCREENS[width]) as visit:
        page = visit.page
        page.evaluate("document.querySelectorAll('main details').forEach((one) => { one.open = false; })")
        links = page.locator(".index a")
        names = [link.get_attribute("href")[1:] for link in links.all()]
        sections = page.locator("main section[aria-labelledby], main h3[id]").evaluate_all(
            "all => all.map((one) => one.id || one.getAttribute('aria-labelledby'))"
        )
        assert set(sections) <= set(names)
        for name, link in zip(names, links.all(), strict=True):
            if width < 1280:
                assert not link.is_visible()
                page.locator(".index summary").click()
            link.press("Enter")
            page.wait_for_function(IN_SIGHT, arg=name)


def test_the_legend_takes_a_line_away_and_brings_it_back(visit: Visit) -> None:
    chart = drawn(visit)
    lines = chart.locator(".mark-line.role-mark path")
    everything = lines.count()
    button = visit.page.locator("#case-intermediate-axis-flip .legend button", has_text=re.compile("^mujoco RK4"))
    colour = button.locator("line").get_attribute("stroke")
    assert button.get_attribute("aria-pressed") == "true"
    button.click()
    assert button.get_attribute("aria-pressed") == "false"
    visit.page.wait_for_function(
        "([chart, amount]) => chart.querySelectorAll('.mark-line.role-mark path').length === amount",
        # The curve coincides with another one, and has a pale band below it.
        arg=[chart.element_handle(), everything - 2],
    )
    button.press("Enter")
    visit.page.wait_for_function(
        "([chart, amount]) => chart.querySelectorAll('.mark-line.role-mark path').length === amount",
        arg=[chart.element_handle(), everything],
    )
    assert colour in [line.get_attribute("stroke") for line in lines.all()]


def test_zooming(visit: Visit) -> None:
    """With Ctrl the wheel zooms; alone it scrolls the page."""
    chart = drawn(visit)
    ticks = "chart => chart.querySelector('.role-axis-label').textContent"
    box, page = chart.bounding_box(), visit.page
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    before, top = chart.evaluate(ticks), page.evaluate("scrollY")
    page.keyboard.down("Control")
    page.mouse.wheel(0, -400)
    page.keyboard.up("Control")
    page.wait_for_function(f"([chart, before]) => ({ticks})(chart) !== before", arg=[chart.element_handle(), before])
    assert page.evaluate("scrollY") == top
    zoomed = chart.evaluate(ticks)
    page.mouse.wheel(0, 200)
    page.wait_for_function("top => scrollY > top", arg=top)
    assert chart.evaluate(ticks) == zoomed


def test_the_pointer_finds_values(visit: Visit) -> None:
    chart = drawn(visit)
    box, tooltip = chart.bounding_box(), visit.page.locator("#vg-tooltip-element.visible")
    for share in (0.4, 0.5, 0.6):
        visit.page.mouse.move(box["x"] + share * box["width"], box["y"] + 0.5 * box["height"])
    tooltip.wait_for()
    text = tooltip.inner_text()
    assert re.search(r"method\s+(mujoco|pinocchio) ", text)
    assert re.search(r"time\s+[\d.]+ s", text)
    assert re.search(r"attitude error\s+[\d.e-]+ rad", text)


def test_foreign_strings_are_text(visit: Visit) -> None:
    page = visit.page
    page.locator("#case-intermediate-axis-flip h2").scroll_into_view_if_needed()
    page.wait_for_function("document.querySelector('#case-intermediate-axis-flip h2').innerText")  # drawn when it is near
    assert page.inner_text("#case-intermediate-axis-flip h2").startswith(HOSTILE.replace("\u202e", "").split("שלום")[0])
    assert page.locator("#case-intermediate-axis-flip h2").evaluate("title => title.textContent") == f"{HOSTILE} {LONG}"
    assert page.locator("h2 b, h2 script, .note b, td b").count() == 0
    assert page.locator("#case-intermediate-axis-flip h2").bounding_box()["height"] < 300
    assert page.locator("tr.failed .reason").first.bounding_box()["height"] < 300


def test_dark_differs(browser: Any, report: Path) -> None:
    grounds = {}
    for scheme in ("light", "dark"):
        with visiting(browser, report, scheme=scheme) as visit:  # type: ignore[arg-type]
            cell = visit.page.locator("#matrix td a.d0, #matrix td a.d1, #matrix td a.d2").first
            colour = "part => getComputedStyle(part).backgroundColor"
            grounds[scheme] = visit.page.locator("body").evaluate(colour), cell.evaluate(colour)
    assert all(light != dark for light, dark in zip(grounds["light"], grounds["dark"], strict=True))


def test_without_scripts_everything_but_the_charts_is_there(browser: Any, report: Path) -> None:
    context = browser.new_context(java_script_enabled=False)
    try:
        page = context.new_page()
        page.goto(report.as_uri())
        assert page.locator("noscript").count() == 1
        assert page.locator("main button").count() == 0
        assert page.locator(TABLE).locator("tbody tr").count() == 8
        assert shown_cases(page) == [FLIP, FLIGHT, SLIDE]
        assert page.locator("#matrix thead .more:visible").count() == page.locator("#matrix thead .more").count()
    finally:
        context.close()


def test_paper_has_every_chart(visit: Visit) -> None:
    """Also those that were far from the window or folded, which are drawn when the page is printed; then all is as before."""
    visit.page.evaluate("document.querySelectorAll('.fold').forEach((one) => { one.open = false; })")
    visit.page.evaluate(
        "addEventListener('beforeprint', () => { window.folded = document.querySelectorAll('.fold:not([open])').length; })"
    )
    undrawn = visit.page.locator(".chart:not(:has(svg.marks))")
    assert undrawn.count() > 0
    visit.page.pdf()
    assert undrawn.count() == 0
    assert visit.page.evaluate("window.folded") == 0
    assert visit.page.locator(".fold[open]").count() == 0
    assert visit.page.locator(".legend:empty").count() == 0


@pytest.mark.slow
def test_a_large_report_opens_at_once(browser: Any, tmp_path: Path) -> None:
    """A hundred cases by twenty methods: under 15 MB, and in use within 3 s, of which a third is expected to be enough."""
    script = ROOT / "benchmarks" / "report_opening.py"
    spec = importlib.util.spec_from_file_location("report_opening", script)
    assert spec is not None
    assert spec.loader is not None
    benchmark = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(benchmark)
    path = benchmark.large_report(tmp_path)
    assert path.stat().st_size < 15e6
    assert min(max(benchmark.opening(browser, path).values()) for _ in range(3)) < 3.0
