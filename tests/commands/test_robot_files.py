"""Commands take a robot's file where they take a case, and say what of the file is left out and from when on it would act."""

import html
import json
import math
import shlex
from pathlib import Path

import pandas as pd
import pytest

import bodycheck as interface
from bodycheck.running import robot_notices, truths
from tests.support.commands import bodycheck

#: A weight that falls freely along a rail: after t it is at t^2 g / 2. The rail ends at 0.1 m.
RAIL = """<robot name="rail">
  <link name="rail"/>
  <link name="weight"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="rail"/><child link="weight"/><axis xyz="0 0 -1"/>
    <limit lower="-1" upper="0.1" effort="1" velocity="1"/></joint>
</robot>"""
PASSED = math.sqrt(2 * 0.1 / 9.81)

#: Two sliders that fall beside each other, and a tendon whose length is the sum of their ways.
TENDON = """<mujoco>
  <worldbody>
    <body name="one"><joint name="a" type="slide" axis="0 0 -1"/><geom size="0.1" contype="0" conaffinity="0"/></body>
    <body name="two"><joint name="b" type="slide" axis="0 0 -1"/><geom size="0.1" contype="0" conaffinity="0"/></body>
  </worldbody>
  <tendon><fixed name="sum" range="-1 0.2"><joint joint="a" coef="1"/><joint joint="b" coef="1"/></fixed></tendon>
</mujoco>"""

#: A ball of radius 0.1 m whose centre falls from 0.3 m above the floor.
BALL = """<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="ball" pos="0 0 0.3" EXTRA><joint name="z" type="slide" axis="0 0 1"/><geom type="sphere" size="0.1"/></body>
  </worldbody>
</mujoco>"""
TOUCHED = math.sqrt(2 * 0.2 / 9.81)

#: A case of a robot in ball.xml whose trunk falls.
FREE = """format = 2
name = "free"
title = "A ball that falls with its trunk"
scene = {gravity = 9.81}
run = {duration = 1.0, samples = 101}
[model]
file = "ball.xml"
base = "free"
"""

METHODS = ("--engine", "mujoco", "--integrator", "Euler", "--integrator", "RK4")


#: The case of the rail without its stops.
WITHOUT_STOPS = """format = 2
name = "rail"
title = "Rail"
[model]
file = "rail.urdf"
[scene]
gravity = 9.81
[run]
duration = 1.0
samples = 101
"""


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "utf-8")
    return path


def test_a_limit_acts_from_the_instant_on_at_which_it_is_passed(calls_here: None, tmp_path: Path) -> None:
    """The error of semi-implicit Euler's position is h g t / 2: up to the limit it is that at the last instant before."""
    written(tmp_path, "rail.urdf", RAIL)
    path, out = written(tmp_path, "rail.case.toml", WITHOUT_STOPS), tmp_path / "out"
    done = bodycheck("run", path, *METHODS, "--out", out)
    assert done.returncode == 0
    said = "rail: slide passes its upper limit at 0.1428 s: from there on this is the robot without its limits."
    assert done.stderr.splitlines()[0] == said
    document = json.loads((out / "results.json").read_text("utf-8"))
    assert document["notices"][0] == said
    # The instant has the rounding of the truth's coordinates, divided by the speed of 1.4 m/s.
    assert document["sets"][0]["header"]["departures"]["rail"] == pytest.approx(PASSED, abs=1e-12)
    runs = pd.read_csv(out / "results.csv").set_index("integrator")
    assert runs.departure.tolist() == pytest.approx([PASSED] * 2, abs=1e-12)
    # MuJoCo's positions are those of sums of some hundred steps, in doubles.
    assert runs.position_error_before_departure["Euler"] == pytest.approx(0.002 * 9.81 * 0.14 / 2, rel=1e-9)
    assert runs.position_error["Euler"] == pytest.approx(0.002 * 9.81 / 2, rel=1e-9)
    report = (out / "report.md").read_text("utf-8")
    assert "slide passes its upper limit at 0.1428 s" in report
    assert "up to 0.143 s" in report
    assert "rail: up to 0.1428 s, the largest attitude error is " in done.stdout


