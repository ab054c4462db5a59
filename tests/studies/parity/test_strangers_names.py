"""A robot is a stranger's: its names and what engines say of it are printed on one line each, and are commands to nobody."""

from pathlib import Path
from xml.sax.saxutils import quoteattr

from bodycheck.robots.elements import printable
from bodycheck.studies.parity.rows import Compared, row
from tests.support.commands import bodycheck

NAME = "a\n::error::b\t\x9b<script>alert(1)</script>\u202e"

#: A robot of one link that turns, with a mass to be put in.
ROBOT = """\
<robot name={name}><link name="base"/><link name={name}><inertial><mass value="{mass}"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name={name} type="continuous"><parent link="base"/><child link={name}/></joint></robot>
"""


def test_rows_have_printable_texts() -> None:
    made = row(NAME, "mujoco", "1", Compared("differs", "mass", NAME, NAME, f"2 ({NAME})"))
    assert made.subject == made.model == made.engine_value == r"a\n::error::b\t\x9b<script>alert(1)</script>" + r"\u202e"
    assert made.truth_value.isprintable()
    assert printable("plain ü") == "plain ü"


def test_a_robot_with_hostile_names(tmp_path: Path) -> None:
    """A negative mass is a fault of the file and of what the engine says, so that the name is in the messages of both."""
    for name, mass in (("good", "1"), ("negative", "-1")):
        (tmp_path / f"{name}.urdf").write_text(ROBOT.format(name=quoteattr(NAME), mass=mass), "utf-8")
    files = [path.name for path in tmp_path.iterdir()]
    done = bodycheck("parity", *files, "--engine", "mujoco", "--states", "2", "--table", "--out", "out", folder=tmp_path)
    assert done.returncode == 1, done.stderr
    assert r"\n::error::b" in done.stdout
    lines = (done.stdout + done.stderr).splitlines()
    assert all(line.isprintable() and not line.lstrip().startswith("::") for line in lines)
    assert "<script>alert" not in (tmp_path / "out/report.html").read_text("utf-8")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*files, "out"])
