"""The command estimate: verdicts and intervals against truths, and files of robots."""

import csv
import json
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import bodycheck
from bodycheck.errors import BadInput
from bodycheck.studies.estimate import factors
from bodycheck.studies.estimate.interface import EstimateResults
from bodycheck.studies.estimate.quantities import AT_END
from bodycheck.studies.estimate.rows import ESTIMATE, EstimateRow

COLUMNS = "file,engine,version,integrator,timestep,quantity,estimate,low,high,order,verdict,reason,horizon,cost"

#: A pendulum with an actuator, a keyframe and a floor that it does not reach.
PENDULUM = """<mujoco model="pendulum">
  <option timestep="0.004" integrator="RK4"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1" pos="0 0 -3"/>
    <body name="arm"><joint name="swing" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -1" size="0.02"/></body>
  </worldbody>
  <actuator><motor name="push" joint="swing"/></actuator>
  <keyframe><key name="raised" qpos="1.5"/></keyframe>
</mujoco>
"""


#: The first instant (s) at which 1.1e-16 times the growth of the truth of chain-in-space exceeds 1e-3.
CHAOTIC_FROM = 8.55


def rows_of(results: EstimateResults, quantity: str) -> list[EstimateRow]:
    return [row for row in results.rows if row.quantity == quantity]


@pytest.fixture(scope="module")
def tumbling() -> EstimateResults:
    return bodycheck.estimate("free-brick", engine="mujoco", integrator="RK4", duration=2.0, blind=True, error=1e-5)


def test_the_intervals_contain_the_true_errors(tumbling: EstimateResults) -> None:
    from dataclasses import replace

    case = replace(bodycheck.load("free-brick"), duration=2.0, samples=_samples("free-brick", 2.0))
    truth = bodycheck.truth(case)
    checked = 0
    for row in rows_of(tumbling, "attitude_error"):
        assert row.verdict == ESTIMATE
        run = bodycheck.simulate(case, engine="mujoco", integrator=row.integrator, timestep=row.timestep)
        error = bodycheck.compare(truth, run).maxima()["attitude_error"]
        assert row.low is not None
        assert row.high is not None
        assert row.low <= error <= row.high, row
        checked += 1
    assert checked >= 8


@pytest.mark.slow
def test_steps_that_the_search_tried_lie_between_the_levels_beside_them() -> None:
    """Errors of RK4 on a cart with a pole fall faster than the claimed order at large steps."""
    found = bodycheck.estimate("cart-pole", engine="mujoco", integrator="RK4", blind=True)
    rows = sorted(rows_of(found, "attitude_error"), key=lambda row: row.timestep)
    known = [(row.timestep, row.estimate) for row in rows if row.estimate and row.timestep >= 0.004]
    assert len(known) > 6
    slopes = [np.log(above / below) / np.log(h / fine) for (fine, below), (h, above) in pairwise(known)]
    assert min(slopes) > 3.5, slopes


def _samples(name: str, duration: float) -> int:
    case = bodycheck.load(name)
    return max(1, round((case.samples - 1) * duration / case.duration)) + 1


def test_the_order_of_a_smooth_motion_is_that_of_the_method(tumbling: EstimateResults) -> None:
    orders = [row.order for row in rows_of(tumbling, "attitude_error") if row.timestep in (0.004, 0.008)]
    assert np.allclose(np.array(orders, float), 4, atol=0.5)  # the errors are not quite a power of the step


def test_every_run_has_a_row_for_the_largest_error_and_for_that_at_the_end(tumbling: EstimateResults) -> None:
    largest, last = (rows_of(tumbling, f"attitude_error{end}") for end in ("", AT_END))
    assert [row.timestep for row in largest] == [row.timestep for row in last]
    assert all(row.estimate <= other.high for row, other in zip(last, largest, strict=True) if row.low)


