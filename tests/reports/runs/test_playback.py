"""Thin tracks play what was sampled to the stated tolerances, and what cannot be played so is told of."""

import json
import math
from base64 import b64decode
from dataclasses import replace
from importlib import resources
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from bodycheck import load, simulate, truth
from bodycheck.adapters.contract import Method
from bodycheck.judging.judgement import Verdict, verdict
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth
from bodycheck.reports import player
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.runs.motions import playback as playing
from bodycheck.reports.runs.motions import tracks
from bodycheck.reports.runs.motions.animation import animated
from bodycheck.reports.runs.motions.cast import MOST_SHOWN
from bodycheck.reports.runs.motions.playback import MOST_CHARACTERS, Playback
from bodycheck.results.outcome import Completed
from tests.support.cases import shortened
from tests.support.truths import truth_for_runs
from tests.support.wording import facts

#: What a note says of an animation.
NOTES = ("no animation", "leaves out", "small", "too far")

FLIP, SLIDE, SHAPELESS, STILL = "intermediate-axis-flip", "curling-brick", "dumbbell", "projectile"
METHODS = {
    "mujoco": ("Euler", "RK4", "implicit"),
    "pinocchio": ("semi-implicit-euler", "body-twist-euler", "rk4"),
}
Played = tuple[dict[Line, Verdict], dict[float, Truth]]

components = st.floats(-1, 1)
directions = (
    st.tuples(components, components, components)
    .filter(lambda v: math.hypot(*v) > 0.1)
    .map(lambda v: np.array(v) / math.hypot(*v))
)


def tumble(t: Array, one: Array, other: Array, rates: tuple[float, float, float, float]) -> tuple[Array, Array]:
    """Attitudes (n, 4) and body rates (n, 3) of a turn about one axis after a turn about another, both exactly known."""
    a, b, c, d = rates
    first, second = a * t + np.sin(c * t), b * t + np.cos(d * t)
    outer, inner = Rotation.from_rotvec(first[:, None] * one), Rotation.from_rotvec(second[:, None] * other)
    rate = inner.inv().apply((a + c * np.cos(c * t))[:, None] * one) + (b - d * np.sin(d * t))[:, None] * other
    return (outer * inner).as_quat(scalar_first=True), rate


@settings(max_examples=30)
@given(directions, directions, st.tuples(*[st.floats(-9, 9)] * 4), st.integers(400, 5000))
def test_a_thin_track_stays_within_its_tolerances(
    one: Array, other: Array, rates: tuple[float, float, float, float], samples: int
) -> None:
    t = np.linspace(0, 6, samples)
    quaternion, rate = tumble(t, one, other, rates)
    track = tracks.turning(t, quaternion, rate, 0.2)
    assert track is not None
    assert len(track.t) <= tracks.MOST_INSTANTS
    rows = tracks.checked(samples)
    attitudes, speeds = tracks.played(track, t[rows])
    assert geodesic_angle(attitudes, quaternion[rows]).max() <= tracks.TOLERANCE
    assert np.linalg.norm(speeds - rate[rows], axis=1).max() <= 0.2
    between = (t[1:] + t[:-1]) / 2
    attitudes, _ = tracks.played(track, between)
    assert geodesic_angle(attitudes, tumble(between, one, other, rates)[0]).max() <= 1.5 * tracks.TOLERANCE


def test_a_track_is_thin() -> None:
    """Ten seconds of flip, 1001 samples of 100 rad, in fewer than a tenth of the instants."""
    motion = truth(load(FLIP)).trajectory
    track = tracks.turning(motion.t, motion.quaternion, motion.angular_velocity, 0.1)
    assert track is not None
    assert len(track.t) < 100


@settings(max_examples=20)
@given(st.lists(st.booleans(), min_size=81, max_size=81))
def test_the_sign_of_a_quaternion_means_nothing(flipped: list[bool]) -> None:
    t = np.linspace(0, 4, 81)
    quaternion, rate = tumble(t, np.array([0, 0.6, 0.8]), np.array([1.0, 0, 0]), (3, 2, 1, 1))
    track, other = (tracks.turning(t, q, rate, 0.1) for q in (quaternion, np.where(flipped, -1, 1)[:, None] * quaternion))
    assert track is not None
    assert other is not None
    assert track.encoded() == other.encoded()


