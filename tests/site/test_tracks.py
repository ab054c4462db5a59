"""Motions in submissions: what the player gets is what the engine did, and what a stranger may write is bounded."""

import json
import shutil
from base64 import b64encode
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from bodycheck import load
from bodycheck.errors import BadInput
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.trajectory import Array
from bodycheck.reports.runs.motions import tracks as reported
from bodycheck.results.store import Writer
from bodycheck.results.trajectory_files import run_path
from bodycheck.site import scene_motion
from bodycheck.site.submissions import archive, gathering, packing, tracks
from bodycheck.site.submissions.contents import TRACKS
from bodycheck.site.submissions.submission import Submission
from bodycheck.site.submissions.tracks import Course, Motion, Turning
from tests.site import motions
from tests.site import submissions as made

FLIGHT, ON_PLANE, JOINTED, TOUCHING = motions.SCENES


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return motions.write_folder(tmp_path_factory.mktemp("moved") / "results")


@pytest.fixture(scope="module")
def submission(folder: Path) -> Submission:
    return gathering.read(folder)


def motion_of(submission: Submission, case: str) -> Motion:
    return next(one for one in submission.tracks.motions if one.case == case)


def attitudes(turning: Turning, t: Array) -> Array:
    """Attitudes (n, 4) at times (n,), as the player has them."""
    instants, turn, rate = tracks.arrays(turning)
    shares = reported.Turning(instants, turn / reported.LEVELS * np.pi, rate / reported.LEVELS * turning.fastest)
    return reported.played(shares, t)[0]


def places(course: Course, t: Array) -> Array:
    """Places (n, 3) at times (n,), as the player has them."""
    instants, place = tracks.arrays(course)
    values = place / reported.LEVELS * course.farthest
    return np.column_stack([np.interp(t, instants, column) for column in values.T])


def test_every_kind_of_scene_has_its_truth_and_the_run_of_the_own_method(submission: Submission) -> None:
    assert set(submission.tracks.truths) == set(motions.SCENES)
    for name in motions.SCENES:
        motion = motion_of(submission, name)
        assert [(run.engine, run.version, run.integrator) for run in motion.runs] == [("mujoco", "4.0.0", "Euler")]
        assert motion.timestep == motions.TIMESTEP
        assert motion.end == pytest.approx(load(name).duration)


@pytest.mark.parametrize("name", [FLIGHT, ON_PLANE, JOINTED])
def test_stored_attitudes_are_those_of_truth_and_run(name: str, submission: Submission) -> None:
    """To the tolerance that the player tells."""
    case, motion = load(name), motion_of(submission, name)
    exact = motions.exact(case.name).trajectory
    for parts, known in ((motion.truth, exact), (motion.runs[0].parts, motions.turned(exact, 0.5))):
        for place, part in enumerate(parts):
            assert part.turning is not None
            own = known.body(place) if known.quaternion.ndim == 3 else known
            off = geodesic_angle(attitudes(part.turning, own.t), normalise(own.quaternion))
            assert off.max() <= 1.01 * reported.TOLERANCE


def test_stored_places_of_several_bodies_are_in_the_frame_that_is_stored(submission: Submission) -> None:
    """To a hundredth of what the pictures show, as in reports."""
    case, motion = load(JOINTED), motion_of(submission, JOINTED)
    exact = motions.exact(case.name).trajectory
    frame = motion.frame
    assert frame is not None
    for place, part in enumerate(motion.truth):
        assert part.course is not None
        found = places(part.course, exact.t) * frame.extent + np.array(frame.middle)
        assert np.abs(found - exact.position[place]).max() <= 0.0101 * frame.extent


