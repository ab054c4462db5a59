"""The player in a real browser: what it draws is what the mechanics says, and it is played by mouse, keys and ears."""

import json
import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from bodycheck import load, reports, truth
from bodycheck.casefile.case import Case, parse
from bodycheck.judging.result_set import judged
from bodycheck.reference.inertia import angular_momentum
from bodycheck.reference.kinematics import geodesic_angle, rotate
from bodycheck.reference.scene import Brick
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reports.runs.motions import tracks
from bodycheck.reports.runs.motions.single_body import RATE_TOLERANCE
from bodycheck.results.outcome import Completed
from bodycheck.results.store import Results
from bodycheck.running import plan
from tests.support import campaigns
from tests.support.browser import Visit, visiting
from tests.support.cases import shortened

FLIP, BOXES, BRICK, SLIDE = "intermediate-axis-flip", "osrf-boxes-complex", "free-brick", "curling-brick"
FAR = "far-slide"
FLYING = (FLIP, BOXES, BRICK)
END = 4.0
#: Pixels: paths are written to a tenth of a pixel.
ROUNDING = 0.06


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Three bodies that tumble for four seconds, one that slides for less than one, and one that slides far."""
    engines = campaigns.records("mujoco", "pinocchio")
    cases = [shortened(load(name), END, 401) for name in FLYING] + [shortened(load(SLIDE), 0.8, 401)]
    slide = load(SLIDE).text.partition("[[expect]]")[0]
    fast = re.sub(r"velocity = .*", "velocity = [12.0, 3.0, 0.0]", slide, count=1).replace(SLIDE, FAR)
    written = [*map(written_again, cases), parse(re.sub(r"duration = .*", "duration = 2.0", fast), FAR)]
    tasks = plan.plan(written, engines, ("Euler", "RK4", "implicitfast", "semi-implicit-euler", "rk4", "admm"), ())
    return campaigns.results(tasks, tmp_path_factory.mktemp("player"))


def written_again(case: Case) -> Case:
    """A case whose text says what it is, as results are read again from the text."""
    text = load(case.name).text.partition("[[expect]]")[0]
    text = re.sub(r"duration = .*", f"duration = {case.duration}", text)
    return replace(case, text=re.sub(r"samples = .*", f"samples = {case.samples}", text))


@pytest.fixture(scope="module")
def report(results: Results, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return reports.write([judged(results)], tmp_path_factory.mktemp("report"))[0]


@pytest.fixture(scope="module")
def flips(browser: Any, report: Path) -> Iterator[tuple[Visit, Any]]:
    """The flip's player, opened once."""
    with at(browser, report, FLIP) as found:
        yield found


@pytest.fixture
def flip(flips: tuple[Visit, Any]) -> tuple[Visit, Any]:
    """The flip's player, standing still with the bodies that it opens with."""
    visit, player = flips
    if (playing := player.get_by_role("button", name="Pause")).count():
        playing.click()
    player.get_by_label("Body 2 of 4").select_option("mujoco Euler")
    return visit, player


@contextmanager
def at(
    browser: Any, report: Path, case: str, width: int = 1280, scheme: Literal["light", "dark"] = "light"
) -> Iterator[tuple[Visit, Any]]:
    """The page, and the player of a case, on the screen."""
    with visiting(browser, report, width=width, scheme=scheme) as visit:
        visit.page.evaluate("document.querySelectorAll('main .fold').forEach((one) => { one.open = true; })")
        player = visit.page.locator(f"#case-{case} .player")
        player.scroll_into_view_if_needed()
        visit.page.wait_for_selector(f"#case-{case} .player[data-ready] .controls")
        player.scroll_into_view_if_needed()
        yield visit, player


def move(player: Any, t: float) -> None:
    player.get_by_label("Time", exact=True).fill(str(t))


def panel(player: Any, name: str) -> Any:
    return player.locator(f'svg[data-body="{name}"]')


def numbers(svg: Any, name: str) -> Array:
    return np.array([float(value) for value in svg.get_attribute(f"data-{name}").split(",")])


def projected(view: dict[str, Any], points: Array) -> Array:
    """Pixels (n, 2) of points (n, 3) in the world, by the picture's own view, in perspective."""
    away = points - np.array(view["focus"])
    near = view["distance"] / (view["distance"] - away @ np.array(view["toward"]))
    return np.column_stack(
        [120 + view["scale"] * near * (away @ view["right"]), 120 - view["scale"] * near * (away @ view["up"])]
    )


