"""Accuracy against cost: methods are compared at equal cost, and the front page and the pages of engines say so first."""

import re
from html import unescape
from typing import Any

import pytest

from bodycheck.reports.runs.choices import ENOUGH, SAME_COST
from bodycheck.site import links
from bodycheck.site.advice import advice
from bodycheck.site.answers import answers
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.cells import cell
from bodycheck.site.costs import standings
from bodycheck.site.costs.chart import chart
from bodycheck.site.front import Front
from bodycheck.site.pages import index
from bodycheck.site.telling import plain
from tests.site import submissions as made
from tests.site.submissions import CONTACT, FREE, catalogued, submission


def studied(**more: Any) -> Catalogue:
    """An engine whose default at 2 ms costs 1 ms/s, with a better method that costs as much at 8 ms, and a dear one at 2 ms."""
    rows = [
        made.tradeoff(0.002, 1e-3, attitude_error=2.0, role="default"),
        made.tradeoff(0.002, 4e-3, integrator="RK4", attitude_error=1e-9),
        made.tradeoff(0.008, 1e-3, integrator="RK4", attitude_error=1e-5),
        made.tradeoff(0.016, 5e-4, integrator="RK4", attitude_error=5e-4),
        made.tradeoff(0.002, 1.1e-3, integrator="implicitfast", attitude_error=1.9, role="recommended"),
    ]
    runs = [made.run(attitude_error=2.0, role="default"), made.run(integrator="RK4", attitude_error=1e-9)]
    return catalogued(submission({"results.csv": runs, "tradeoff.csv": rows} | more))


def test_the_best_method_is_the_most_accurate_one_at_the_cost_of_the_default_and_not_at_its_step() -> None:
    catalogue = studied()
    one = standings.standing(catalogue, "mujoco", catalogue.scenes[FREE])
    assert one is not None
    assert (one.usual.run.method, one.default, one.repeated) == (("Euler", 0.002), True, True)
    assert one.best.run.method == ("RK4", 0.008)
    assert one.best.cost <= SAME_COST * one.usual.cost
    assert one.recommended is not None
    assert one.recommended.run.method == ("implicitfast", 0.002)
    assert one.gain == pytest.approx(2e5)


def test_the_cheapest_accurate_method_is_found_among_all_steps() -> None:
    costs = standings.shown(studied())[0]
    assert costs.cheapest is not None
    assert costs.cheapest.run.method == ("RK4", 0.016)
    assert costs.cheapest.error <= ENOUGH


def test_processor_time_counts_and_not_the_time_on_the_wall() -> None:
    waited = made.tradeoff(0.002, 1e-3, processor_time_per_step=5e-7, time_per_step=2e-6, role="default")
    catalogue = catalogued(submission({"results.csv": [made.run(role="default")], "tradeoff.csv": [waited]}))
    one = standings.standing(catalogue, "mujoco", catalogue.scenes[FREE])
    assert one is not None
    assert one.usual.cost == pytest.approx(1e-3 * 5e-7 / 2e-6)


def test_without_a_study_the_runs_themselves_have_costs_that_were_measured_once() -> None:
    fast, slow = (
        made.run(attitude_error=1.0, role="default"),
        made.run(integrator="RK4", attitude_error=1e-6, realtime_factor=100.0),
    )
    catalogue = catalogued(submission([fast, slow]))
    one = standings.standing(catalogue, "mujoco", catalogue.scenes[FREE])
    assert one is not None
    assert (one.repeated, one.best.run.method[0]) == (False, "Euler")  # RK4 costs five times as much at this step


def test_the_picture_has_a_mark_for_each_method_and_names_each_engine() -> None:
    costs = standings.shown(studied())[0]
    drawn = str(chart(costs, 640, 430))
    assert ">mujoco</text>" in drawn
    assert drawn.count('class="open"') == 2  # the default, and the recommended method
    assert drawn.count('class="chosen"') == 1
    places = [float(number) for number in re.findall(r'(?:cx|cy|x|y)="(-?[0-9.]+)"', drawn)]
    assert min(places) >= 0
    assert max(places) <= 640


def test_the_front_page_opens_with_what_to_take_and_what_is_wrong_with_the_default() -> None:
    catalogue = studied()
    page = next(index.pages(catalogue)).content.decode()
    found = unescape(re.sub(r"<[^>]+>", " ", page.partition('<div class="opening')[2].partition("<details")[0]))
    words = " ".join(found.split())
    assert "Of 5 methods of 1 engine in " in words
    assert "mujoco with RK4 at 16 ms is the cheapest that stays within 0.001 rad" in words
    assert "1 of 1 default is off by more than 0.001 rad there, mujoco’s Euler at 2 ms by 2 rad" in words
    assert words.index("Accurate at low cost") < words.index("Defaults") < words.index("Scenes")
    assert page.index('class="costs"') < page.index('id="matrix"')


def test_without_costs_the_front_page_still_says_where_scenes_are() -> None:
    catalogue = catalogued(submission({"audit.csv": [made.audit()]}))
    said = {one.subject: plain(one.sentence) for one in answers(catalogue, None, Front(catalogue).news)}
    assert said.keys() == {"Changes", "Scenes"}


def test_the_page_of_an_engine_says_first_what_to_take_and_what_to_mind() -> None:
    catalogue = studied()
    found = [(scene, cell(catalogue, "mujoco", scene)) for scene in catalogue.scenes.values()]
    said = {one.subject: plain(one.sentence) for one in advice(catalogue, "mujoco", found, (), standings.shown(catalogue))}
    assert list(said) == ["Use it for", "Mind", "Contact"]
    assert said["Use it for"].startswith("At no more than the cost of its own method take RK4 at 8 ms: in ")
    assert "Euler at 2 ms is off by more than 0.001 rad or m in 1 scene without contact" in said["Mind"]
    assert said["Contact"].startswith("No results")


def test_every_number_of_the_advice_leads_to_its_row() -> None:
    catalogue = studied()
    found = [(scene, cell(catalogue, "mujoco", scene)) for scene in catalogue.scenes.values()]
    for one in advice(catalogue, "mujoco", found, (), standings.shown(catalogue)):
        for piece in one.sentence:
            if re.fullmatch(r"[0-9.e-]+ (?:rad|m)", piece.text):
                assert piece.address.startswith(links.ROW)


def test_the_law_of_contact_is_told_from_the_properties() -> None:
    rows = {"contact.csv": [made.contact()], "contact_properties.csv": [made.contact_property()]}
    catalogue = studied(**rows)
    found = [(scene, cell(catalogue, "mujoco", scene)) for scene in catalogue.scenes.values()]
    said = {one.subject: plain(one.sentence) for one in advice(catalogue, "mujoco", found, (), ())}
    assert said["Contact"] == "At its defaults friction lets a box that it should hold creep at 0.005 m/s."


def test_what_is_left_out_and_contact_are_in_the_navigation_only_where_there_is_any() -> None:
    assert [title for _, title in links.main(studied())] == ["Results", "Scenes", "Robots", "Compare"]
    with_contact = studied(**{"contact.csv": [made.contact(scene=CONTACT)]})
    assert (links.CONTACT, "Contact") in links.main(with_contact)