def test_a_range_is_a_stop_where_a_robots_file_is_the_case(calls_here: None, tmp_path: Path) -> None:
    path, out = written(tmp_path, "rail.urdf", RAIL), tmp_path / "out"
    done = bodycheck("truth", path, "--json")
    assert "without its limits" not in done.stderr
    heights = [states[2] for states in json.loads(done.stdout)["bodies"]["weight"]["position"]]
    assert heights[14] == pytest.approx(-9.81 * 0.14**2 / 2, abs=1e-15)
    assert heights[15:] == [-0.1] * 86
    assert bodycheck("run", path, *METHODS, "--out", out).returncode == 0
    runs = pd.read_csv(out / "results.csv").set_index("integrator")
    # MuJoCo's limit gives way by some millimetres.
    assert 1e-4 < runs.limit_violation["RK4"] < 0.02


def test_the_limit_of_a_fixed_tendon_acts_from_the_instant_on_at_which_it_is_passed(calls_here: None, tmp_path: Path) -> None:
    """Both sliders have fallen 0.1 m then, as the slider of the rail has."""
    case = interface.load(written(tmp_path, "two.xml", TENDON))
    robots = robot_notices.of([case], 1)
    assert robots.departures == {"two": pytest.approx(PASSED, abs=1e-12)}
    said = "tendon sum passes its upper limit at 0.1428 s: from there on this is the robot without its limits."
    assert robots.sentences["two"][0] == said
    assert "1 tendon (line 6) acts only at its limits." in robots.sentences["two"][-1]
    assert robot_notices.of([interface.load(tmp_path / "two.xml", ignore=["limits"])], 1).departures == {}


def test_a_contact_is_found_between_two_samples(calls_here: None, tmp_path: Path) -> None:
    path = written(tmp_path, "ball.xml", BALL.replace("EXTRA", ""))
    done = bodycheck("truth", path)
    after, before = math.floor(100 * TOUCHED) / 100, math.ceil(100 * TOUCHED) / 100
    said = f"ball: floor touches ball between {after:g} and {before:g} s: from there on this is the robot without its contacts."
    assert done.stderr.splitlines()[0] == said
    assert done.returncode == 0
    case = interface.load(path)
    assert robot_notices.of([case], 1).departures == {"ball": after}
    touching = interface.load(written(tmp_path, "low.xml", BALL.replace("EXTRA", "").replace("0 0 0.3", "0 0 0.05")))
    robots = robot_notices.of([touching], 1)
    assert robots.departures == {"low": 0.0}
    assert robots.sentences["low"][0] == "floor touches ball at the start: this is the robot without its contacts."
    without = interface.load(path, ignore=["contacts"])
    assert robot_notices.of([without], 1).departures == {}