def exactly(results: Results, case: str, t: float) -> Trajectory:
    """The truth at an instant, computed anew and not read from the file."""
    return truth(results.cases[case], [0.0, t]).trajectory.part(slice(1, None))


def stored(results: Results, case: str, engine: str, integrator: str) -> Trajectory:
    for run in results.runs():
        if (run.case, run.engine, run.method.name) == (case, engine, integrator):
            assert isinstance(run.outcome, Completed)
            return run.outcome.trajectory
    raise AssertionError("no such run")


@pytest.mark.parametrize("case", FLYING)
def test_the_truths_body_has_the_truths_attitude(browser: Any, report: Path, results: Results, case: str) -> None:
    """At a sample and between samples: the quaternion, the corners of the brick in pixels, and the angular momentum."""
    body = results.cases[case].scene.body
    assert isinstance(body.shape, Brick)
    half = np.array(body.shape.semi_axes) / math.hypot(*body.shape.semi_axes)
    signs = np.array([[i, j, k] for i in (1, -1) for j in (1, -1) for k in (1, -1)])
    with at(browser, report, case) as (_, player):
        svg = panel(player, "the truth")
        for t, side in ((3.0, "20"), (2.7183, "-75")):
            exact = exactly(results, case, t)
            move(player, t)
            player.get_by_label("Seen from").fill(side)
            assert float(svg.get_attribute("data-time")) == t
            drawn = numbers(svg, "quaternion")
            assert np.linalg.norm(drawn) == pytest.approx(1)
            assert geodesic_angle(exact.quaternion[0], drawn) <= tracks.TOLERANCE

            view = json.loads(svg.get_attribute("data-view"))
            corners = projected(view, rotate(np.tile(exact.quaternion, (8, 1)), signs * half))
            # A corner is one reach from the centre, and comes nearer to the eye by no more than that.
            blur = tracks.TOLERANCE * view["scale"] * (view["distance"] / (view["distance"] - 1)) ** 2 + ROUNDING
            assert np.linalg.norm(corners[0] - numbers(svg, "corner")) <= blur
            paths = " ".join(svg.locator("path.edge").evaluate_all("all => all.map(path => path.getAttribute('d'))"))
            vertices = np.array([[float(x), float(y)] for x, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)", paths)])
            distances = np.linalg.norm(vertices[:, None] - corners[None], axis=2)
            assert distances.min(axis=1).max() <= blur  # all that is drawn is a corner of the true brick
            assert len(set(distances.argmin(axis=1))) >= 4  # and a face has four of them

            momentum = rotate(exact.quaternion, angular_momentum(body, exact.angular_velocity))[0]
            assert numbers(svg, "momentum") == pytest.approx(momentum / np.linalg.norm(momentum), abs=RATE_TOLERANCE)


def test_a_runs_body_has_the_attitude_that_its_engine_gave(flip: tuple[Visit, Any], results: Results) -> None:
    motion = stored(results, FLIP, "mujoco", "Euler")
    for sample in (127, 300):
        exact = exactly(results, FLIP, motion.t[sample])
        move(flip[1], motion.t[sample])
        svg = panel(flip[1], "mujoco Euler")
        drawn, right = (numbers(panel(flip[1], name), "quaternion") for name in ("mujoco Euler", "the truth"))
        assert geodesic_angle(motion.quaternion[sample], drawn) <= tracks.TOLERANCE
        off = geodesic_angle(motion.quaternion[sample], exact.quaternion[0])
        assert abs(off - geodesic_angle(drawn, right)) <= 2 * tracks.TOLERANCE
        told = svg.locator("xpath=..").locator(".reading").inner_text()
        angle, shift = (float(figure) for figure in re.findall(r"off by ([\d.]+) rad\s+and ([\d.]+) m", told)[0])
        assert angle == pytest.approx(off, abs=2.1 * tracks.TOLERANCE)
        away = float(np.linalg.norm(motion.position[sample] - exact.position[0]))
        assert shift == pytest.approx(away, rel=0.06)  # two digits


def test_methods_are_chosen_for_each_body(flip: tuple[Visit, Any], results: Results) -> None:
    motion, player = stored(results, FLIP, "mujoco", "implicitfast"), flip[1]
    move(player, 3)
    select = player.get_by_label("Body 2 of 4")
    assert select.locator("option").count() == 5
    select.select_option("mujoco implicitfast")
    drawn = numbers(panel(player, "mujoco implicitfast"), "quaternion")
    assert panel(player, "mujoco Euler").count() == 0
    assert geodesic_angle(motion.quaternion[300], drawn) <= tracks.TOLERANCE


def test_a_slide_is_drawn_where_it_is(browser: Any, report: Path, results: Results) -> None:
    """All bodies on one piece of the plane, each to two hundredths of its reach where it was, and all in the picture."""
    exact = exactly(results, SLIDE, 0.3)
    reach = math.hypot(0.1, 0.2, 0.05)
    with at(browser, report, SLIDE) as (_, player):
        assert player.get_by_text("Polhodes").count() == 0
        move(player, 0.3)
        svg = panel(player, "the truth")
        assert np.abs(numbers(svg, "place") * reach - exact.position[0]).max() <= 0.02 * reach
        assert geodesic_angle(exact.quaternion[0], numbers(svg, "quaternion")) <= tracks.TOLERANCE
        pictures = player.locator("svg[data-view]")
        views = pictures.evaluate_all("all => all.map(svg => svg.dataset.view)")
        assert len(views) == 4
        assert len(set(views)) == 1
        for t in (0.0, 0.8):
            move(player, t)
            inside = pictures.evaluate_all(
                "all => all.flatMap(svg => [...svg.querySelectorAll('.face')].map(face => face.getBBox()))"
                ".every(box => box.x >= 0 && box.y >= 0 && box.x + box.width <= 240 && box.y + box.height <= 240)"
            )
            assert inside


def test_a_picture_goes_with_a_body_that_slides_far(browser: Any, report: Path, results: Results) -> None:
    exact = exactly(results, FAR, 1.5)
    with at(browser, report, FAR) as (_, player):
        assert player.get_by_text("each picture follows its body").count() == 1
        move(player, 1.5)
        svg = panel(player, "the truth")
        focus, place = json.loads(svg.get_attribute("data-view"))["focus"], numbers(svg, "place")
        assert focus == [place[0], place[1], 0]
        # Paths are stored to 1 % of the size of the body, 0.23 m.
        assert place * math.hypot(0.1, 0.2, 0.05) == pytest.approx(exact.position[0], abs=0.01)


def test_the_polhode_follows_the_angular_momentum_in_the_body(flip: tuple[Visit, Any], results: Results) -> None:
    exact = exactly(results, FLIP, 3.0)
    momentum = angular_momentum(results.cases[FLIP].scene.body, exact.angular_velocity)[0]
    player = flip[1]
    move(player, 3)
    drawn = numbers(player.locator("svg[data-truth]"), "truth")
    assert player.locator("svg[data-truth] .polhode.truth").count() == 2  # before the sphere and behind it
    assert drawn == pytest.approx(momentum / np.linalg.norm(momentum), abs=2e-2)


def test_nothing_moves_by_itself_and_keys_play(flip: tuple[Visit, Any]) -> None:
    visit, player = flip
    slider = player.get_by_label("Time", exact=True)
    svg = panel(player, "the truth")

    def now() -> float:
        return float(svg.get_attribute("data-time"))

    before = now()
    visit.page.wait_for_timeout(300)
    assert now() == before
    move(player, 1)
    slider.focus()
    visit.page.keyboard.press("ArrowRight")
    assert now() == pytest.approx(1 + END / 200)
    visit.page.keyboard.press("PageDown")
    assert now() == pytest.approx(1 - 9 * END / 200)
    visit.page.keyboard.press("Home")
    assert now() == 0
    assert slider.get_attribute("aria-valuetext") == "0.00 s of 4.00 s"
    visit.page.keyboard.press(" ")
    visit.page.wait_for_function("svg => Number(svg.dataset.time) > 0.1", arg=svg.element_handle())
    visit.page.keyboard.press(" ")
    stopped = now()
    visit.page.wait_for_timeout(200)
    assert now() == stopped
    button = player.get_by_role("button", name="Play")
    button.focus()
    visit.page.keyboard.press("Enter")
    player.get_by_role("button", name="Pause").wait_for()
    visit.page.wait_for_function("([svg, t]) => Number(svg.dataset.time) > t", arg=[svg.element_handle(), stopped])


def test_playing_goes_round_at_the_chosen_speed(flip: tuple[Visit, Any]) -> None:
    """From the end to the beginning, and two seconds of the body's time in one of the page's, however slow its pictures are."""
    visit, player = flip
    svg = panel(player, "the truth").element_handle()
    player.get_by_label("Speed").select_option("2")
    move(player, END - 0.2)
    player.get_by_role("button", name="Play").click()
    visit.page.wait_for_function("svg => Number(svg.dataset.time) < 1", arg=svg)
    pictures = np.array(visit.page.evaluate(PICTURES, svg))
    stamps, times = pictures[:, 0] / 1000, pictures[:, 1]
    slowest = np.diff(stamps).max()
    assert times[-1] - times[0] == pytest.approx(2 * (stamps[-1] - stamps[0]), abs=2 * 2 * slowest)
    assert times[-1] - times[0] > 0.5


#: When pictures were drawn (ms), and the times (s) that they show, for a while.
PICTURES = """svg => new Promise((resolve) => {
  const seen = [];
  const look = (stamp) => {
    seen.push([stamp, Number(svg.dataset.time)]);
    if (stamp - seen[0][0] > 800) resolve(seen);
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
})"""


def test_what_is_drawn_is_told_when_it_stands_still(flip: tuple[Visit, Any]) -> None:
    visit, player = flip
    status = player.get_by_role("status")
    player.get_by_label("Time", exact=True).focus()
    move(player, 3)
    visit.page.wait_for_function("p => p.textContent.startsWith('At 3.00 s')", arg=status.element_handle())
    told = status.text_content()
    assert re.search(r"the truth, its axis K along \(.*\): turning at\s[\d.]+ rad/s; mujoco Euler: off by 0.1\d+ rad", told)
    assert panel(player, "mujoco Euler").get_attribute("aria-label").startswith("At 3.00 s, mujoco Euler: off by")
    visit.page.keyboard.press(" ")
    visit.page.wait_for_timeout(800)
    assert status.text_content() == told
    visit.page.keyboard.press(" ")
    visit.page.wait_for_function("([p, told]) => p.textContent !== told", arg=[status.element_handle(), told])


def test_everything_to_be_used_has_a_name(flip: tuple[Visit, Any]) -> None:
    player = flip[1]
    named = player.locator("button, input, select").evaluate_all(
        "all => all.map(one => one.ariaLabel || one.labels?.[0]?.textContent || one.textContent.trim())"
    )
    assert named == [*(f"Body {k} of 4" for k in (2, 3, 4)), "Play", "Time", "Speed", "Seen from"]
    pictures = player.locator("svg[role=img]")
    pictures.first.wait_for()
    player.page.wait_for_function(
        "player => [...player.querySelectorAll('svg[role=img]')].every(svg => svg.ariaLabel)", arg=player.element_handle()
    )
    assert pictures.count() == 5


def test_players_far_from_the_window_wait(browser: Any, report: Path) -> None:
    with visiting(browser, report) as visit:
        visit.page.wait_for_timeout(300)
        assert visit.page.locator(".player").count() == 6  # one of them stands at the beginning
        assert visit.page.locator(".player[data-ready]").count() <= 2
        assert visit.page.locator(".player:not([data-ready]) svg").count() == 0


def test_one_plays_at_a_time_and_none_out_of_sight(browser: Any, report: Path) -> None:
    with at(browser, report, FLIP) as (visit, player):
        player.get_by_role("button", name="Play").click()
        player.get_by_role("button", name="Pause").wait_for()
        visit.page.evaluate("scrollTo(0, 0)")
        player.get_by_role("button", name="Play").wait_for()


def test_it_fits_a_narrow_screen_and_paper(browser: Any, report: Path) -> None:
    with at(browser, report, FLIP, width=390, scheme="dark") as (visit, player):
        wide = player.evaluate(
            "player => [...player.querySelectorAll('*')].filter(one => one.getBoundingClientRect().right > innerWidth).length"
        )
        assert wide == 0
        assert len({round(box["y"]) for box in boxes(player)}) == 3  # two, two, and the polhodes
        visit.page.emulate_media(media="print")
        visit.page.evaluate("dispatchEvent(new Event('beforeprint'))")
        assert visit.page.locator(".player:not([data-ready])").count() == 0
        assert player.get_by_role("button").count() == 0
        assert player.locator(".clock").is_visible()
        assert all(box["width"] > 50 for box in boxes(player))
        ink = player.locator(".letter").first.evaluate("text => getComputedStyle(text).fill")
        assert ink == "rgb(27, 31, 36)"  # dark on white, whatever the screen


def boxes(player: Any) -> list[dict[str, float]]:
    return [svg.bounding_box() for svg in player.locator("svg[role=img]").all()]
