"""A robot model is a stranger's data: what cannot be followed is refused in one line, and no other file is opened."""

from pathlib import Path

import pytest

from bodycheck.casefile import body_template as robots
from bodycheck.casefile.authoring import new_of_robot, template
from bodycheck.casefile.case import parse, shipped_file
from bodycheck.errors import BadInput
from bodycheck.robots import elements
from tests.support.commands import bodycheck

GEOM = '<geom type="box" size="0.1 0.2 0.3"/>'
INERTIAL = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
LINK = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def mjcf(inside: str, top: str = "") -> str:
    return f'<mujoco>{top}\n<worldbody>\n<body name="torso">\n{inside}</body></worldbody></mujoco>'


def urdf(inside: str) -> str:
    return f'<robot name="r">\n<link name="torso">\n{inside}</link></robot>'


def compiler(text: str) -> str:
    return mjcf(INERTIAL, f"<compiler {text}/>")


def test_the_models_that_the_refused_ones_are_made_of_are_read(tmp_path: Path) -> None:
    for text in (
        mjcf(GEOM),
        mjcf('<geom size="1" shellinertia="true"/>'),
        mjcf(INERTIAL),
        urdf(LINK),
        compiler('angle="radian"'),
    ):
        (tmp_path / "robot.xml").write_text(text)
        assert robots.read(tmp_path / "robot.xml", "torso").name == "torso"


BOMB = '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]>' + urdf(LINK).replace('name="r"', 'name="&b;"')