def test_attitudes_go_on_across_half_a_turn() -> None:
    """A rotation vector jumps there, and neither the attitude nor its rate may."""
    t = np.linspace(0, 10, 1001)
    quaternion, rate = tumble(t, np.array([0, 0, 1.0]), np.array([0, 0, 1.0]), (2, 1, 0, 0))
    track = tracks.turning(t, quaternion, rate, 0.1)
    assert track is not None
    assert np.abs(np.diff(track.turn, axis=0)).max() > math.pi
    attitudes, speeds = tracks.played(track, np.linspace(0, 10, 9973))
    assert geodesic_angle(attitudes[:-1], attitudes[1:]).max() == pytest.approx(3 * 10 / 9972, rel=0.05)
    assert np.linalg.norm(speeds, axis=1) == pytest.approx(3, rel=1e-2)


def test_what_is_too_fast_is_not_played() -> None:
    t, axis = np.linspace(0, 10, 1001), np.array([0, 0, 1.0])
    for speed in (150.0, 110.0):  # 1.5 rad from sample to sample, and 1100 rad in all
        quaternion, rate = tumble(t, axis, axis, (speed, 0, 0, 0))
        assert tracks.turning(t, quaternion, rate, 1.0) is None
    # Whole turns between samples look like none, but not to the rates.
    aliased, _ = tumble(t, axis, axis, (0.01, 0, 0, 0))
    turns_between = np.tile(axis * 200 * math.pi, (1001, 1))
    assert tracks.turning(t, aliased, turns_between, 1.0) is None


def test_a_course_tells_its_own_miss() -> None:
    t = np.linspace(0, 3, 601)
    place = np.column_stack([np.sin(5 * t), t**2, 40 * t])
    for tolerance in (1e-2, 1e-1):
        course = tracks.course(t, place, tolerance)
        between = np.column_stack([np.interp(t, course.t, column) for column in course.place.T])
        assert np.linalg.norm(between - place, axis=1).max() == pytest.approx(course.within)
        assert course.within < 1.8 * tolerance  # three components, each within the tolerance, and rounding
    noise = np.random.default_rng(0).random((601, 3))
    assert len(tracks.course(t, noise, 1e-3).t) == tracks.MOST_INSTANTS
    assert tracks.course(t, noise, 1e-3).within > 1e-2


def test_what_is_stored_comes_back() -> None:
    t = np.linspace(0, 4, 401)
    quaternion, rate = tumble(t, np.array([0, 0.6, 0.8]), np.array([1.0, 0, 0]), (3, 2, 1, 1))
    track = tracks.turning(t, quaternion, rate, 0.1)
    assert track is not None
    stored = json.loads(json.dumps(track.encoded()))
    assert (shares(stored["turn"], math.pi) == track.turn).all()
    assert (shares(stored["rate"], stored["fastest"]) == track.rate).all()
    assert (np.frombuffer(b64decode(stored["t"]), "<f8") == track.t).all()
    assert stored["fastest"] == np.abs(track.rate).max()


def shares(text: str, scale: float) -> Array:
    return np.asarray(np.frombuffer(b64decode(text), "<i2").reshape(-1, 3) / 32767 * scale)


@pytest.mark.parametrize("samples", [2, 3, 4000, 4001, 4002, 100_001])
def test_a_track_is_checked_at_both_ends_and_evenly(samples: int) -> None:
    rows = tracks.checked(samples)
    assert rows[0] == 0
    assert rows[-1] == samples - 1
    assert len(rows) <= tracks.MOST_CHECKED
    assert len(rows) == samples or np.diff(rows)[:-1].max() == np.diff(rows)[:-1].min()


def runs_of(name: str, duration: float, samples: int, *timesteps: float) -> Played:
    case = shortened(load(name), duration, samples)
    exact = {timestep: truth_for_runs(case, timestep) for timestep in timesteps}
    judged = [
        verdict(case, exact[timestep], simulate(case, engine, integrator, timestep))
        for timestep in timesteps
        for engine, integrators in METHODS.items()
        for integrator in integrators
    ]
    lines = assign(verdict.key.over_cases for verdict in judged)
    return {lines[one.key.over_cases]: one for one in judged}, exact


@pytest.fixture(scope="module")
def flips() -> Played:
    return runs_of(FLIP, 4.0, 401, 0.002)


def played(name: str, runs: Played, most: int = MOST_CHARACTERS) -> Playback:
    found = animated(load(name).scene, *runs, most)
    assert found is not None
    return found


