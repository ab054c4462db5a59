"""The player of a mechanism in a real browser: its pictures have all bodies where the truth has them, at the chosen time."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import reports, truth
from bodycheck.casefile.case import parse
from bodycheck.judging.result_set import judged
from bodycheck.reports.runs.motions.playback import PLACE_TOLERANCE
from bodycheck.running import plan
from tests.support import campaigns
from tests.support.browser import visiting
from tests.support.mechanism_texts import CART_POLE

#: A body that a controller moves along z, and whose target jumps.
DRIVEN = """
format = 2
name = "slide"
title = "A driven slide"
[run]
duration = 0.5
samples = 26
[[bodies]]
name = "block"
shape = "brick"
semi_axes = [0.1, 0.1, 0.1]
mass = 1.0
[[joints]]
name = "rail"
type = "prismatic"
child = "block"
axis = [0.0, 0.0, 2.0]
limits = {lower = -0.5, upper = 1.0}
[[controllers]]
joint = "rail"
law = "pd"
kp = 20.0
kd = 8.0
target = {times = [0.0, 0.2], values = [0.1, 0.8]}
rate = 100.0
"""


def test_bodies_are_drawn_where_they_are(browser: Any, tmp_path: Path) -> None:
    case = parse(CART_POLE.replace("duration = 4.0", "duration = 2.0").replace("samples = 81", "samples = 41"), "cart-pole")
    results = campaigns.results(plan.plan([case], campaigns.records("mujoco"), ("Euler",), (0.01,)), tmp_path / "results")
    (tmp_path / "report").mkdir()
    page = reports.write([judged(results)], tmp_path / "report")[0]
    with visiting(browser, page) as visit:
        player = visit.page.locator("#case-cart-pole .player")
        player.scroll_into_view_if_needed()
        visit.page.wait_for_selector("#case-cart-pole .player[data-ready] .controls")
        for t in (0.0, 1.0, 1.37):
            player.get_by_label("Time", exact=True).fill(str(t))
            exact, euler = (places(player, name) for name in ("the truth", "mujoco Euler"))
            extent = float(visit.page.evaluate("JSON.parse(document.getElementById('playback-cart-pole').textContent).extent"))
            states = truth(case, [0.0, t]).trajectory.position[:, -1]
            # The middle of the picture is unknown here, and each place is drawn to a tolerance.
            assert (exact[1] - exact[0]) * extent == pytest.approx(states[1] - states[0], abs=3 * PLACE_TOLERANCE * extent)
            assert (np.linalg.norm(euler - exact) > PLACE_TOLERANCE) == (t > 0)
        words = player.locator(".reading").all_inner_texts()
        assert words[0].startswith("fastest body turning at")
        assert words[1].startswith("off by 0.")
        player.get_by_role("button", name="Play").click()
        player.get_by_role("button", name="Pause").click()


def test_targets_and_stops_of_joints_are_drawn(browser: Any, tmp_path: Path) -> None:
    case = parse(DRIVEN, "slide")
    results = campaigns.results(plan.plan([case], campaigns.records("mujoco"), ("Euler",), (0.01,)), tmp_path / "results")
    (tmp_path / "report").mkdir()
    page = reports.write([judged(results)], tmp_path / "report")[0]
    with visiting(browser, page) as visit:
        player = visit.page.locator("#case-slide .player")
        player.scroll_into_view_if_needed()
        visit.page.wait_for_selector("#case-slide .player[data-ready] .controls")
        extent = float(visit.page.evaluate("JSON.parse(document.getElementById('playback-slide').textContent).extent"))
        targets = {}
        for t in (0.0, 0.19, 0.2, 0.5):
            player.get_by_label("Time", exact=True).fill(str(t))
            for name in ("the truth", "mujoco Euler"):
                targets[t, name] = places(player, name, "targets")[0] * extent
            assert targets[t, "the truth"] == pytest.approx(targets[t, "mujoco Euler"])  # the body is on the world
        apart = targets[0.2, "the truth"] - targets[0.19, "the truth"]
        assert apart == pytest.approx([0.0, 0.0, 0.7])
        assert targets[0.0, "the truth"] == pytest.approx(targets[0.19, "the truth"])
        assert targets[0.5, "the truth"] == pytest.approx(targets[0.2, "the truth"])
        # A stop of a slide is a cross, and the slide has two stops.
        assert player.locator('svg[data-body="the truth"] .stop').get_attribute("d").count("M") == 4
        assert "stops of joints" in player.locator(".key").inner_text()
        visit.page.locator("#case-slide [data-chart=joints_slide] .role-legend-symbol path").first.wait_for(state="attached")


def places(player: Any, name: str, what: str = "places") -> Any:
    """The places of the bodies in the picture of a motion, or of bodies at their targets, in units of the extent."""
    told = player.locator(f'svg[data-body="{name}"]').get_attribute(f"data-{what}")
    return np.array([place.split(",") for place in told.split(";")], dtype=float)