def test_a_motion_in_another_frame_is_shown_at_the_same_places(tmp_path: Path) -> None:
    """The double pendulum of one submission, played beside that of another whose pictures show more."""
    older = gathering.read(motions.write_folder(tmp_path / "older", [JOINTED]))
    newer = gathering.read(
        motions.write_folder(tmp_path / "newer", [JOINTED], "dart", "6.20.0", 0.2, started=made.header("2026-02-01")["started"])
    )
    (wide,) = newer.tracks.motions
    assert wide.frame is not None
    frame = tracks.FrameRecord((1.0, 2.0, 3.0), 3 * wide.frame.extent, wide.frame.azimuth)
    moved = tracks.Motion(wide.case, wide.timestep, wide.end, wide.truth, wide.runs, frame=frame)
    object.__setattr__(newer, "tracks", tracks.Tracks(newer.tracks.truths, [moved]))
    catalogue = made.catalogued(older, newer)
    scene = catalogue.scenes[JOINTED]
    data = scene_motion.played(scene, scene_motion.moving(catalogue, scene))
    assert [run["label"].split()[0] for run in data["runs"]] == ["dart", "mujoco"]
    (own,) = older.tracks.motions
    assert own.frame is not None
    for stored, shown in zip(own.runs[0].parts, data["runs"][1]["parts"], strict=True):
        assert stored.course is not None
        t = tracks.arrays(stored.course)[0]
        before = places(stored.course, t) * own.frame.extent + np.array(own.frame.middle)
        after = places(Course(**shown["course"]), t) * frame.extent + np.array(frame.middle)
        # 16 bits of the larger picture.
        assert np.abs(after - before).max() <= 2 * frame.extent / reported.LEVELS * shown["course"]["farthest"]


def test_a_run_within_the_width_of_a_line_is_stored_as_moving_like_the_truth(tmp_path: Path) -> None:
    close = gathering.read(motions.write_folder(tmp_path / "close", [FLIGHT], angle=1e-6))
    (motion,) = close.tracks.motions
    (part,) = motion.runs[0].parts
    assert part.turning is not None  # its rates are off, by the errors of its row
    exact = motions.exact(FLIGHT).trajectory
    assert geodesic_angle(attitudes(part.turning, exact.t), exact.quaternion).max() <= 1.1 * reported.TOLERANCE


def test_the_same_folder_gives_the_same_bytes_and_they_survive_the_archive(folder: Path, submission: Submission) -> None:
    one, other = packing.contents(folder), packing.contents(folder)
    assert one.files[TRACKS] == other.files[TRACKS]
    read = archive.read(archive.zipped(one))
    assert read.tracks == submission.tracks
    assert tracks.written(read.tracks) == one.files[TRACKS]


def test_a_folder_without_trajectories_still_says_how_its_truths_were_found(tmp_path: Path) -> None:
    left = motions.write_folder(tmp_path / "left", [FLIGHT])
    shutil.rmtree(left / "trajectories")
    found = gathering.read(left).tracks
    assert not found.motions
    assert found.truths[FLIGHT]["model"].startswith("closed form")


def test_a_damaged_trajectory_leaves_the_submission_out(tmp_path: Path) -> None:
    damaged = motions.write_folder(tmp_path / "damaged", [FLIGHT])
    for path in (damaged / "trajectories" / FLIGHT).iterdir():
        path.write_bytes(b"PAR1")
    with pytest.raises(BadInput, match="cannot be read"):
        gathering.read(damaged)


def test_truths_say_nothing_personal(tmp_path: Path) -> None:
    own, case = motions.write_folder(tmp_path / "own", [FLIGHT]), load(FLIGHT)
    known = replace(motions.exact(FLIGHT), backend="/home/someone/bin/solver")
    header: Any = made.header(engines={"mujoco": "4.0.0"})
    with Writer(own, header, motions.IDENTITY, (case,)) as writer:
        writer.add_truth(case, motions.TIMESTEP, known)
    content = packing.contents(own).files[TRACKS].decode()
    assert "solver" in content
    assert "someone" not in content


def _text(*values: float, kind: str = "<f8") -> str:
    return b64encode(np.array(values).astype(kind).tobytes()).decode()


#: What the pictures of several bodies show.
FRAME = {"middle": [0, 0, 0], "extent": 1, "azimuth": 0}