def data_of(name: str, runs: Played, most: int = MOST_CHARACTERS) -> Any:
    data = played(name, runs, most).data
    assert data is not None
    return data


def test_runs_that_turn_as_the_truth_are_not_stored_again(flips: Played) -> None:
    by_label = {run["label"]: run for run in data_of(FLIP, flips)["runs"]}
    assert set(by_label) == {f"{engine} {integrator}" for engine, own in METHODS.items() for integrator in own}
    for line, one in flips[0].items():
        assert one.discrepancy is not None
        maxima, run = one.discrepancy.maxima(), by_label[line.label]
        # Written with four digits.
        assert run["attitude_error"] == pytest.approx(maxima["attitude_error"], rel=1e-3)
        assert ("turning" in run) == (line.integrator not in ("RK4", "rk4"))
        assert ("course" in run) == (maxima["position_error"] > 0.01 * math.hypot(0.1, 0.2, 0.3))


def test_shown_first_are_the_worst_of_each_engine_and_the_best(flips: Played) -> None:
    data = data_of(FLIP, flips)
    errors = {line.label: one.discrepancy.maxima()["attitude_error"] for line, one in flips[0].items() if one.discrepancy}
    first = [data["runs"][place]["label"] for place in data["shown"]]
    assert len(first) == MOST_SHOWN
    assert errors[first[0]] == max(error for label, error in errors.items() if label.startswith("mujoco"))
    assert errors[first[1]] == max(error for label, error in errors.items() if label.startswith("pinocchio"))
    assert errors[first[2]] == min(errors.values())


def test_a_small_room_keeps_what_is_shown_first(flips: Played) -> None:
    whole = data_of(FLIP, flips)
    shown = [whole["runs"][place] for place in whole["shown"]]
    room = sum(len(json.dumps(entry, separators=(",", ":"))) for entry in (whole["truth"], *shown))
    small = played(FLIP, flips, room + 10)
    assert small.data is not None
    assert {run["label"] for run in small.data["runs"]} >= {run["label"] for run in shown}
    assert len(json.dumps(small.data, separators=(",", ":"))) < room + 1000
    assert len(small.data["runs"]) < len(whole["runs"])
    (note,) = small.notes
    assert facts(note, *NOTES)[:2] == ["leaves out", "small"]
    kept = {run["label"] for run in small.data["runs"]}
    assert all((run["label"] in note) != (run["label"] in kept) for run in whole["runs"])


def test_without_room_nothing_is_played(flips: Played) -> None:
    found = played(FLIP, flips, 100)
    assert found.data is None
    assert [facts(note, *NOTES) for note in found.notes] == [["no animation", "small"]]


def test_a_run_that_goes_too_far_is_told_of_and_left_out(flips: Played) -> None:
    """Its turning is played all the same where it flies; on a plane, where the place is what is drawn, it is not."""
    far = {line: astray(one, 1e12) for line, one in flips[0].items() if line.integrator == "Euler"}
    (run,) = data_of(FLIP, (far, flips[1]))["runs"]
    assert "course" not in run
    assert "turning" in run
    runs, truths = runs_of(SLIDE, 0.8, 41, 0.002)
    found = played(
        SLIDE, ({line: astray(one, 1e12) if line.integrator == "Euler" else one for line, one in runs.items()}, truths)
    )
    assert found.data is not None
    assert "mujoco Euler" not in [run["label"] for run in found.data["runs"]]
    assert facts(found.notes[-1], *NOTES, "mujoco Euler", "mujoco RK4")[-2:] == ["too far", "mujoco Euler"]


def astray(one: Verdict, by: float) -> Verdict:
    """The same run, ever farther away."""
    assert isinstance(one.outcome, Completed)
    motion = one.outcome.trajectory
    moved = replace(motion, position=motion.position + np.linspace(0, by, len(motion))[:, None])
    return replace(one, outcome=replace(one.outcome, states=moved))


