"""Files, folders and patterns of robots: what is compared, and what is told of the others."""

import csv
import json
from pathlib import Path

import pytest

from bodycheck.robots.urdf_text import urdf
from bodycheck.studies.parity.files import named
from tests.support.commands import bodycheck
from tests.support.planted_engines import plant
from tests.support.reading_engines import ENGINES
from tests.support.robot_faults import clean_model

ROBOT = urdf(clean_model())

#: An engine that takes any file for a robot without bodies.
TAKES_ALL = """
from bodycheck.adapters.robot_reading import RobotReading
def read_robot(file, states, gravity):
    return RobotReading((), (), (), 0, None, ())
"""

#: Robots, and XML files that are none: an include of others, a package of ROS, and settings of a robot's planner.
FILES = {
    "a/robot.urdf": ROBOT,
    "b/robot.urdf": ROBOT,
    "b/deep/arm.URDF": ROBOT,
    "b/deep/hand.xml": '<mujoco><worldbody><body><geom size="1"/></body></worldbody></mujoco>',
    "b/scene.xml": '<mujoco><include file="deep/hand.xml"/></mujoco>',
    "b/skybox.xml": "<mujoco><asset/></mujoco>",
    "b/package.xml": "<package/>",
    "b/notes.txt": "nothing",
    ".venv/c.urdf": ROBOT,
}
OF_ROBOTS = ["a/robot.urdf", "b/deep/arm.URDF", "b/deep/hand.xml", "b/robot.urdf", "b/scene.xml"]

#: What is no robot's file, by its name, and what is told of it; None is a file that is not there.
BAD = {
    "none.urdf": (None, "there is no such file"),
    "text.urdf": ("no model", "text.urdf:1: is not XML"),
    "other.urdf": ("<sdf/>", "other.urdf:1: <sdf>: is no robot model"),
    "broken.xml": ("<mujoco>", "broken.xml:1: is not XML"),
    "lacks.xml": ('<mujoco><include file="no.xml"/></mujoco>', "lacks.xml:1: <include file>: 'no.xml' is not there"),
    "large.urdf": (f"<robot name='r'>{'<link/>' * 501}</robot>", "large.urdf: has 501 links; allowed: at most 500"),
    "many.xml": (
        f"<mujoco><worldbody>{'<body/>' * 501}</worldbody></mujoco>",
        "many.xml: has 502 links; allowed: at most 500",
    ),
    "case.case.toml": ("= 3", "case.case.toml:1:1: not TOML"),
    "empty": ("", "there is no robot file (*.urdf, *.mjcf, *.xml) in this folder or below it"),
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, calls_here: None) -> Path:
    """A folder with a clean robot, arm.urdf, and the engines on the path."""
    plant(tmp_path / "planted", ENGINES | {"takes-all": TAKES_ALL})
    monkeypatch.syspath_prepend(tmp_path / "planted")
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ROBOT, "utf-8")
    return tmp_path