def test_the_search_uses_most_of_the_allowed_error(tumbling: EstimateResults) -> None:
    highs = {row.timestep: row.high for row in rows_of(tumbling, "attitude_error") if row.high is not None}
    kept = [high for high in highs.values() if high <= 1e-5]
    # A step that is 4 % smaller than the largest has an error of fourth order that is 15 % smaller.
    assert max(kept) >= 0.85e-5


def test_a_chaotic_scene_is_chaotic_beyond_an_instant() -> None:
    results = bodycheck.estimate(
        "chain-in-space", engine="mujoco", integrator="RK4", duration=12.0, blind=True, quantity="attitude_error"
    )
    verdicts = {row.verdict for row in results.rows if row.verdict not in ("diverged", "reset")}
    assert len(verdicts) == 1
    word, _, instant = verdicts.pop().rpartition(" ")
    assert word == "chaotic beyond"
    assert abs(float(instant) - CHAOTIC_FROM) <= 0.3 * CHAOTIC_FROM
    assert all(row.horizon is None or row.horizon < float(instant) for row in results.rows)


def test_an_unstable_step_is_diverged_or_reset() -> None:
    results = bodycheck.estimate("intermediate-axis-flip", engine="mujoco", integrator="Euler", blind=True, quantity="attitude")
    failed = [row for row in results.rows if row.verdict in ("diverged", "reset")]
    assert failed
    assert all(row.estimate is None and row.low is None and row.high is None and row.reason for row in failed)


def test_the_table_has_the_columns_in_their_order(tmp_path: Path) -> None:
    path = tmp_path / "pendulum.xml"
    path.write_text(PENDULUM)
    out = tmp_path / "out"
    results = bodycheck.estimate(path, engine="mujoco", integrator="RK4", out=out)
    text = (out / "estimate.csv").read_text()
    assert text.splitlines()[0] == COLUMNS
    assert (out / "report.html").is_file()
    read = list(csv.DictReader(text.splitlines()))
    assert {row["file"] for row in read} == {"pendulum.xml"}
    own = next(row for row in results.rows if row.timestep == 0.004 and row.quantity == "joint_position_error")
    assert own.verdict == ESTIMATE
    assert own.estimate is not None
    assert 0 < own.estimate < 1e-6


def test_the_first_keyframe_is_the_start_and_controls_act(tmp_path: Path) -> None:
    path, controls = tmp_path / "pendulum.xml", tmp_path / "controls.csv"
    path.write_text(PENDULUM)
    controls.write_text("t,push\n0,1\n0.5,3\n")
    free = bodycheck.estimate(path, engine="mujoco", integrator="Euler", quantity="joint_position_error")
    named = bodycheck.estimate(path, engine="mujoco", integrator="Euler", quantity="joint_position_error", keyframe="raised")
    driven = bodycheck.estimate(path, engine="mujoco", integrator="Euler", quantity="joint_position_error", controls=controls)
    at = {
        name: {row.timestep: row.estimate for row in one.rows}
        for name, one in {"free": free, "named": named, "driven": driven}.items()
    }
    assert at["free"][0.004] == at["named"][0.004]
    assert at["free"][0.004] != at["driven"][0.004]


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"keyframe": "lowered"}, "--keyframe 'lowered': pendulum.xml has: raised"),
        ({"quantity": "attitud"}, "--quantity 'attitud': is not estimated"),
        ({"error": 0.0}, "--error 0: must be positive and finite"),
        ({"duration": -1.0}, "--duration -1: must be positive"),
        ({"blind": True}, "--blind: is for cases"),
    ],
)
def test_bad_input_has_one_clear_error(tmp_path: Path, options: dict[str, object], text: str) -> None:
    path = tmp_path / "pendulum.xml"
    path.write_text(PENDULUM)
    with pytest.raises(BadInput, match=re.escape(text)):
        bodycheck.estimate(path, engine="mujoco", **options)  # type: ignore[arg-type]