#: What a stranger may have changed in the tracks, and a part of what is said of it.
HOSTILE: dict[str, tuple[Callable[[Any], Any], str]] = {
    "another format": (lambda told: told.update(format=2), "format"),
    "no list": (lambda told: told.update(motions=7), "tracks"),
    "too many motions": (lambda told: told.update(motions=told["motions"] * 3000), "at most"),
    "a case of no file": (lambda told: told["motions"][0].update(case="heavy-top"), "heavy-top"),
    "a truth of no file": (lambda told: told["truths"][0].update(case="heavy-top"), "heavy-top"),
    "another engine": (lambda told: told["motions"][0]["runs"][0].update(engine="drake"), "drake"),
    "a failed method": (lambda told: told["motions"][0]["runs"][0].update(integrator="no-such"), "results.csv"),
    "a motion twice": (lambda told: told["motions"].append(told["motions"][0]), "twice"),
    "a run twice": (lambda told: told["motions"][0]["runs"].append(told["motions"][0]["runs"][0]), "twice"),
    "infinite end": (lambda told: told["motions"][0].update(end=1e300), "end"),
    "no number": (lambda told: told["motions"][0].update(end="x"), "end"),
    "too many bodies": (lambda told: told["motions"][0].update(truth=told["motions"][0]["truth"] * 9), "bodies"),
    "no bodies": (lambda told: told["motions"][0].update(truth=[]), "bodies"),
    "no turning": (lambda told: told["motions"][0]["truth"][0].pop("turning"), "lack"),
    "not base64": (lambda told: told["motions"][0]["truth"][0]["turning"].update(t="no base64!"), "tracks"),
    "half an instant": (lambda told: told["motions"][0]["truth"][0]["turning"].update(t="AAAA"), "instants"),
    "one instant": (lambda told: told["motions"][0]["truth"][0]["turning"].update(t=_text(0.0)), "instants"),
    "descending": (lambda told: told["motions"][0]["truth"][0]["turning"].update(t=_text(1.0, 0.0)), "instants"),
    "not finite": (lambda told: told["motions"][0]["truth"][0]["turning"].update(t=_text(0.0, np.nan)), "instants"),
    "after the end": (lambda told: told["motions"][0]["truth"][0].update(
        turning={"t": _text(0.0, 1e9), "turn": _text(*[0] * 6, kind="<i2"), "rate": _text(*[0] * 6, kind="<i2"), "fastest": 1.0}
    ), "after its end"),
    "fewer turns": (lambda told: told["motions"][0]["truth"][0]["turning"].update(turn="AAAAAAAA"), "three numbers"),
    "very long": (lambda told: told["motions"][0]["truth"][0]["turning"].update(turn="A" * 100_000), "turn"),
    "a frame of one body": (lambda told: told["motions"][0].update(frame=FRAME), "pictures"),
    "markup": (lambda told: told["truths"][0].update(why="<script>alert(1)</script>"), "markup"),
    "a truth of numbers": (lambda told: told["truths"][0].update(model=3), "model"),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_tracks_are_one_clear_error(name: str, tmp_path: Path, hostile: tuple[Any, Any]) -> None:
    change, part = HOSTILE[name]
    contents, told = hostile
    told = json.loads(json.dumps(told))
    change(told)
    changed = type(contents)(contents.header, {**contents.files, TRACKS: json.dumps(told).encode()})
    with pytest.raises(BadInput, match="tracks") as caught:
        archive.read(archive.zipped(changed))
    assert part in str(caught.value)
    assert len(str(caught.value)) < 500


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Any]:
    """The contents of a submission with one flight, and its tracks."""
    contents = packing.contents(motions.write_folder(tmp_path_factory.mktemp("hostile") / "results", [FLIGHT]))
    return contents, json.loads(contents.files[TRACKS])


def test_deep_nesting_and_large_files_are_clear_errors(hostile: tuple[Any, Any]) -> None:
    contents, _ = hostile
    for content in (b"[" * 200_000, b"{}", b"\xff", b" " * (tracks.MOST_BYTES + 1)):
        with pytest.raises(BadInput, match="tracks"):
            tracks.read(content, {}, [])
    assert contents.files[TRACKS]


def test_a_run_at_other_instants_than_its_truth_has_no_motion(tmp_path: Path) -> None:
    """Its truth would have to be computed, which a stranger's case could make as long as he likes."""
    shifted = motions.write_folder(tmp_path / "shifted", [FLIGHT])
    path = shifted / run_path(FLIGHT, "mujoco", "Euler", motions.TIMESTEP)
    table = pq.read_table(path)
    t = table["t"].to_numpy()
    pq.write_table(table.set_column(0, "t", [t * 1.000001]), path)
    assert not gathering.read(shifted).tracks.motions
