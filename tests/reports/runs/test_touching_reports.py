"""Reports of bodies that touch: the player has their plane, and no body of a truth that mechanics does not give."""

import math
from base64 import b64decode
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from bodycheck import load
from bodycheck.casefile.content import Case
from bodycheck.console import truths
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict, verdict
from bodycheck.reference.contact.motion import EventKind
from bodycheck.reference.mechanisms.control import Samples
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.runs import scenes
from bodycheck.reports.runs.motions.animation import animated
from bodycheck.reports.runs.motions.playback import MOST_CHARACTERS, PLACE_TOLERANCE
from bodycheck.reports.runs.scenes import Told, describe
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Run
from tests.support.campaigns import run_all
from tests.support.cases import shortened


def played(case: Case, results: Any) -> Any:
    """The animation of the stored runs of a case."""
    timestep = results.runs()[0].method.timestep
    exact = results.truth(case.name, timestep)
    runs: dict[RunKey, Verdict] = {run.key.over_cases: verdict(case, exact, run) for run in results.runs()}
    lines: dict[Line, Verdict] = {line: runs[key] for key, line in assign(list(runs)).items()}
    return animated(case.scene, lines, {timestep: exact}, MOST_CHARACTERS).data


def first_place(part: dict[str, Any]) -> np.ndarray:
    course = part["course"]
    return np.frombuffer(b64decode(course["place"]), "<i2").reshape(-1, 3)[0] / 32767 * course["farthest"]


@pytest.fixture(scope="module")
def brick(tmp_path_factory: pytest.TempPathFactory) -> tuple[Case, Any]:
    case = shortened(load("dropped-brick-corner"), 2.0, 101)
    return case, run_all(case, ["mujoco"], tmp_path_factory.mktemp("brick"), 0.002)


def test_a_run_whose_truth_ends_is_judged_by_what_must_hold(brick: tuple[Case, Any]) -> None:
    case, results = brick
    exact = results.truth(case.name, results.runs()[0].method.timestep)
    assert isinstance(exact, Truth)
    assert np.isnan(exact.trajectory.position[-1]).all()
    (event,) = exact.events
    assert math.isnan(event.velocity[0])  # which is stored as null
    for own in judgement.judge(results):
        assert own.outcome.status == "ok"
        assert own.discrepancy is not None
        found = own.discrepancy.maxima()
        assert not any(math.isnan(value) for value in found.values())
        assert found["position_error"] < 0.01  # what a time step of 2 ms adds until the first touch
        assert found["tilt"] < 1e-6  # the brick lies on a face
        assert found["energy_gain"] < 0.01
        assert found["impact_time_error"] < 0.02  # within the time constant of MuJoCo's contacts
        assert "impact_speed_error" not in found
        assert "rest_time_error" not in found


def test_the_player_ends_the_truth_where_mechanics_does(brick: tuple[Case, Any]) -> None:
    case, results = brick
    data = played(case, results)
    assert data["known"] == 0.26  # the last sample before the brick hits at 0.2656 s
    assert all("parts" in run for run in data["runs"])
    (told,) = [fact for fact in describe(case, [Told.of(truth(case.scene, case.instants))]) if fact.term == "Events"]
    assert told.text == "the body hits after 0.2656 s"


def test_the_player_draws_the_inclined_plane_under_the_ball(tmp_path: Path) -> None:
    case = shortened(load("ball-on-ramp"), 0.5, 26)
    results = run_all(case, ["mujoco"], tmp_path, 0.002)
    data = played(case, results)
    plane = case.scene.plane
    assert plane is not None
    ends = np.array(data["ground"]).reshape(-1, 3)
    heights = ends @ np.array(plane.normal)
    np.testing.assert_allclose(heights, heights[0], atol=1e-12)
    assert data["known"] == data["end"]
    # The ball is drawn above the plane by its radius, to the tolerance of places in every component.
    ball = data["bodies"][0]["solid"]["semi_axes"][0]
    above = first_place(data["truth"]["parts"][0]) @ np.array(plane.normal) - heights[0]
    assert above == pytest.approx(ball, abs=2 * PLACE_TOLERANCE)


def test_facts_tell_planes_contacts_pushes_and_loads() -> None:
    pushed, stack = load("simbenchmark-rolling"), load("stack-mass-ratio")
    facts = {fact.term: fact.text for fact in describe(pushed, [])}
    assert "on a plane with friction coefficient 0.4" in facts["Environment"]
    assert "pushed box with (75, 129.9, 0) N" in facts["Environment"]
    told = {fact.term: fact.text for fact in describe(stack, [Told.of(truth(stack.scene, np.array([0.0, 1.0])))])}
    assert told["Loads"].startswith("the plane bears ")


def test_a_completed_run_keeps_its_truth_and_loads(tmp_path: Path) -> None:
    case = shortened(load("stack-mass-ratio"), 2.0, 5)
    results = run_all(case, ["mujoco"], tmp_path, 0.002)
    exact = results.truth(case.name, results.runs()[0].method.timestep)
    assert isinstance(exact, Truth)
    assert exact.interfaces == truth(case.scene, case.instants).interfaces
    for run in results.runs():
        assert isinstance(run, Run)
        assert isinstance(run.outcome, Completed)
        assert run.outcome.interfaces is not None
        assert {pair.bodies for pair in run.outcome.interfaces} == {pair.bodies for pair in exact.interfaces}
    for own in judgement.judge(results):
        assert own.discrepancy is not None
        assert {"load_error", "contact_losses", "creep"} <= own.discrepancy.maxima().keys()


def test_fingers_are_told_with_torsional_friction_and_the_turn_of_their_body() -> None:
    """The fingers loosen until torsional friction no longer holds the body, which turns and comes to rest again."""
    case = load("gripped-block-turns")
    assert isinstance(case.scene, Mechanism)
    looser = Samples((0.0, 0.1), (30.0, 15.0))
    slower = tuple(replace(each, effort=looser) for each in case.scene.controllers)
    loosened = replace(case, scene=replace(case.scene, controllers=slower))
    exact = Told.of(truth(loosened.scene, np.array([0.0, 0.7])))
    facts = {fact.term: fact.text for fact in describe(loosened, [exact])}
    assert facts["Events"].startswith("block begins to turn about its contacts after 0.1 s; block comes to rest after 0.61")
    assert "friction coefficient 0.8 and torsional friction 0.004 m, and coefficient of restitution 0" in facts["Environment"]


def test_every_kind_of_event_has_words() -> None:
    assert set(scenes.EVENTS) == set(truths.EVENTS) == set(get_args(EventKind))