def test_a_method_that_no_engine_has_is_bad_input() -> None:
    with pytest.raises(BadInput, match=r"no engine has an integrator 'RK5'; .*did you mean 'RK4'\?"):
        bodycheck.estimate("free-brick", engine="mujoco", integrator="RK5", blind=True)


def test_controls_name_actuators_of_the_file(tmp_path: Path) -> None:
    path, controls = tmp_path / "pendulum.xml", tmp_path / "controls.csv"
    path.write_text(PENDULUM)
    controls.write_text("t,pull\n0,0\n")
    with pytest.raises(BadInput, match=r"there is no actuator 'pull' in pendulum\.xml; there are: push"):
        bodycheck.estimate(path, engine="mujoco", controls=controls)


def test_files_outside_the_folder_and_plugins_are_refused(tmp_path: Path) -> None:
    (tmp_path / "secret.xml").write_text("<mujoco/>")
    folder = tmp_path / "model"
    folder.mkdir()
    path = folder / "robot.xml"
    path.write_text('<mujoco><include file="../secret.xml"/></mujoco>')
    with pytest.raises(BadInput, match="is outside the folder of the model"):
        bodycheck.estimate(path, engine="mujoco")
    path.write_text('<mujoco><extension><plugin plugin="mujoco.pid"/></extension><worldbody/></mujoco>')
    with pytest.raises(BadInput, match="needs a plug-in"):
        bodycheck.estimate(path, engine="mujoco")


def test_recommend_of_a_robot_estimates_the_whole(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from bodycheck.studies.recommend.command import recommend

    path = tmp_path / "pendulum.xml"
    path.write_text(PENDULUM)
    assert recommend(str(path), error=1e-3, engine=("mujoco",), integrator=("RK4",)) == 0
    assert "the errors are estimates" in capsys.readouterr().out.splitlines()[0]
    assert recommend(str(path), error=1e-3, engine=("mujoco",), integrator=("RK4",), without=("contacts", "actuators")) == 0
    first = capsys.readouterr().out.splitlines()[0]
    assert first.startswith("mujoco RK4 at")
    assert "estimate" not in first


def test_the_json_has_the_rows_of_the_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from bodycheck.studies.estimate.command import estimate

    path = tmp_path / "pendulum.xml"
    path.write_text(PENDULUM)
    assert estimate(str(path), engine=("mujoco",), integrator=("RK4",), quantity="joint_position_error", json=True) == 0
    rows = json.loads(capsys.readouterr().out)
    assert ",".join(rows[0]) == COLUMNS


def test_a_class_whose_coverage_is_measured_keeps_the_share_that_is_promised() -> None:
    for kind in factors.KINDS:
        known = factors.factors()[kind]
        assert 1 < known.factor <= 4
        assert not known.sample or known.coverage >= (0.95 if kind in ("smooth", "driven") else 0.9)


def test_the_report_of_a_file_shows_its_motion_beside_the_finest_run(tmp_path: Path) -> None:
    file = tmp_path / "pendulum.xml"
    file.write_text(PENDULUM, "utf-8")
    out = tmp_path / "out"
    results = bodycheck.estimate(file, engine="mujoco", integrator="Euler", quantity="attitude", out=out)
    data = results.estimates.shown["mujoco"]["data"]
    # A capsule of 1 m along the arm, from its centre of mass, in units of the extent.
    ((one, other),) = data["bodies"][0]["sticks"]
    assert np.linalg.norm(np.subtract(one, other)) * data["extent"] == pytest.approx(1.0, rel=1e-4)
    (own,) = [row for row in rows_of(results, "attitude_error") if row.timestep == 0.004]
    assert own.low is not None
    assert own.high is not None
    assert own.low <= data["runs"][0]["attitude_error"] <= own.high
    assert len(data["truth"]["parts"]) == len(data["bodies"]) == 1
    assert 'class="player"' in (out / "report.html").read_text("utf-8")
