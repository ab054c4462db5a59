"""What helps those who write case files: a file to begin with, a schema for editors, suggestions, measured expectations."""

import json
import re
import tomllib
from collections.abc import Sequence
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft7Validator, Draft202012Validator

from bodycheck import CaseFaults, load
from bodycheck.casefile.authoring import SCHEMA_FILE, new, schema, template
from bodycheck.casefile.case import parse, shipped
from bodycheck.casefile.finding import SUFFIX
from bodycheck.casefile.values import MAX_NUMBER
from bodycheck.errors import BadInput
from bodycheck.figures.columns import LIMITED
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.suggestion import did_you_mean
from tests.support import ROOT
from tests.support.commands import bodycheck, call
from tests.support.tumbling import TUMBLING

CASES = resources.files("bodycheck.cases")

#: The files of the shipped cases by name.
FILES = {path.name.removesuffix(SUFFIX): path for path in Path(str(CASES)).rglob("*" + SUFFIX)}


@pytest.fixture(scope="module")
def validator() -> Draft202012Validator:
    document = json.loads(schema())
    Draft202012Validator.check_schema(document)
    return Draft202012Validator(document)


def test_what_new_writes_runs_as_it_is(calls_here: None, tmp_path: Path) -> None:
    done = bodycheck("new", "my-first-case", folder=tmp_path)
    assert (done.returncode, done.stdout) == (0, "my-first-case.case.toml\n")
    path = tmp_path / "my-first-case.case.toml"
    assert load(path).name == "my-first-case"
    assert path.read_text().startswith(f"#:schema ./{SCHEMA_FILE}\n")
    done = bodycheck("run", path.name, "--timestep", "0.01", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "my-first-case" in done.stdout


#: Beginnings of lines that stand commented out in the template, and of those that they stand instead of.
ALTERNATIVES = {
    "ellipsoid": (['shape = "ellipsoid"'], ['shape = "brick"']),
    "cylinder": (['shape = "cylinder"', "radius = 0.1  ", "half_length"], ['shape = "brick"', "semi_axes"]),
    "sphere": (['shape = "sphere"  ', "radius = 0.1  "], ['shape = "brick"', "semi_axes"]),
    "none": (['shape = "none"', "inertia = [0"], ['shape = "brick"', "semi_axes"]),
    "moments": (["inertia = [0"], []),
    "tensor": (["inertia = [["], []),
    "quaternion": (["quaternion"], ["euler_zxz"]),
    "rates": (["euler_rates"], ["angular_velocity"]),
    "plane": (["[scene.plane]", "friction", "law", "pressure"], ["position", "euler_zxz"]),
    "drag": (["[scene.drag]", "quadratic"], []),
    "sensors": (["[[sensors]]", "name", "type", "position = [0.1"], []),
    "extremes": (["[extremes]", "spin", "timestep = [0"], []),
    "ensemble": (
        ["[ensemble]", "members", "seed", "[[ensemble.vary]]", "key", "distribution", "mean", "standard_deviation"],
        [],
    ),
    "limits": (["[[expect]]", "engine", "integrator", "timestep = 0", "attitude_error", "energy_drift"], []),
    "order": (["[[expect]]", "engine", "integrator", "timestep = 0", "order", "known", "until"], []),
}


@pytest.mark.parametrize("name", ALTERNATIVES)
def test_what_the_template_has_commented_out_is_allowed(name: str) -> None:
    assert parse(uncommented(template(), *ALTERNATIVES[name]), "template") != parse(template(), "template")


def uncommented(text: str, wanted: Sequence[str], unwanted: Sequence[str]) -> str:
    """A template with lines that are no comments any more, and without those that they stand instead of."""
    lines = text.splitlines()
    for beginning in wanted:
        (at,) = [at for at, line in enumerate(lines) if line.startswith(f"# {beginning}")]
        lines[at] = lines[at].removeprefix("# ")
    for beginning in unwanted:
        (at,) = [at for at, line in enumerate(lines) if line.startswith(beginning)]
        lines[at] = ""
    return "\n".join(lines)


@pytest.mark.parametrize("name", ["", "Brick", "a b", "../escape", "x" * 101, "brick\n"])
def test_new_refuses_what_is_no_name(tmp_path: Path, name: str) -> None:
    with pytest.raises(BadInput, match="small letters, digits and hyphens"):
        new(name, tmp_path)
    assert not list(tmp_path.iterdir())


def test_new_overwrites_nothing(tmp_path: Path) -> None:
    new("brick", tmp_path).write_text("mine")
    with pytest.raises(BadInput, match="exists already"):
        new("brick", tmp_path)
    assert (tmp_path / "brick.case.toml").read_text() == "mine"
    with pytest.raises(BadInput, match="cannot be written"):
        new("brick", tmp_path / "absent")


def test_the_schema_that_is_shipped_is_that_of_the_grammar() -> None:
    """`bodycheck schema > cases/case.schema.json` renews it."""
    assert (CASES / SCHEMA_FILE).read_text("utf-8") == schema()


def test_the_command_prints_the_schema(capsys: pytest.CaptureFixture[str]) -> None:
    assert call("schema") == 0
    assert capsys.readouterr().out == schema()


def test_the_schema_in_draft_07_means_the_same(capsys: pytest.CaptureFixture[str], validator: Draft202012Validator) -> None:
    """All shipped cases fit both. What does not fit one does not fit the other: each key, in the first case that has it."""
    assert call("schema", "--draft", "07") == 0
    printed = json.loads(capsys.readouterr().out)
    Draft7Validator.check_schema(printed)
    assert "$defs" not in json.dumps(printed)
    older, tried = Draft7Validator(printed), set[str]()
    for name in shipped():
        table = tomllib.loads(FILES[name].read_text("utf-8"))
        assert older.is_valid(table), name
        for key in table.keys() - tried:
            tried.add(key)
            for changed in (table | {key: "no such value"}, {one: table[one] for one in table if one != key}, table | {"x": 1}):
                assert older.is_valid(changed) is validator.is_valid(changed), (name, key)


def test_the_schema_of_results_has_one_draft() -> None:
    with pytest.raises(BadInput, match="schema results --draft 07: read 07; allowed: 2020-12"):
        call("schema", "results", "--draft", "07")


def test_the_entry_for_catalogues_names_the_files_of_cases() -> None:
    entry = json.loads((ROOT / "docs" / "editors" / "schemastore.json").read_text("utf-8"))
    assert set(entry) == {"name", "description", "fileMatch", "url"}
    assert entry["fileMatch"] == [f"*{SUFFIX}"]
    assert entry["url"].endswith("/schemas/case.draft-07.schema.json")


@pytest.mark.parametrize("name", shipped())
def test_shipped_cases_fit_the_schema_and_tell_editors_of_it(name: str, validator: Draft202012Validator) -> None:
    text = FILES[name].read_text("utf-8")
    directive, schema = text.splitlines()[0].split()
    assert directive == "#:schema"
    assert (FILES[name].parent / schema).resolve() == Path(str(CASES / SCHEMA_FILE)).resolve()
    validator.validate(tomllib.loads(text))


LIMIT = re.compile(
    rf"(?:{'|'.join(LIMITED)}) = (?P<limit>\S+) +# (?P<margin>\S+) x (?P<measured>[\d.e-]+)[ ,].*measured with \w+ [\d.]+"
)


@pytest.mark.parametrize("name", shipped())
def test_limits_of_shipped_cases_say_what_they_were_set_from(name: str) -> None:
    """None is looser than three times what was measured."""
    lines = FILES[name].read_text("utf-8").partition("[[expect]]")[2].splitlines()
    limited = [line for line in lines if line.startswith(tuple(set(LIMITED) - {"order"})) and "{" not in line]
    assert limited or touches(load(name).scene)
    for line in limited:
        found = LIMIT.match(line)
        assert found, line
        limit, margin, stated = (float(found[part]) for part in ("limit", "margin", "measured"))
        assert margin <= 3
        # What was measured is stated with three digits, a floor with two.
        assert limit <= margin * stated * 1.05


def test_what_new_writes_of_a_mechanism_is_valid(calls_here: None, tmp_path: Path) -> None:
    done = bodycheck("new", "my-robot", "--mechanism", folder=tmp_path)
    assert (done.returncode, done.stdout) == (0, "my-robot.case.toml\n")
    made = load(tmp_path / "my-robot.case.toml").scene
    assert isinstance(made, Mechanism)
    assert [joint.name for joint in made.joints] == ["rail", "pin"]


def test_bodies_of_the_template_of_mechanisms_are_bodies_in_single_precision_too() -> None:
    """Engines of single precision refuse moments of which one is, but for rounding, the sum of the other two."""
    for body in tomllib.loads(template(mechanism=True))["bodies"]:
        *others, largest = sorted(np.array(body["inertia"], dtype=np.float32))
        assert np.sum(others) > largest


#: As above, in the template of mechanisms.
OF_MECHANISMS = {
    "cylinder": (['shape = "cylinder"', "radius = 0.02", "half_length"], ["inertia = [0.016"]),
    "free body": (["[[bodies]]", 'name = "ball"', 'shape = "sphere"', "radius = 0.05", "mass = 0.2", "initial"], []),
    "joint": (["euler_zxz", "armature", "damping", "stiffness", "rest", "friction", "effort =", "limits"], []),
    "controller": (["[[controllers]]", "joint", "law", "kp", "kd", "target", "rate", "effort_limit"], []),
    "loop": (["[[loops]]", "bodies = [", "points"], ["initial = {position = 0.0, velocity = 0.5}"]),
    "sensors": (["[[sensors]]", 'name = "imu"', "type", 'body = "pole"', "position = [0.0, 0.0, 0.5]"], []),
    "extremes": (["[extremes]", "speed", "timestep = [0"], []),
    "ensemble": (["[ensemble]", "members", "[[ensemble.vary]]", "key", "distribution", "low", "high"], []),
    "limits": (["[[expect]]", "engine", "integrator", "timestep = 0", "attitude_error"], []),
}


@pytest.mark.parametrize("name", OF_MECHANISMS)
def test_what_the_template_of_mechanisms_has_commented_out_is_allowed(name: str) -> None:
    template_of = template(mechanism=True)
    made = uncommented(template_of, *OF_MECHANISMS[name])
    assert parse(made, "template") != parse(template_of, "template")


def test_the_templates_fit_the_schema(validator: Draft202012Validator) -> None:
    validator.validate(tomllib.loads(template()))
    validator.validate(tomllib.loads(template(mechanism=True)))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("mass = 1.0", "mass = -1.0"),
        ("mass = 1.0", "mass = 0"),
        ("mass = 1.0", "mas = 1.0"),
        ("mass = 1.0", 'mass = "1"'),
        ("mass = 1.0", f"mass = {10 * MAX_NUMBER:g}"),
        ('shape = "brick"', 'shape = "brik"'),
        ("[0.1, 0.2, 0.3]", "[0.1, 0.2]"),
        ("format = 1", "format = 2"),
        ('name = "tumbling"', 'name = "Tumbling"'),
        ("samples = 11", "samples = 1000000000000"),
        ("samples = 11", "samples = 11.5"),
        ("order = 1", "ordr = 1"),
        ("{at_most = 9.0}", "{at_mst = 9.0}"),
        ("{at_most = 9.0}", "-9.0"),
        ('engine = "mujoco"', 'engine = "mujoco"\nstatus = "fine"'),
        ("[run]", "[extremes]\nspin = [-1.0]\n[run]"),
    ],
)
def test_the_schema_refuses_what_the_grammar_refuses(old: str, new: str, validator: Draft202012Validator) -> None:
    assert validator.is_valid(tomllib.loads(TUMBLING))
    assert old in TUMBLING
    text = TUMBLING.replace(old, new, 1)
    assert not validator.is_valid(tomllib.loads(text))
    with pytest.raises(CaseFaults):
        parse(text, "f")