def test_the_truth_of_the_notices_is_that_of_the_runs(
    calls_here: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = interface.load(written(tmp_path, "ball.xml", BALL.replace("EXTRA", "")))
    known = robot_notices.of([case], 1, {"ball": (0.002,)}).truths["ball"]
    for sampling, truth in truths.of_runs(case, (0.0, 0.002)).items():
        assert (known[sampling].trajectory.position == truth.trajectory.position).all()
    calls, of_runs = [], truths.of_runs
    monkeypatch.setattr(truths, "of_runs", lambda *given: calls.append(given) or of_runs(*given))
    bodycheck("run", tmp_path / "ball.xml", "--engine", "mujoco", "--integrator", "RK4", "--timestep", "0.002")
    assert len(calls) == 1


def test_contacts_are_looked_for_without_meshes_that_cannot_be_read(calls_here: None, tmp_path: Path) -> None:
    """The spheres still touch: that of the weight falls on another one on a level rail, after 0.1 m in 0.1428 s."""
    inertial = RAIL[RAIL.index("<inertial>") : RAIL.index("</link>")]
    mesh, ball = '<mesh filename="NAME"/>', '<sphere radius="0.1"/>'
    shapes = "".join(f"<collision><geometry>{shape}</geometry></collision>" for shape in (mesh, ball))
    low = f'<collision><origin xyz="0 0 -0.3"/><geometry>{ball}</geometry></collision>'
    level = (
        '<joint name="level" type="prismatic"><parent link="rail"/><child link="low"/><limit effort="1" velocity="1"/></joint>'
    )
    text = RAIL.replace("</inertial></link>", f"</inertial>{shapes}</link>")
    text = text.replace("</robot>", f'<link name="low">{inertial}{low}</link>{level}</robot>')
    (tmp_path / "part.dae").write_text("<COLLADA/>")
    for name, why in (
        ("package://nowhere/part.stl", "is outside"),
        ("part.dae", "allowed where a shape may touch others: .stl"),
    ):
        path = written(tmp_path, "rail.urdf", text.replace("NAME", name))
        robots = robot_notices.of([interface.load(path)], 1)
        touched, unseen = (sentence for sentence in robots.sentences["rail"] if "ontacts" in sentence)
        assert touched.startswith("weight touches low between 0.14 and 0.15 s: from there")
        assert unseen.startswith("Contacts of weight were looked for without the shapes whose meshes cannot be read, such as r")
        assert why in unseen


def test_a_mesh_that_only_pictures_need_hides_no_contact(calls_here: None, tmp_path: Path) -> None:
    """A box that MuJoCo would fit to a mesh is left out likewise, and no box of another mesh is looked at in its place."""
    mesh = '<asset><mesh name="m" file="m.stl"/></asset>'
    fitted = '<geom type="box" mesh="m" mass="0"/>'
    for more, unseen in ((f"{fitted[:-2]} contype='0' conaffinity='0'/>", False), (fitted, True)):
        inertial = '<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>'
        text = (
            BALL.replace("EXTRA", "")
            .replace("<geom type", f"{inertial}{more}<geom type")
            .replace("<worldbody>", f"{mesh}<worldbody>")
        )
        robots = robot_notices.of([interface.load(written(tmp_path, "ball.xml", text))], 1)
        assert robots.sentences["ball"][0].startswith("floor touches ball between 0.2 and 0.21 s")
        assert any("were looked for without" in sentence for sentence in robots.sentences["ball"]) == unseen


def test_contacts_of_a_robot_whose_base_is_set_free(calls_here: None, tmp_path: Path) -> None:
    """The ball hangs on a slide whose parent falls: both fall together, and the ball does not move against the parent."""
    text = BALL.replace("EXTRA", "").replace(
        '<geom type="sphere"', '<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/><geom type="sphere"'
    )
    trunk = '<body name="trunk"><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>'
    written(
        tmp_path,
        "ball.xml",
        text.replace('<body name="ball"', f'{trunk}<body name="ball"').replace("</body>", "</body></body>"),
    )
    case = written(tmp_path, "free.case.toml", FREE)
    robots = robot_notices.of([interface.load(case)], 1)
    assert robots.sentences["free"][0].startswith("floor touches ball between 0.2 and 0.21 s")


def test_robots_of_one_file_name_have_the_names_of_their_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for folder in ("one", "two", "three"):
        written(tmp_path, f"robots/{folder}/robot.urdf", RAIL if folder != "three" else "<robot/>")
    for argument in ("robots", "robots/*/robot.urdf"):
        done = bodycheck("validate", argument)
        valid = [line.removesuffix(": valid") for line in done.stdout.splitlines() if line.endswith(": valid")]
        assert valid == ["one", "two"]
        assert done.returncode == 1
        assert all(line.startswith("robots/three/robot.urdf") for line in done.stderr.splitlines())
    assert bodycheck("validate", "robots/three/robot.urdf").returncode == 2
    assert bodycheck("validate", "robots/two").returncode == 0
    written(tmp_path, "robots/own.case.toml", bodycheck("new", "own").stdout and Path("own.case.toml").read_text("utf-8"))
    assert bodycheck("validate", "robots").stdout == "own: valid\n"  # case files commonly have their robots beside them


def test_validate_says_what_a_robot_is(tmp_path: Path) -> None:
    done = bodycheck("validate", written(tmp_path, "rail.urdf", RAIL))
    first, counted, *notices = done.stdout.splitlines()
    assert first == "rail: valid"
    assert counted == "  rail.urdf: bodies with mass: 1, joints that move: 1, degrees of freedom: 1, mass: 2 kg"
    assert all(notice.startswith("  ") for notice in notices)


def test_what_acts_from_the_start_is_refused_with_the_command_that_runs(
    calls_here: None,
    tmp_path: Path,
) -> None:
    path = written(tmp_path, "floating.xml", BALL.replace("EXTRA", 'gravcomp="0.5"'))
    refused = bodycheck("run", path, *METHODS)
    assert refused.returncode == 2
    *faults, command = refused.stderr.splitlines()
    assert len(faults) == 1
    assert "--ignore gravity_compensation leaves it out" in faults[0]
    _, _, words = command.partition("runs without them by: bodycheck ")
    done = bodycheck(*shlex.split(words), *METHODS)
    assert done.returncode == 0
    assert done.stderr.splitlines()[0] == "floating: of the robot without its gravity compensation"
    assert bodycheck("run", "free-brick", "--ignore", "tendons").returncode == 2


def test_a_case_of_a_whole_robot_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = written(tmp_path, "rail.urdf", RAIL)
    assert bodycheck("new", "own", "--model", "rail.urdf").stdout == "own.case.toml\n"
    text = Path("own.case.toml").read_text("utf-8")
    assert "[initial.joints.slide]" in text
    own, direct = interface.load("own.case.toml"), interface.load(path)
    assert (own.scene, own.duration, own.samples) == (direct.scene, direct.duration, direct.samples)
    assert (own.name, direct.name) == ("own", "rail")
    (tmp_path / "below").mkdir()
    monkeypatch.chdir(tmp_path / "below")
    assert "must be in the folder of the case file" in bodycheck("new", "own", "--model", "../rail.urdf").stderr
    assert bodycheck("new", "own", "--model", "../rail.urdf", "--mechanism").returncode == 2


def test_a_robots_file_has_no_place_for_expectations(tmp_path: Path) -> None:
    done = bodycheck("expect", path := written(tmp_path, "rail.urdf", RAIL))
    assert done.returncode == 2
    assert f"bodycheck new NAME --model {path}" in done.stderr


def test_a_report_has_the_commands_that_reproduce_runs_of_a_robot(calls_here: None, tmp_path: Path) -> None:
    path, parts, out = written(tmp_path, "rail.urdf", RAIL), tmp_path / "the parts", tmp_path / "out"
    options = ("--package-path", parts, "--ignore", "limits", "--ignore", "damping")
    assert bodycheck("run", path, *METHODS, *options, "--out", out).returncode == 0
    again = shlex.join(
        ["bodycheck", "run", str(path), "--package-path", str(parts), "--ignore", "limits", "--engine", "mujoco"]
    )
    assert html.escape(f"{again} --integrator Euler", quote=False) in (out / "report.html").read_text("utf-8").replace(
        "&#39;", "'"
    )
    done = bodycheck("ensemble", path, "--ignore", "limits")
    assert "bodycheck new NAME --model FILE" in done.stderr


def test_studies_take_a_robots_file(calls_here: None, tmp_path: Path) -> None:
    path = written(tmp_path, "rail.urdf", RAIL)
    found = interface.run(path, engine="mujoco", integrator="RK4", timestep=0.01)
    assert found.passed
    assert "without its limits" not in " ".join(found.findings)
    found = interface.run(path, engine="mujoco", integrator="RK4", timestep=0.01, ignore=["limits"], package_path=tmp_path)
    assert found.findings[-1].startswith("rail: of the robot without its limits")
    with pytest.raises(interface.BadInput, match="read 'limit'; allowed: actuators"):
        interface.run(path, ignore="limit")
    with pytest.raises(interface.BadInput, match="is an argument of bodycheck"):
        interface.run(interface.load(path), ignore="limits")
    script = bodycheck("export", path, "--engine", "mujoco", "--integrator", "RK4")
    assert (script.returncode, "slide" in script.stdout) == (0, True)
