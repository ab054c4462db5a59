"""The page of a scene: its physics with units, its truth, all engines, and what has no run, for its reason."""

import json
import re
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from bodycheck import load
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reports.runs.motions.stills import still
from bodycheck.site import links, scene_cards
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.pages import scenes
from bodycheck.site.submissions import gathering
from bodycheck.site.submissions.tracks import Tracks
from tests.site import motions
from tests.site import submissions as made
from tests.site.submissions import CONTACT, FREE, MECHANISM


def files(catalogue: Catalogue) -> dict[str, str]:
    return {one.path: one.content.decode() for one in scenes.pages(catalogue)}


def text(page: str) -> str:
    """The words of a page."""
    return " ".join(unescape(re.sub("<[^>]+>", " ", page)).split())


def rows(page: str, caption: str) -> list[str]:
    """The rows of the table whose caption begins so, as words."""
    (table,) = (one for one in re.findall(r"<table.*?</table>", page, re.DOTALL) if text(one).startswith(caption))
    return [text(row) for row in re.findall(r"<tr.*?</tr>", table.partition("<tbody>")[2], re.DOTALL)]


@pytest.fixture(scope="module")
def catalogue() -> Catalogue:
    """Two versions of one engine and one of another, on three scenes, with every outcome."""
    older = made.submission([made.run(version="3.17.0", attitude_error=0.5)], day="2026-01-01")
    newer = made.submission(
        {
            "results.csv": [
                made.run(integrator="RK4", attitude_error=1e-5),
                made.run(attitude_error=2.5),
                made.exact(integrator="implicit"),
                made.ended("unsupported", "mujoco 4.0.0 does not model this", integrator="discrete"),
                made.broken(case=CONTACT),
                made.ended("diverged", "not finite at 1 s", case=MECHANISM),
            ],
            "attribution.csv": [made.attribution(quantity="stop_distance", time_step=None)],
            "tradeoff.csv": [made.tradeoff(0.01), made.tradeoff(0.005)],
            "ensemble.csv": [made.ensemble(case=FREE)],
        },
        day="2026-02-01",
    )
    drake = {"engine": "drake", "version": "1.51.1"}
    refused = [
        made.ended("unsupported", "drake 1.51.1 refuses the model: inertia", case=CONTACT, **drake),
        made.ended("unsupported", "drake 1.51.1 refuses the model: inertia", case=CONTACT, integrator="radau1", **drake),
    ]
    without = {"drake": {FREE: "drake has no integrator that can"}}
    other = made.submission([*refused, made.run(case=MECHANISM, **drake)], day="2026-02-02", without_method=without)
    return made.catalogued(older, newer, other)


def test_the_newest_version_of_each_engine_is_listed_with_all_methods(catalogue: Catalogue) -> None:
    page = files(catalogue)[links.scene(FREE)]
    listed = rows(page, "Runs of the newest version of each engine")
    assert [row.split()[:3] for row in listed] == [["mujoco", "4.0.0", name] for name in ("RK4", "Euler", "implicit")]
    assert "own choice" in listed[1]
    assert "own choice" not in listed[0] + listed[2]
    assert " 2.5 " in listed[1]
    assert " exact ≤ 1e-10 " in listed[2]
    assert [row.split()[1] for row in rows(page, "Runs of other versions")] == ["3.17.0"]


def test_failed_refused_unsupported_and_not_run_are_told_apart(catalogue: Catalogue) -> None:
    found = files(catalogue)
    free, contact, mechanism = (found[links.scene(name)] for name in (FREE, CONTACT, MECHANISM))
    assert rows(free, "Engines and methods without a run") == [
        "drake all – unsupported drake has no integrator that can",
        "mujoco 4.0.0 discrete – unsupported mujoco 4.0.0 does not model this row of mujoco 4.0.0",
    ]
    assert rows(contact, "Engines and methods without a run") == [
        "drake 1.51.1 all ⊘ refused drake 1.51.1 refuses the model: inertia row of drake 1.51.1"
    ]
    assert "expectation broken" in rows(contact, "Runs of the newest")[0]
    assert " failed ✗ " in rows(mechanism, "Runs of the newest")[1]
    assert "without a run" not in text(mechanism)


def test_an_engine_of_which_nothing_is_known_is_not_run(catalogue: Catalogue) -> None:
    only = made.catalogued(*catalogue.submissions, made.submission([made.run(engine="dart", version="6.0")], day="2026-03-01"))
    (row,) = (row for row in rows(files(only)[links.scene(CONTACT)], "Engines and methods without") if row.startswith("dart"))
    assert row == "dart all · not run Nothing is known: there is no run of this scene in this engine."


def test_every_number_leads_to_its_raw_row(catalogue: Catalogue) -> None:
    page = files(catalogue)[links.scene(FREE)].partition('<section aria-labelledby="engines">')[2]
    older, newer, _ = catalogue.submissions
    addresses = re.findall(r'href="\.\./(row\.html#[^"]+)"', page)
    assert addresses[:3] == [f"row.html#{newer.key}/results.csv/{place}" for place in (0, 1, 2)]
    assert {f"row.html#{newer.key}/{name}/0" for name in ("tradeoff.csv", "ensemble.csv")} <= set(addresses)
    assert f"row.html#{older.key}/results.csv/0" in addresses


