"""The command: verdicts, tables, reports and exit codes, with engines that read, refuse, crash and hang."""

import csv
import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from bodycheck.adapters.robot_reading import RobotFile, RobotReading
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots.urdf_text import urdf
from bodycheck.running import robot_readings
from bodycheck.running.robot_readings import FormatMissing, Refused
from bodycheck.studies.parity.rows import READINGS
from tests.support.commands import bodycheck
from tests.support.engine_readings import GRAVITY
from tests.support.planted_engines import plant
from tests.support.reading_engines import ENGINES
from tests.support.robot_faults import clean_model


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the file of a clean robot, and the engines on the path."""
    plant(tmp_path / "planted", ENGINES)
    monkeypatch.syspath_prepend(tmp_path / "planted")
    (tmp_path / "arm.urdf").write_text(urdf(clean_model()), "utf-8")
    return tmp_path


@pytest.fixture
def here(folder: Path, calls_here: None) -> Path:
    """The same folder for engines that neither die nor hang, which are called in this process."""
    return folder


def engines(*names: str) -> list[str]:
    return [word for name in names for word in ("--engine", name)]


def test_each_way_of_an_engine_to_fail_is_told_apart(folder: Path) -> None:
    names = ("faithful", "picky", "mjcf-only", "dying", "hanging", "illiterate")
    states = seeded_states(clean_model(), 2, 0)
    # The engine that hangs costs this long; the others answer at once, and are far from it on any machine that runs tests.
    with robot_readings.reader(names, 2, 6) as read_file:
        found = read_file(RobotFile(str(folder / "arm.urdf"), "urdf"), None, states, GRAVITY)
    kinds = {name: type(answer) for name, answer in found.items()}
    assert kinds == dict(zip(names, (RobotReading, Refused, FormatMissing, Crashed, TimedOut, FormatMissing), strict=True))
    assert found["picky"] == Refused("joint elbow is not to my taste")
    assert list(robot_readings.readable(found)) == [name for name in names if name != "illiterate"]


def test_crashes_and_faults_of_adapters_are_no_refusals_and_are_counted_apart(folder: Path) -> None:
    names = ("segfaulting", "broken", "brief", "picky", "faithful")
    done = bodycheck("parity", "arm.urdf", *engines(*names), "--states", "2", "--out", "out", folder=folder)
    assert done.returncode == 1
    table = list(csv.DictReader((folder / "out" / "parity.csv").read_text("utf-8").splitlines()))
    expected = ("crashed", "adapter-fault", "adapter-fault", "refused", "agrees")
    assert {row["engine"]: row["status"] for row in table} == dict(zip(names, expected, strict=True))
    for told in (
        "segfaulting 1.0: crashes on the file: its process died of signal SIGSEGV",
        "broken 1.0: has no reading: the adapter of broken is at fault: AttributeError: 'NoneType' object has no attribute",
        "brief 1.0: has no reading: the adapter of brief is at fault: there are terms at 4 states, not at 5",
        "picky 1.0: refuses the file: joint elbow is not to my taste",
    ):
        assert told in done.stdout
    assert "there were 1 crash and 2 faults of adapters" in (folder / "out" / "report.md").read_text("utf-8")


def test_what_one_reader_writes_reaches_no_other(folder: Path) -> None:
    """One at a time, so that the second reads after the first has written, and a second file in the processes of the first."""
    (folder / "again.urdf").write_text(urdf(clean_model()), "utf-8")
    names = ("overwriting", "faithful", "overwriting", "heavy")
    done = bodycheck(
        "parity", "arm.urdf", "again.urdf", *engines(*names), "--states", "2", "--jobs", "1", "--json", folder=folder
    )
    differing = {(row["model"], row["engine"]) for row in json.loads(done.stdout) if row["status"] != "agrees"}
    assert differing == {("arm", "heavy"), ("again", "heavy")}


def test_a_difference_is_named_in_every_output(here: Path) -> None:
    done = bodycheck(
        *("parity", "arm.urdf", *engines("faithful", "heavy", "picky", "mjcf-only"), "--states", "4"),
        *("--out", "out", "--junit", "junit.xml"),
        folder=here,
    )
    assert done.returncode == 1
    assert "armature differs: elbow (armature 0.1 instead of 0.0)" in done.stdout
    assert "refuses the file: joint elbow is not to my taste" in done.stdout
    table = list(csv.DictReader((here / "out" / "parity.csv").read_text("utf-8").splitlines()))
    assert list(table[0]) == list(READINGS.by_name)
    assert {(row["engine"], row["subject"]) for row in table if row["cause"]} == {("heavy", "elbow"), ("heavy", "model")}
    assert {row["status"] for row in table if row["engine"] == "faithful"} == {"agrees"}
    assert "heavy has another armature" in (here / "out" / "report.md").read_text("utf-8")
    assert "part-arm" in (here / "out" / "report.html").read_text("utf-8")
    tests = {test.get("name"): [child.tag for child in test] for test in ElementTree.parse(here / "junit.xml").iter("testcase")}
    assert tests == {"faithful": [], "heavy": ["failure"], "picky": ["failure"], "mjcf-only": ["skipped"]}


def test_agreement_is_success_and_rows_are_printed_as_json(here: Path) -> None:
    done = bodycheck("parity", "arm.urdf", *engines("faithful"), "--states", "4", "--json", folder=here)
    assert done.returncode == 0
    assert {row["status"] for row in json.loads(done.stdout)} == {"agrees"}


def test_what_an_engine_does_not_report_is_told_and_counted(here: Path) -> None:
    """An engine without any bodies has a row for each quantity of each link, so that it agrees in fewer quantities."""
    done = bodycheck("parity", "arm.urdf", *engines("faithful", "bodiless"), "--states", "4", "--out", "out", folder=here)
    assert done.returncode == 0
    table = list(csv.DictReader((here / "out" / "parity.csv").read_text("utf-8").splitlines()))
    rows = {name: [row for row in table if row["engine"] == name] for name in ("faithful", "bodiless")}
    assert {row["status"] for row in rows["faithful"]} == {"agrees"}
    missing = {(row["quantity"], row["subject"]) for row in rows["bodiless"] if row["status"] == "not-modelled"}
    links = ("arm_1", "arm_2", "slide", "hand")
    assert missing == {("total_mass", "model"), ("mass", "tool")} | {
        (quantity, link) for quantity in ("mass", "center_of_mass", "inertia", "parent") for link in links
    }
    names = [{(row["quantity"], row["subject"]) for row in rows[name]} for name in rows]
    assert names[1] - names[0] == {("mass", "tool")}  # which the other engine has joined to the first link
    assert names[0] <= names[1]
    compared = len(rows["faithful"]) - 2  # any order of the joints agrees, and any gravity with a file that states none
    assert f" (pose), {compared} quantities compared" in done.stdout
    assert f" (pose), {compared - 17} quantities compared" in done.stdout
    assert "does not report: arm_1 (parent, mass, center of mass and inertia), " in done.stdout


def test_a_named_engine_of_which_nothing_is_compared_fails(here: Path) -> None:
    done = bodycheck("parity", "arm.urdf", *engines("faithful", "mjcf-only"), "--states", "4", folder=here)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == (
        "bodycheck: there is no result of the engine mjcf-only, which is named: not-modelled: there is no reader of URDF"
    )


@pytest.mark.parametrize("tolerance", ["1", "1.5", "inf", "nan", "0", "-1e-9"])
def test_a_tolerance_that_everything_meets_is_refused(here: Path, tolerance: str) -> None:
    done = bodycheck("parity", "arm.urdf", *engines("faithful"), "--tolerance", tolerance, folder=here)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.endswith(": must be greater than 0 and less than 1; it is relative\n")


def test_a_motion_shows_what_a_difference_does(here: Path) -> None:
    done = bodycheck("parity", "arm.urdf", *engines("heavy"), "--states", "4", "--motion", "0.2", folder=here)
    assert "after 0.2 s of free motion" in done.stdout


@pytest.mark.parametrize(
    ("content", "told"),
    [(None, "there is no such file"), ("no model", "arm.urdf"), ("<sdf/>", "arm.urdf")],
)
def test_what_is_no_model_is_bad_input(here: Path, content: str | None, told: str) -> None:
    (here / "arm.urdf").unlink()
    if content is not None:
        (here / "arm.urdf").write_text(content, "utf-8")
    done = bodycheck("parity", "arm.urdf", *engines("faithful"), folder=here)
    assert done.returncode == 2
    assert told in done.stderr


def test_an_inertia_that_cannot_be_is_refused_and_told_of_the_engine_that_takes_it(here: Path) -> None:
    text = (here / "arm.urdf").read_text("utf-8")
    first = text.index("ixx=")
    end = text.index('"', first + 5)
    (here / "arm.urdf").write_text(f'{text[:first]}ixx="90{text[end:]}', "utf-8")
    done = bodycheck("parity", "arm.urdf", *engines("faithful"), "--states", "4", "--json", folder=here)
    found = [row for row in json.loads(done.stdout) if row["status"] != "agrees"]
    assert [(row["engine"], row["status"], row["quantity"]) for row in found] == [
        ("file", "refused", "inertia"),
        ("faithful", "accepted-unphysical", "inertia"),
    ]
    assert done.returncode == 1