def test_a_hundred_cases_of_twenty_methods_stay_small(flips: Played) -> None:
    runs, truths = flips
    more = {}
    for copy in range(4):
        for one in runs.values():
            other = replace(one, run=replace(one.run, method=Method.parse(f"{one.run.method.name}-{copy}", 0.002)))
            more[replace(assign([other.key.over_cases])[other.key.over_cases])] = other
    data = data_of(FLIP, (more, truths), MOST_CHARACTERS // 100)
    assert 100 * len(json.dumps(data, separators=(",", ":"))) < 1.1 * MOST_CHARACTERS


def test_a_body_on_the_plane_has_its_own_course() -> None:
    """Everyone's places, to a hundredth of the body's reach: that is what is seen of a slide."""
    runs = runs_of(SLIDE, 0.8, 401, 0.002)
    data = data_of(SLIDE, runs)
    assert data["plane"]
    reach = data["body"]["reach"]
    assert reach == math.hypot(0.1, 0.2, 0.05)
    exact = runs[1][0.002].trajectory
    for entry, motion in ((data["truth"], exact), *((run, trajectory_of(runs[0], run["label"])) for run in data["runs"])):
        course = entry["course"]
        at = np.frombuffer(b64decode(course["t"]), "<f8")
        places = shares(course["place"], course["farthest"])
        drawn = np.column_stack([np.interp(motion.t, at, column) for column in places.T])
        assert np.abs(drawn - motion.position / reach).max() <= 1.01 * playing.PLACE_TOLERANCE
        assert course["within"] < 0.02


def trajectory_of(runs: dict[Line, Verdict], label: str) -> Any:
    return next(one.run.outcome.trajectory for line, one in runs.items() if line.label == label)  # type: ignore[union-attr]


def test_the_common_time_step_is_played_and_named(flips: Played) -> None:
    runs, truths = runs_of(FLIP, 4.0, 401, 0.002, 0.004)
    dropped = next(iter(runs))
    fewer = {line: one for line, one in runs.items() if line != dropped}
    found = played(FLIP, (fewer, truths))
    assert found.data is not None
    assert [facts(note, *NOTES, "time step") for note in found.notes] == [["time step", "4"]]
    assert len(found.data["runs"]) == 6
    assert all("ms" not in run["label"] for run in found.data["runs"])


def test_a_body_without_a_shape_is_drawn_as_its_ellipsoid() -> None:
    runs = runs_of(SHAPELESS, 1.0, 101, 0.002)
    found = played(SHAPELESS, runs)
    assert found.data is not None
    assert [facts(note, *NOTES, "no shape", "ellipsoid") for note in found.notes] == [["no shape", "ellipsoid"]]
    body, scene = found.data["body"], load(SHAPELESS).scene
    a, b, c = (length * body["reach"] for length in body["semi_axes"])
    expected = [scene.body.mass / 5 * (one**2 + other**2) for one, other in ((b, c), (a, c), (a, b))]
    assert expected == pytest.approx(scene.body.moments)
    assert body["turned"] == scene.body.axes


def test_where_nothing_turns_nothing_is_played() -> None:
    found = played(STILL, runs_of(STILL, 0.5, 51, 0.002))
    assert found.data is None
    assert [facts(note, *NOTES, "nothing rotates") for note in found.notes] == [["no animation", "nothing rotates"]]


def test_a_truth_that_is_too_fast_is_told_of() -> None:
    """Four rad from sample to sample."""
    case = shortened(load("extreme-spin"), 4.0, 11)
    exact = truth_for_runs(case, 0.002)
    one = verdict(case, exact, simulate(case, "mujoco", "RK4", 0.002))
    line = assign([one.key.over_cases])[one.key.over_cases]
    found = animated(case.scene, {line: one}, {0.002: exact}, MOST_CHARACTERS)
    assert found is not None
    assert found.data is None
    assert facts(found.notes[0], *NOTES, "turns")[:3] == ["no animation", "turns", "1"]


def test_without_a_truth_there_is_no_playback(flips: Played) -> None:
    assert animated(load(FLIP).scene, flips[0], {}, MOST_CHARACTERS) is None


def test_the_player_is_small() -> None:
    """What it adds to a page, in bytes."""
    assert len(player.script().encode()) + len(player.style().encode()) < 44_000
    assert len(player.script([{"bodies": []}]).encode()) - len(player.script([None, {"body": {}}]).encode()) < 12_000


def test_the_player_has_every_file_of_its_folder() -> None:
    folder = resources.files("bodycheck.reports") / "templates" / "player"
    assert sorted((*player.PLAYER, player.AT_ONCE, player.LATER)) == sorted(
        path.name.removesuffix(".js") for path in folder.iterdir()
    )