@pytest.fixture
def robots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The files of `FILES` in the folder in which the test works."""
    for name, content in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, "utf-8")
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("argument", [".", "**", "*", "?", "*/"])
def test_folders_and_patterns_stand_for_robot_files(robots: None, argument: str) -> None:
    given = named([Path(argument)])
    assert [file.path.as_posix() for file in given.files] == OF_ROBOTS
    assert [path.as_posix() for path in given.skipped] == ["b/package.xml", "b/skybox.xml"]
    assert not any(file.refused for file in given.files)


def test_robots_of_common_names_have_the_names_of_their_folders(robots: None) -> None:
    """Two files of such names in one folder have the name of the file too."""
    assert [file.name for file in named([Path()]).files] == ["a", "arm", "hand", "b/robot.urdf", "b/scene.xml"]
    assert [file.name for file in named([Path("b/robot.urdf"), Path("b/deep/../robot.urdf")]).files] == ["b"]
    Path("a/arm.urdf").write_text(ROBOT)
    paths = [Path("b/deep/arm.URDF"), Path("a/arm.urdf"), Path("a/none.urdf")]
    assert [file.name for file in named(paths).files] == ["deep/arm.URDF", "a/arm.urdf", "none"]


def test_a_link_out_of_a_folder_is_not_followed(robots: None, tmp_path: Path) -> None:
    (tmp_path / "a" / "out.urdf").symlink_to(tmp_path / "b" / "robot.urdf")
    (tmp_path / "a" / "inside.urdf").symlink_to("robot.urdf")
    refused = {file.path.name: file.refused for file in named([Path("a")]).files}
    assert refused == {"inside.urdf": "", "out.urdf": "is a link that leads out of a; name the file that it leads to"}


@pytest.fixture
def bad(folder: Path) -> list[str]:
    """The names of the files of `BAD`."""
    for name, (content, _) in BAD.items():
        if content:
            (folder / name).write_text(content, "utf-8")
    (folder / "empty").mkdir()
    return list(BAD)


def test_each_bad_file_is_a_row_and_all_are_told_at_once(folder: Path, bad: list[str]) -> None:
    done = bodycheck("parity", *bad[:4], "arm.urdf", *bad[4:], "--engine", "faithful", "--states", "2", "--out", "out")
    assert done.returncode == 1
    rows = list(csv.DictReader((folder / "out" / "parity.csv").read_text("utf-8").splitlines()))
    unread = [row for row in rows if row["status"] == "unreadable"]
    assert [(row["engine"], row["quantity"], row["subject"]) for row in unread] == [("file", "", "model")] * len(BAD)
    assert {(row["model"], row["status"]) for row in rows if row["engine"] == "faithful"} == {("arm", "agrees")}
    for row, (_, told) in zip(unread, BAD.values(), strict=True):
        assert told in row["engine_value"]
        assert told in done.stderr
    assert f"{len(BAD)} of {len(BAD) + 1} files cannot be read:" in done.stderr
    assert f"1 robot: all agree; {len(BAD)} files cannot be read" in done.stdout.replace("arm: all", "1 robot: all")
    assert (folder / "out" / "report.html").is_file()


def test_exit_code_2_if_no_file_can_be_read(bad: list[str]) -> None:
    done = bodycheck("parity", *bad, "--engine", "faithful", "--out", "out")
    assert (done.returncode, done.stdout) == (2, "")
    assert all(told in done.stderr for _, told in BAD.values())
    assert not Path("out/parity.csv").exists()


FIRST_MASS = ROBOT.index('<mass value="') + len('<mass value="')


@pytest.mark.parametrize(
    ("number", "told"),
    [
        ("1e308", "mass: read 1e+308; allowed: 0, or from 1e-100 to 1e+100 in size"),
        ("-1e101", "mass: read -1e+101; allowed: 0, or from 1e-100 to 1e+100 in size"),
        ("1e-101", "mass: read 1e-101; allowed: 0, or from 1e-100 to 1e+100 in size"),
        ("nan", "<mass value>: read 'nan'; allowed: one number"),
    ],
)
def test_numbers_beyond_the_limits_are_faults_of_the_file_and_of_no_engine(folder: Path, number: str, told: str) -> None:
    rest = ROBOT[ROBOT.index('"', FIRST_MASS) :]
    Path("arm.urdf").write_text(f"{ROBOT[:FIRST_MASS]}{number}{rest}", "utf-8")
    done = bodycheck("parity", "arm.urdf", "--engine", "takes-all", "--engine", "picky", "--states", "2", "--json")
    rows = json.loads(done.stdout)
    assert done.returncode == 1
    assert {(row["engine"], row["status"]) for row in rows} == {
        ("file", "refused"),
        ("takes-all", "accepted-unphysical"),
        ("picky", "refused"),
    }
    assert [row["quantity"] for row in rows if told in row["engine_value"]] == ["mass"]


#: A robot as an MJCF in which one attribute of a body is to be put in.
BODY = (
    '<mujoco><worldbody><body {}><geom size="1"/><joint/><body pos="1 0 0"><geom size="1"/></body></body></worldbody></mujoco>'
)


@pytest.mark.parametrize(
    ("attribute", "told"),
    [
        ('quat="1e308 1 0 0"', "arm.xml:1: <body quat>: read '1e308 1 0 0'; allowed: 0, or from 1e-100 to 1e+100 in size"),
        ('pos="inf 0 0"', "arm.xml:1: <body pos>: read 'inf 0 0'; allowed"),
        ('pos="1e90 0 0"', "all masses times the square of the largest distance are"),
        (f'name="{"b" * 501}"', "name of a link: read 'bbb"),
    ],
)
def test_limits_hold_for_an_mjcf_too(folder: Path, attribute: str, told: str) -> None:
    Path("arm.xml").write_text(BODY.format(attribute), "utf-8")
    done = bodycheck("parity", "arm.xml", "--engine", "takes-all", "--states", "2", "--json")
    rows = json.loads(done.stdout)
    assert {(row["engine"], row["status"]) for row in rows} == {("file", "refused"), ("takes-all", "accepted-unphysical")}
    assert any(told in row["engine_value"] for row in rows)