REFUSED = {
    "entities": (BOMB, "robot.xml:1: read a document type definition; robot models need none, and it is refused"),
    "external": ('<!DOCTYPE r SYSTEM "/etc/passwd">' + urdf(LINK), "robot.xml:1: read a document type definition"),
    "no XML": ("robot", "robot.xml:1: is not XML: syntax error"),
    "cut off": (urdf(LINK)[:-9], "robot.xml:3: is not XML: "),
    "nothing": ("", "robot.xml:1: is not XML: no element found"),
    "encoding": ("<?xml version='1.0' encoding='nonsense'?>" + urdf(LINK), "is not XML: unknown encoding"),
    "deep": ("<robot>" + "<a>" * 300, "robot.xml:1: <a>: elements are nested more than 200 deep"),
    "sdf": ("<sdf/>", "robot.xml:1: <sdf>: is no robot model; allowed: <robot> (URDF) or <mujoco> (MJCF)"),
    "include": (mjcf(INERTIAL, '<include file="/etc/passwd"/>'), "<include file>: names another file, which is not opened"),
    "mesh": (mjcf('<geom type="mesh" mesh="m"/>'), "<geom mesh>: names a mesh, which is not opened"),
    "mesh in disguise": (mjcf('<geom mesh="m"/>'), "<geom mesh>: names a mesh, which is not opened"),
    "fitted": (mjcf('<geom type="box" mesh="m" size="1 1 1"/>'), "<geom mesh>: names a mesh, which is not opened"),
    "height field": (mjcf('<geom type="hfield" hfield="h"/>'), "<geom hfield>: names a height field, which is not read"),
    "no mass": (mjcf(""), "<body>: has no <inertial> and no geom with a mass"),
    "not from geoms": (mjcf(GEOM, '<compiler inertiafromgeom="false"/>'), '(inertiafromgeom="false")'),
    "frame": (mjcf(f'<frame pos="1 0 0">{GEOM}</frame>{GEOM}'), "<geom>: is in a <frame>, which is not followed here"),
    "replicate": (mjcf(f'{GEOM}<replicate count="2">{GEOM}</replicate>'), "<replicate>: stands for other elements"),
    "aligned": (mjcf(f'<freejoint align="true"/>{GEOM}'), "<freejoint align>: read 'true', which gives the body another frame"),
    "class": (mjcf('<geom class="none" size="1"/>'), "<geom class>: there is no default class 'none'"),
    "two attitudes": (mjcf('<geom size="1" quat="1 0 0 0" euler="0 0 0"/>'), "<geom euler>: quat is given too"),
    "no attitude": (mjcf('<geom type="box" size="1 1 1" quat="0 0 0 0"/>'), "<geom quat>: read '0 0 0 0'; allowed: vectors"),
    "parallel": (mjcf('<geom type="box" size="1 1 1" xyaxes="1 0 0 2 0 0"/>'), "<geom xyaxes>: read '1 0 0 2 0 0'"),
    "no length": (mjcf('<geom type="box" size="1 1 0"/>'), "<geom size>: read '1 1 0'; allowed: positive lengths"),
    "a no-break space": (
        mjcf('<geom type="box" size="1\u00a01 1"/>'),
        "<geom size>: read '1\\xa01 1'; allowed: 3 numbers separated by spaces",
    ),
    "few sizes": (mjcf('<geom type="box" size="1 1"/>'), "<geom size>: read '1 1'; allowed: 3 numbers separated by spaces"),
    "no ends": (mjcf('<geom type="capsule" size="1" fromto="1 0 0 1 0 0"/>'), "<geom fromto>: read '1 0 0 1 0 0'"),
    "full and turned": (
        mjcf('<inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0 0 0" euler="0 0 1"/>'),
        "<inertial fullinertia>: an attitude is given too",
    ),
    "no inertia": (mjcf('<inertial pos="0 0 0" mass="1"/>'), "its smallest principal moment is 0; all must be positive"),
    "coordinate": (compiler('coordinate="global"'), "<compiler coordinate>: read 'global', which MuJoCo no longer reads"),
    "balance": (compiler('balanceinertia="true"'), "<compiler balanceinertia>: read 'true', which changes bodies"),
    "total mass": (compiler('settotalmass="9"'), "<compiler settotalmass>: read '9', which changes masses"),
    "bound": (compiler('boundinertia="0.1"'), "<compiler boundinertia>: read '0.1', which changes masses"),
    "angle": (compiler('angle="grad"'), "<compiler angle>: read 'grad'; allowed: degree, radian"),
    "eulerseq": (compiler('eulerseq="abc"'), "<compiler eulerseq>: read 'abc'"),
    "impossible": (mjcf(INERTIAL.replace("1 1 1", "1 1 3")), "no body has these moments: no moment may exceed the sum"),
    "negative": (mjcf(INERTIAL.replace('mass="1"', 'mass="-1"')), "<inertial mass>: read -1.0; allowed: at least 0"),
    "infinite": (urdf(LINK.replace('ixx="1"', 'ixx="inf"')), "robot.xml:3: <inertia ixx>: read 'inf'; allowed: one number"),
    "huge": (urdf(LINK.replace('ixx="1"', 'ixx="1e999"')), "<inertia ixx>: read '1e999'"),
    "macro": (urdf(LINK.replace('value="1"', 'value="${m}"')), "<mass value>: read '${m}'; allowed: one number"),
    "xacro": (urdf(LINK + "<xacro:if/>"), "<xacro:if>: is a macro of xacro, which is not expanded here"),
    "no inertial": (urdf(""), "<link>: has no <inertial>"),
    "twice": (urdf(LINK + LINK), "<inertial>: a second <inertial> of one <link>"),
    "missing": (urdf(LINK.replace('ixy="0"', "")), "<inertia ixy>: is missing; allowed: one number"),
    "two of a name": (urdf(LINK).replace("</robot>", '<link name="torso"/></robot>'), "has 2 bodies of the name 'torso'"),
    "another name": (urdf(LINK).replace("torso", "torsos"), "has no body 'torso'; there are: 'torsos'; did you mean 'torsos'?"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_followed_is_refused_in_one_line(tmp_path: Path, what: str) -> None:
    text, told = REFUSED[what]
    (tmp_path / "robot.xml").write_text(text)
    done = bodycheck("new", "--from", "robot.xml", "--body", "torso", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert told in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["robot.xml"]


def test_a_large_file_and_no_file_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(elements, "MAX_BYTES", 100)
    (tmp_path / "robot.xml").write_text(urdf(LINK))
    with pytest.raises(BadInput, match="larger than 100 bytes"):
        robots.read(tmp_path / "robot.xml", None)
    with pytest.raises(BadInput, match="is not a regular file"):
        robots.read(tmp_path, None)
    with pytest.raises(BadInput, match="cannot be read: No such file"):
        robots.read(tmp_path / "absent.xml", None)


HOSTILE = "a&quot;]&#10;mass = 7&#10;[[expect]]&#x202e;" + "x" * 500


@pytest.mark.parametrize("model", [mjcf(INERTIAL), urdf(LINK)])
def test_no_text_of_a_model_becomes_a_key_of_the_case(tmp_path: Path, model: str) -> None:
    path = tmp_path / 'evil"\nmass = 8 #.xml'
    path.write_text(model.replace("torso", HOSTILE))
    case = parse(robots.text(template(), robots.read(path, None), path), "case")
    assert case.scene.body.mass == 1.0
    assert not case.expectations
    assert case.title.isprintable()


def test_the_case_says_what_it_is_and_what_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(mjcf(GEOM + f'<body name="hand">{GEOM}</body>'))
    done = bodycheck("new", "--from", "arm.xml", "--body", "torso", folder=tmp_path)
    assert (done.returncode, done.stdout) == (0, "torso.case.toml\n")
    assert done.stderr == "bodycheck: a case has one body; left out: 1 other body, fixed to it or not, and all joints\n"
    text = (tmp_path / "torso.case.toml").read_text()
    for line in (
        'name = "torso" ',
        'title = "torso of arm.xml"',
        "# which is at [0.0, 0.0, 0.0] m in that frame.",
        "# Mass and inertia: arm.xml: geoms of body 'torso', lines 4",
        "# Shape: arm.xml:4: <geom>",
        "semi_axes = [0.1, 0.2, 0.3]",
    ):
        assert line in text
    named = bodycheck("new", "my-hand", "--from", "arm.xml", "--body", "hand", folder=tmp_path)
    assert named.stdout == "my-hand.case.toml\n"
    done = bodycheck("new", "--from", "arm.xml", folder=tmp_path)
    assert (done.returncode, done.stderr) == (
        2,
        "arm.xml: has 2 bodies, of which a case has one; choose one by --body: 'torso', 'hand'\n",
    )


def test_a_case_that_is_given_for_a_robot_is_named_with_its_file(tmp_path: Path) -> None:
    (tmp_path / "own.case.toml").write_text("")
    for given, file in (("free-brick", shipped_file("free-brick")), ("own.case.toml", "own.case.toml")):
        with pytest.raises(BadInput, match=f"--from {given}: is a case; .* copy its file, {file}, and change its name"):
            new_of_robot("mine", tmp_path, Path(given), None)


@pytest.mark.parametrize(
    ("options", "told"),
    [((), "new: give a name"), (("brick", "--body", "torso"), "new --body: needs --from, the robot model of the body")],
)
def test_the_options_of_new_belong_together(tmp_path: Path, options: tuple[str, ...], told: str) -> None:
    done = bodycheck("new", *options, folder=tmp_path)
    assert (done.returncode, done.stderr) == (2, f"{told}\n")