def test_studies_of_the_scene_stand_on_its_page(catalogue: Catalogue) -> None:
    found = files(catalogue)
    free, contact = found[links.scene(FREE)], found[links.scene(CONTACT)]
    assert "1000 1 % (0.5 to 1.8 %) Attitude error, rad 0.001 0.01 0.1 0.5 1.5" in rows(free, "Failures, and quantiles")[0]
    assert [row.split()[3] for row in rows(free, "Runs with several time steps")] == ["10", "5"]
    assert "Distance of the stop, m 0.001 0.0004 0.0005 – row" in rows(contact, "Errors, engine minus truth")[0]
    assert 'id="parts"' not in free


def test_the_physics_has_units_and_the_case_file_is_beside_the_page(catalogue: Catalogue) -> None:
    found = files(catalogue)
    page = text(found[links.scene(MECHANISM)])
    case = load(MECHANISM)
    assert case.title in page
    assert "revolute joints; 2 degrees of freedom" in page
    assert "gravity 9.81 m/s²" in page
    assert f"bodycheck truth {MECHANISM} --certify" in page
    assert found[f"scenes/{MECHANISM}.case.toml"] == case.text
    # The two rods of the case file, with their masses and where their centres of mass begin.
    (body, *_) = rows(found[links.scene(MECHANISM)], "Bodies, and their inertia")
    assert body.split()[1] == "1"
    assert len(rows(found[links.scene(MECHANISM)], "State at t = 0")) == 2


def test_bounds_of_the_truth_are_the_largest_of_any_run(catalogue: Catalogue) -> None:
    bounds = rows(files(catalogue)[links.scene(FREE)], "The largest error of the truth")
    assert "Attitude error ≤ 1e-10 rad" in bounds
    assert "Position error ≤ 1e-12 m" in bounds


def test_the_list_has_a_card_for_each_scene_that_says_what_became_of_default_methods(catalogue: Catalogue) -> None:
    page = files(catalogue)[links.SCENES]
    cards = {text(card).split()[0]: card for card in re.findall(r"<li data-words.*?</li>", page)}
    assert set(cards) == set(catalogue.scenes)
    for name, card in cards.items():
        assert load(name).title in unescape(card)
        assert "<svg" in card
    assert "failed: mujoco" in text(cards[MECHANISM])
    assert "expectation broken: mujoco" in text(cards[CONTACT])
    assert "failed" not in text(cards[FREE])


def test_a_card_shows_the_motion_of_the_truth(tmp_path: Path) -> None:
    own = gathering.read(motions.write_folder(tmp_path / "own"))
    catalogue = made.catalogued(own)
    for name in motions.SCENES:
        scene = catalogue.scenes[name]
        shown = boxes(scene_cards.picture(catalogue, scene))
        expected = boxes(still(scene.case.scene, evenly(motions.exact(name).trajectory)))
        # Places are off by at most 1 % of half the picture of 160 units, and so are the edges that it is scaled to.
        assert np.abs(np.array(shown) - np.array(expected)).max() < 2 * 0.01 * 80 + 0.2  # and numbers have one decimal


def boxes(picture: str) -> list[tuple[float, ...]]:
    """The box of each polygon of a picture: left, top, right and bottom."""
    found = []
    for points in re.findall(r'<polygon points="([^"]+)"', picture):
        corners = np.array([[float(number) for number in corner.split(",")] for corner in points.split()])
        found.append((*corners.min(axis=0), *corners.max(axis=0)))
    return found


def evenly(motion: Trajectory) -> Trajectory:
    """The samples of a motion that are nearest to the instants at which cards read it."""
    return motion.part(np.searchsorted(motion.t, np.linspace(0, motion.t[-1], scene_cards.INSTANTS) * (1 - 1e-12)))


def test_motions_of_two_engines_are_played_beside_the_truth(tmp_path: Path) -> None:
    own = gathering.read(motions.write_folder(tmp_path / "own", [FREE]))
    later = made.header("2026-02-01")["started"]
    other = gathering.read(motions.write_folder(tmp_path / "other", [FREE], "drake", "1.51.1", 0.1, started=later))
    found = files(made.catalogued(own, other))
    script = found[links.motion(FREE)]
    data = json.loads(script.removeprefix("site.motion=").removesuffix(";\n"))
    assert [run["label"] for run in data["runs"]] == ["drake 1.51.1 Euler, 2 ms", "mujoco 4.0.0 Euler, 2 ms"]
    assert [run["attitude_error"] for run in data["runs"]] == [0.1, 0.5]
    assert data["shown"] == [0, 1]
    page = found[links.scene(FREE)]
    assert f'data-motion="../{links.motion(FREE)}"' in page
    assert "Computed by an exact formula" in text(page)
    assert "Checked by 2 independent computations" in text(page)


def test_a_scene_without_motions_says_so(catalogue: Catalogue) -> None:
    found = files(catalogue)
    assert "There is no motion to play" in text(found[links.scene(FREE)])
    assert not [path for path in found if path.startswith("data/motion")]


def test_a_scene_without_a_truth_says_why() -> None:
    source = made.submission([made.ended("unsupported", "no truth")])
    record = {"case": FREE, "timestep": 0.002, "reason": "the motion needs too many steps"}
    found = files(made.catalogued(replace(source, tracks=Tracks({FREE: record}))))
    assert "Truth There is none: the motion needs too many steps." in text(found[links.scene(FREE)])


def test_texts_of_strangers_are_escaped() -> None:
    """Markup that loads nothing may stand in a reason; it is shown as it is."""
    rows_ = [made.ended("crashed", "<b>bold</b> & \"quoted\" 'words'")]
    page = files(made.catalogued(made.submission(rows_)))[links.scene(FREE)]
    assert "<b>bold" not in page
    assert "&lt;b&gt;bold" in page
