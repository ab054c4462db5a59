"""The command estimate: verdicts and intervals against truths, and files of robots."""

import csv
import json
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import mujoco
import numpy as np
import pytest

import bodycheck
from bodycheck.adapters.contract import Method
from bodycheck.adapters.file_motion import FileFacts
from bodycheck.errors import BadInput
from bodycheck.running.refining import Ended
from bodycheck.studies.estimate import factors, rating, wording
from bodycheck.studies.estimate.calibration import SEED_OF_FACTORS
from bodycheck.studies.estimate.interface import EstimateResults
from bodycheck.studies.estimate.levels import Levels
from bodycheck.studies.estimate.method import Refined, Subject
from bodycheck.studies.estimate.quantities import AT_END
from bodycheck.studies.estimate.rows import ESTIMATE, EstimateRow
from bodycheck.studies.estimate.spellings import UnknownMethod, check

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
    assert all(row.estimate <= other.high for row, other in zip(last, largest, strict=True) if row.estimate and other.high)


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
    assert {row["file"] for row in read} == {f"{tmp_path.name}/pendulum.xml"}  # files of robots often have the same name
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
        ({"keyframe": "lowered"}, "/pendulum.xml has: raised"),
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


@pytest.mark.parametrize(
    ("spelling", "text"),
    [
        ("RK5", "--integrator 'RK5': mujoco has for pendulum.xml: RK4, Euler, implicit"),
        (
            "Euler:cone=elliptic",
            "--integrator 'Euler:cone=elliptic': the options of mujoco for files are: iterations, tolerance",
        ),
        ("Euler:iterations=0", "read '0' as iterations; allowed: a positive whole number"),
        ("Euler:tolerance=nan", "read 'nan' as tolerance; allowed: a positive number"),
    ],
)
def test_methods_of_a_file_are_those_of_its_engine(spelling: str, text: str) -> None:
    facts = FileFacts(Method("RK4", 0.004), ("RK4", "Euler", "implicit"), options={"iterations": int, "tolerance": float})
    with pytest.raises(UnknownMethod, match=re.escape(text)):
        check(spelling, "mujoco", "pendulum.xml", facts)
    check("Euler:iterations=5,tolerance=1e-9", "mujoco", "pendulum.xml", facts)


def test_a_method_that_the_engine_of_a_file_lacks_is_bad_input(tmp_path: Path) -> None:
    path = tmp_path / "pendulum.xml"
    path.write_text(PENDULUM)
    with pytest.raises(BadInput, match=r"--integrator 'RK5': mujoco has for .*/pendulum\.xml: RK4, Euler"):
        bodycheck.estimate(path, engine="mujoco", integrator="RK5")


@pytest.mark.parametrize(
    ("part", "text"),
    [
        ('<replicate count="1000"><replicate count="1000"><geom size="1"/></replicate></replicate>', "stands for 1e+06 parts"),
        ('<body><composite type="cable" count="1000000000 1 1"/></body>', "stands for 1e+09 parts"),
        ('<replicate count="many"><geom size="1"/></replicate>', "read 'many'; allowed: positive whole numbers"),
    ],
)
def test_elements_that_stand_for_too_many_parts_are_refused_before_an_engine_reads_them(
    tmp_path: Path, part: str, text: str
) -> None:
    path = tmp_path / "many.xml"
    path.write_text(f"<mujoco><worldbody>{part}</worldbody></mujoco>")
    with pytest.raises(BadInput, match=re.escape(text)) as refused:
        bodycheck.estimate(path, engine="mujoco")
    assert "many.xml:1: <" in str(refused.value)


def test_no_interval_is_stated_of_a_class_whose_coverage_is_not_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    known = factors.factors() | {"smooth": replace(factors.factors()["smooth"], sample=0)}
    monkeypatch.setattr(factors, "factors", lambda: known)
    found = bodycheck.estimate("hinge-spring", engine="mujoco", integrator="Euler", duration=0.1, blind=True)
    assert found.rows
    assert all(row.verdict != ESTIMATE and row.estimate is None and row.low is None and row.high is None for row in found.rows)
    assert any("no interval is stated" in row.reason for row in found.rows)


