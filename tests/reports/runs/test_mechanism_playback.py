"""The animation of a mechanism: what the player reads is the motion of all bodies, to the tolerances that are told."""

from base64 import b64decode
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import parse
from bodycheck.judging.judgement import Verdict, verdict
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import BodyStart, Mechanism
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.runs.motions.animation import animated
from bodycheck.reports.runs.motions.playback import MOST_CHARACTERS, PLACE_TOLERANCE
from bodycheck.results.outcome import Completed, Run
from tests.support.jointed import cart_pole

TIMESTEP = 0.05


@pytest.fixture(scope="module")
def exact() -> Truth:
    return truth(cart_pole(), np.linspace(0, 2, 41))


def played(exact: Truth, *moved: Any) -> Any:
    """The animation of runs whose trajectories are those of the truth and others."""
    scene = exact.scene
    assert isinstance(scene, Mechanism)
    case = replace(parse(TEXT, "f"), scene=scene)
    runs = {}
    for place, motion in enumerate((exact.trajectory, *moved)):
        run = Run("c", "engine", "1", Method.parse(f"scheme-{place}", TIMESTEP), Completed(motion, 40, 1.0), scene=scene)
        runs[run.key.over_cases] = verdict(case, exact, run)
    lines: dict[Line, Verdict] = {line: runs[key] for key, line in assign(list(runs)).items()}
    return animated(scene, lines, {TIMESTEP: exact}, MOST_CHARACTERS)


TEXT = """
format = 1
name = "c"
title = "Any case, whose scene is replaced"
[body]
shape = "sphere"
radius = 1
mass = 1
[run]
duration = 2
samples = 41
"""


def places(course: dict[str, Any], t: np.ndarray) -> np.ndarray:
    at = np.frombuffer(b64decode(course["t"]), "<f8")
    knots = np.frombuffer(b64decode(course["place"]), "<i2").reshape(-1, 3) / 32767 * course["farthest"]
    return np.column_stack([np.interp(t, at, column) for column in knots.T])


def test_the_player_reads_where_all_bodies_are(exact: Truth) -> None:
    data = played(exact).data
    motion, extent = exact.trajectory, data["extent"]
    assert len(data["bodies"]) == len(data["truth"]["parts"]) == 2
    drawn = np.stack([places(part["course"], motion.t) for part in data["truth"]["parts"]])
    shift = motion.position - drawn * extent
    # The middle of the picture is the same for both bodies at all times.
    assert np.abs(shift - shift[0, 0]).max() <= 2.02 * PLACE_TOLERANCE * extent
    assert np.abs(drawn).max() <= 1
    (run,) = data["runs"]
    assert run["position_error"] == 0
    assert "parts" not in run


def test_sticks_end_at_joints_on_both_bodies(exact: Truth) -> None:
    data, (cart, pole) = played(exact).data, exact.trajectory.position[:, 0]
    turn = Rotation.from_quat(exact.trajectory.quaternion[1, 0], scalar_first=True)
    (stick,) = data["bodies"][1]["sticks"]
    joint = pole + turn.apply(np.array(stick[0]) * data["extent"])
    assert joint == pytest.approx(cart + np.array([0, 0, 0.1]))
    assert stick[1] == [0, 0, 0]
    assert data["bodies"][0]["joints"][1] == pytest.approx([0, 0, 0.1 / data["extent"]])


def test_a_run_that_is_seen_to_be_elsewhere_has_parts_of_its_own(exact: Truth) -> None:
    motion = exact.trajectory
    beside = replace(motion, position=motion.position + np.array([[0.0, 0.1, 0.0]]) * np.sin(motion.t)[:, None])
    data = played(exact, beside).data
    own = data["runs"][1]["parts"]
    apart = places(own[0]["course"], motion.t) - places(data["truth"]["parts"][0]["course"], motion.t)
    assert apart[:, 1] * data["extent"] == pytest.approx(0.1 * np.sin(motion.t), abs=2.02 * PLACE_TOLERANCE * data["extent"])
    assert data["shown"][0] == 1


def test_pictures_follow_what_nothing_holds() -> None:
    start = BodyStart(velocity=(3.0, 0.0, 0.0), rotation=(0.0, 0.0, 2.0))
    plain = cart_pole()
    pin = replace(plain.joints[1], child=1, parent=0)
    floating = Mechanism((replace(plain.bodies[0], start=start), plain.bodies[1]), (pin,), gravity=9.81)
    data = played(truth(floating, np.linspace(0, 2, 41))).data
    assert data["follows"]
    # It falls by 20 m, and its bodies stay within its own size.
    assert data["extent"] < 2
    assert kinematics.initial(floating).position.shape == (2, 1, 3)


def test_what_turns_too_fast_is_told(exact: Truth) -> None:
    found = played(exact.at(exact.trajectory.t[::20]))
    assert found.data is None
    assert "There is no animation because a body turns by" in found.notes[0]