def test_every_key_of_the_schema_says_what_it_is() -> None:
    document = json.loads(schema())
    assert "null" not in schema(), "TOML has no null"
    assert document["title"]
    for table in document["$defs"].values():
        for key, field in table["properties"].items():
            assert "description" in field or "const" in field or "$ref" in field or key == "shape", key


@pytest.mark.parametrize(
    ("word", "known", "end"),
    [
        ("atitude_error", ("attitude_error", "angular_velocity_error"), "; did you mean 'attitude_error'?"),
        ("semiaxes", ("semi_axes", "mass"), "; did you mean 'semi_axes'?"),
        ("MuJoCo", ("pinocchio", "mujoco"), "; did you mean 'mujoco'?"),
        ("RK44", ("rk4", "RK4"), "; did you mean 'RK4'?"),
        ("rk44", ("RK4", "rk4"), "; did you mean 'rk4'?"),
        ("frob", ("mass", "shape"), ""),
        ("", ("mass",), ""),
        ("mass" * 1000, ("mass",), ""),
        ("mass", (), ""),
    ],
)
def test_did_you_mean(word: str, known: tuple[str, ...], end: str) -> None:
    assert did_you_mean(word, known) == end


@pytest.mark.parametrize(
    ("old", "new", "meant"),
    [
        ("mass =", "mas =", "mass"),
        ('"brick"', '"brik"', "brick"),
        ("[run]", '[scene.plane]\nlaw = "aera"\n[run]', "area"),
        ("[run]", '[scene.plane]\npressure = "unifrom"\n[run]', "uniform"),
        ('engine = "mujoco"', 'engine = "mujoco"\nstatus = "divergd"', "diverged"),
        ("attitude_error =", "atitude_error =", "attitude_error"),
        ("[initial]", "[inital]", "initial"),
        ("at_most", "atmost", "at_most"),
    ],
)
def test_a_fault_asks_for_what_was_meant(old: str, new: str, meant: str) -> None:
    with pytest.raises(CaseFaults) as caught:
        parse(TUMBLING.replace(old, new, 1), "f")
    assert f"; did you mean {meant!r}?" in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (("run", "fre-brick"), "free-brick"),
        (("validate", "free_brick"), "free-brick"),
        (("run", "free-brick", "--engine", "mujco"), "mujoco"),
        (("run", "free-brick", "--integrator", "RK44"), "RK4"),
    ],
)
def test_the_command_line_asks_for_what_was_meant(arguments: tuple[str, ...], meant: str) -> None:
    with pytest.raises(BadInput, match=re.escape(f"did you mean {meant!r}?")):
        call(*arguments)