def test_names_of_a_stranger_are_printed_on_one_line() -> None:
    head = rating.Head("a.xml", "mujoco", "4", "Euler")
    known = Refined(Method("Euler", 1e-3), Levels(np.linspace(0, 1, 3), None, ()), {1e-3: Ended("diverged", "a\nb\x1b[31m")})
    subject = Subject(np.linspace(0, 1, 3), None, 1e-3, ("attitude_error",), lambda motion: "smooth")
    (row,) = rating.rows(head, subject, known, ())
    assert row.reason.isprintable()


def test_controls_name_actuators_of_the_file(tmp_path: Path) -> None:
    path, controls = tmp_path / "pendulum.xml", tmp_path / "controls.csv"
    path.write_text(PENDULUM)
    controls.write_text("t,pull\n0,0\n")
    with pytest.raises(BadInput, match=r"there is no actuator 'pull' in .*/pendulum\.xml; there are: push"):
        bodycheck.estimate(path, engine="mujoco", controls=controls)


def test_a_file_that_the_engine_refuses_is_bad_input_with_the_line_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "part.xml").write_text("<mujocoinclude>\n\n<wheel/></mujocoinclude>")
    path = tmp_path / "robot.xml"
    path.write_text('<mujoco><worldbody><include file="part.xml"/></worldbody></mujoco>')
    with pytest.raises(BadInput, match=r"part\.xml:3: mujoco \S+ cannot read the file: .*unrecognized element .*'wheel'$"):
        bodycheck.estimate(path, engine="mujoco")
    path.write_text("<mujoco><worldbody>\n<body><freejoint/></body></worldbody></mujoco>")
    with pytest.raises(BadInput, match=r"robot\.xml:2: mujoco \S+ cannot read the file: .*mass and inertia"):
        bodycheck.estimate(path, engine="mujoco")


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


def test_coverage_was_measured_on_other_members_than_those_that_set_the_factors() -> None:
    for kind in factors.KINDS:
        known = factors.factors()[kind]
        assert 1 < known.factor <= 4
        if known.sample:
            assert known.command.startswith("bodycheck estimate --calibrate")
            assert f"--seed {SEED_OF_FACTORS}" not in known.command


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


def test_the_error_of_a_solver_that_stops_early_is_told_beside_that_of_the_step(tmp_path: Path) -> None:
    file = tmp_path / "boxes.xml"
    boxes = "".join(
        f'<body pos="0 0 {0.1 + 0.2 * place}"><freejoint/><geom type="box" size=".1 .1 .1"/></body>' for place in (0, 1)
    )
    option = '<option solver="PGS" iterations="2"/>'
    file.write_text(f'<mujoco>{option}<worldbody><geom type="plane" size="1 1 1"/>{boxes}</worldbody></mujoco>')
    estimates = bodycheck.estimate(file, engine="mujoco", integrator="Euler", duration=0.05).estimates
    cost = estimates.solvers["mujoco"]
    assert (cost.iterations, cost.needed) == (2, 2)

    def heights(iterations: int, tolerance: float) -> list[float]:
        model = mujoco.MjModel.from_xml_path(str(file))
        model.opt.iterations, model.opt.tolerance = iterations, tolerance
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data, 25)
        return data.xipos[1:].ravel().tolist()

    apart = np.subtract(heights(2, 1e-8), heights(20, 1e-15)).reshape(2, 3)
    assert cost.errors["position_error"] >= 0.9 * np.linalg.norm(apart, axis=1).max() > 1e-6
    (sentence,) = [one for one in wording.sentences(estimates) if one.startswith("The settings of the solver")]
    assert "(2 iterations, tolerance 1e-08) cost" in sentence
    assert sentence.endswith("some steps end at this number of iterations.")
