"""What helps those who write case files: a file to begin with, a schema for editors, suggestions, measured expectations."""

import json
import re
import tomllib
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from bodycheck import Case, CaseFaults, load, simulate, truth
from bodycheck.casefile.authoring import SCHEMA_FILE, new, schema, template
from bodycheck.casefile.case import SUFFIX, parse, shipped
from bodycheck.casefile.values import MAX_NUMBER
from bodycheck.errors import BadInput
from bodycheck.figures.columns import LIMITED
from bodycheck.judging import judgement
from bodycheck.judging.expectation_writer import Measurement, floors, measure, rewrite
from bodycheck.reference.truth import NoTruth
from bodycheck.suggestion import did_you_mean
from tests.support.commands import bodycheck, call
from tests.support.truths import truth_for_runs

CASES = resources.files("bodycheck.cases")
DIRECTIVE = f"#:schema ./{SCHEMA_FILE}\n"

TUMBLING = """\
# A comment before everything.
format = 1
name = "tumbling"
title = "A brick that tumbles"
[run]                 # not where it usually stands
samples = 11
duration = 0.1

[[expect]]  # of the first engine
timestep = 0.01
integrator = "Euler"
engine = "mujoco"
order = 1             # and this stays
attitude_error = 9.0  # set by hand
energy_drift = {at_most = 9.0}
velocity_error   =   9          # 3 x 9.99 measured with mujoco 1.0.0
angular_velocity_error=9.0

[body]
shape = "brick"
semi_axes = [0.1, 0.2, 0.3]
mass = 1.0
[initial]
angular_velocity = [1.0, 5.0, 0.1]
velocity = [1.0, 0.0, 0.0]
# A comment after everything."""


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
    assert path.read_text().startswith(DIRECTIVE)
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
    "extremes": (["[extremes]", "spin", "timestep = [0"], []),
    "limits": (["[[expect]]", "engine", "integrator", "timestep = 0", "attitude_error", "energy_drift"], []),
    "order": (["[[expect]]", "engine", "integrator", "timestep = 0", "order", "known", "until"], []),
}


@pytest.mark.parametrize("name", ALTERNATIVES)
def test_what_the_template_has_commented_out_is_allowed(name: str) -> None:
    wanted, unwanted = ALTERNATIVES[name]
    lines = template().splitlines()
    for beginning in wanted:
        (at,) = [at for at, line in enumerate(lines) if line.startswith(f"# {beginning}")]
        lines[at] = lines[at].removeprefix("# ")
    for beginning in unwanted:
        (at,) = [at for at, line in enumerate(lines) if line.startswith(beginning)]
        lines[at] = ""
    assert parse("\n".join(lines), "template") != parse(template(), "template")


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


@pytest.mark.parametrize("name", shipped())
def test_shipped_cases_fit_the_schema_and_tell_editors_of_it(name: str, validator: Draft202012Validator) -> None:
    text = (CASES / (name + SUFFIX)).read_text("utf-8")
    assert text.startswith(DIRECTIVE)
    validator.validate(tomllib.loads(text))


LIMIT = re.compile(
    rf"(?:{'|'.join(LIMITED)}) = (?P<limit>\S+) +# (?P<margin>\S+) x (?P<measured>[\d.e-]+)[ ,].*measured with \w+ [\d.]+"
)


@pytest.mark.parametrize("name", shipped())
def test_limits_of_shipped_cases_say_what_they_were_set_from(name: str) -> None:
    """None is looser than three times what was measured."""
    lines = (CASES / (name + SUFFIX)).read_text("utf-8").partition("[[expect]]")[2].splitlines()
    limited = [line for line in lines if line.startswith(tuple(set(LIMITED) - {"order"})) and "{" not in line]
    assert limited
    for line in limited:
        found = LIMIT.match(line)
        assert found, line
        limit, margin, stated = (float(found[part]) for part in ("limit", "margin", "measured"))
        assert margin <= 3
        # What was measured is stated with three digits, a floor with two.
        assert limit <= margin * stated * 1.05


def test_the_template_fits_the_schema(validator: Draft202012Validator) -> None:
    validator.validate(tomllib.loads(template()))


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
    for table in (document, *document["$defs"].values()):
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


def measured(case: Case, engine: str = "mujoco", integrator: str = "Euler", timestep: float = 0.01) -> Measurement:
    reference = truth_for_runs(case, timestep)
    return measure(judgement.verdict(case, reference, simulate(case, engine, integrator, timestep)), reference)


def limits(case: Case) -> dict[str, float | None]:
    return {limit.name: limit.at_most for limit in case.expectations[0].limits}


def test_numbers_are_renewed_and_all_else_stays() -> None:
    """Comments, order, spaces, ranges and orders of a table that is there; only the numbers and our own comments change."""
    case = parse(TUMBLING, "f")
    measurement = measured(case)
    text, (change,) = rewrite(case, [measurement], 3.0)
    assert (change.text, change.done) == ("renewed", True)
    before, after = TUMBLING.split("\n"), text.split("\n")
    changed = {old: new for old, new in zip(before, after, strict=True) if old != new}
    figures = measurement.figures
    names = [re.split("[ =]", line)[0] for line in changed]
    assert names == ["attitude_error", "velocity_error", "angular_velocity_error"]
    assert all("# set by hand" in new for old, new in changed.items() if "# set by hand" in old)
    found = limits(parse(text, "f"))
    for name in ("attitude_error", "angular_velocity_error"):
        assert figures[name] > measurement.floors[name]
        # Rounded down to two digits.
        assert 3 * figures[name] / 1.1 <= (found[name] or 0) <= 3 * figures[name]
    assert found["energy_drift"] == 9.0
    line, version = after[before.index("angular_velocity_error=9.0")], measurement.verdict.run.version
    assert line.endswith(f"# 3 x {figures['angular_velocity_error']:.3g} measured with mujoco {version}")
    # The column of the comment that was there.
    (velocity,) = (line for line in after if line.startswith("velocity_error   =   "))
    assert velocity.index("#") == 32
    assert "measured with mujoco 1.0.0" not in text
    again, _ = rewrite(parse(text, "f"), [measurement], 3.0)
    assert again == text


def test_a_new_table_stands_at_the_end_and_limits_all_figures() -> None:
    case = parse(TUMBLING, "f")
    measurement = measured(case, "pinocchio", "rk4", 0.01)
    text, (change,) = rewrite(case, [measurement], 2.0)
    assert change.text == "written"
    assert text.startswith(TUMBLING + "\n\n[[expect]]\n")
    added = parse(text, "f").expectations[1]
    assert (added.engine, added.method.name, added.method.timestep) == ("pinocchio", "rk4", 0.01)
    assert {limit.name for limit in added.limits} == set(measurement.figures)
    for limit in added.limits:
        taken = max(measurement.figures[limit.name], measurement.floors[limit.name])
        assert 2 * taken / 1.1 <= (limit.at_most or 0) <= 2 * taken
    assert judgement.verdict(parse(text, "f"), truth_for_runs(case, 0.01), measurement.verdict.run).passed is True


def test_tables_between_expectations_stay_where_they_are() -> None:
    """As in a file to which expectations were added: its numbers are renewed, and nothing is moved."""
    case = parse(TUMBLING, "f")
    measurements = [measured(case), measured(case, "pinocchio", "rk4", 0.01)]
    text, _ = rewrite(case, measurements, 3.0)
    assert text.index("[[expect]]") < text.index("[body]") < text.rindex("[[expect]]")
    again, changes = rewrite(parse(text, "f"), measurements, 3.0)
    assert [change.text for change in changes] == ["renewed", "renewed"]
    assert again == text
    spread = re.sub(r"(?<=\n)\[body\]", "[ body ]  # stays", text)
    assert rewrite(parse(spread, "f"), measurements, 3.0)[0] == spread


def test_windows_line_ends_stay() -> None:
    case = parse(TUMBLING.replace("\n", "\r\n"), "f")
    text, _ = rewrite(case, [measured(case), measured(case, "pinocchio", "rk4")], 3.0)
    assert text.count("\n") == text.count("\r\n") > 30
    plain = parse(TUMBLING, "f")
    assert text.replace("\r\n", "\n") == rewrite(plain, [measured(plain), measured(plain, "pinocchio", "rk4")], 3.0)[0]


def test_what_is_known_to_fail_and_statuses_are_left() -> None:
    known = TUMBLING.replace("order = 1 ", 'known = "https://example.org/7"\nuntil = "2030-01-01"\n')
    case = parse(known, "f")
    text, (change,) = rewrite(case, [measured(case)], 3.0)
    assert (text, change.done) == (known, True)
    assert "known to fail (https://example.org/7)" in change.text
    diverged = TUMBLING.split("order")[0] + 'status = "diverged"\n[body]' + TUMBLING.split("[body]")[1]
    case = parse(diverged, "f")
    text, (change,) = rewrite(case, [measured(case)], 3.0)
    assert (text, change.done) == (diverged, False)
    assert change.text == "left as it is: diverged is expected, found is ok"


def test_a_run_that_is_not_ok_is_expected_to_end_like_that() -> None:
    text = (
        TUMBLING.split("[[expect]]")[0] + "[scene]\ndrag = {quadratic = 0.1}\nplane = {}\n[body]" + TUMBLING.split("[body]")[1]
    )
    case = parse(text, "f")
    reference = NoTruth("no model")
    measurement = measure(judgement.verdict(case, reference, simulate(case, "mujoco", "Euler", 0.01)), reference)
    written, (change,) = rewrite(case, [measurement], 3.0)
    (expectation,) = parse(written, "f").expectations
    assert (expectation.status, expectation.limits, change.done) == ("unsupported", (), True)


def test_floors_are_what_rounding_comes_to() -> None:
    """A thrown body that does not turn: all errors of a Runge-Kutta method are rounding, and are limited above it."""
    case = load("projectile")
    measurement = measured(case, "mujoco", "RK4", 0.002)
    assert set(measurement.floors) == set(measurement.figures)
    # 1e-12 of 20 m, the farthest that it comes, and of 14.1 m/s, its speed at the beginning and about that at the end.
    assert 2e-11 < measurement.floors["position_error"] < 2.3e-11
    assert 1.4e-11 < measurement.floors["velocity_error"] < 1.6e-11
    assert all(value < measurement.floors[name] for name, value in measurement.figures.items())
    text, _ = rewrite(parse(case.text.split("[[expect]]")[0], "f"), [measurement], 3.0)
    for limit in parse(text, "f").expectations[0].limits:
        assert limit.at_most == pytest.approx(3 * measurement.floors[limit.name], rel=0.1)  # two digits
    assert text.count("is rounding") == len(measurement.figures)


def test_no_floor_vanishes() -> None:
    """Of what is zero in a scene, rounding is that of what it is made of: a limit of nothing would break anywhere else."""
    case = load("resting-brick")
    reference = truth(case)
    names = ("position_error", "velocity_error", "angular_velocity_error", "attitude_error", "creep", "angular_momentum_error")
    found = floors(reference, names)
    assert np.all([value >= 1e-14 for value in found.values()])


def test_expect_measures_and_writes(calls_here: None, tmp_path: Path) -> None:
    path = tmp_path / "tumbling.case.toml"
    path.write_bytes(TUMBLING.replace("\n", "\r\n").encode())
    options = ("--integrator", "Euler", "--integrator", "rk4", "--margin", "2.5", "--jobs", "2")
    done = bodycheck("expect", path.name, *options, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert re.findall(r"(\w+) +(\S+) +([\d.]+) +(\w+) *$", done.stdout, re.M) == [
        ("mujoco", "Euler", "0.002", "written"),
        ("mujoco", "Euler", "0.01", "renewed"),
        ("pinocchio", "rk4", "0.002", "written"),
    ]
    content = path.read_bytes()
    assert content.count(b"\n") == content.count(b"\r\n")
    assert content.count(b"# 2.5 x ") > 10
    case = load(path)
    steps = [expectation.method.timestep for expectation in case.expectations]
    assert steps == [0.01, 0.002, 0.002], "none for the finer steps that an order needs"
    done = bodycheck("run", path.name, "--integrator", "Euler", "--integrator", "rk4", folder=tmp_path)
    assert done.returncode == 0, done.stdout
    assert "3 passed, 0 failed" in done.stdout


def test_a_case_for_which_there_is_no_such_method_is_left(calls_here: None, tmp_path: Path) -> None:
    free, lying = tmp_path / "free.case.toml", tmp_path / "lying.case.toml"
    free.write_text(TUMBLING)
    lying.write_text(load("resting-brick").text.split("[extremes]")[0])
    assert call("expect", str(free), str(lying), "--integrator", "law-force", "--jobs", "1") == 0
    assert free.read_text() == TUMBLING
    assert [e.method.name for e in load(lying).expectations] == ["law-force"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "give at least one case file"),
        (("free-brick",), "free-brick: the name of a shipped case; give the path of a file"),
        (("absent.case.toml",), "there is no such file"),
        (("inline.case.toml",), "inline.case.toml: expect: an array; write its elements as [[expect]] tables"),
        (("good.case.toml", "--margin", "1"), "--margin 1: must be at least 1.1"),
        (("good.case.toml", "--margin", "nan"), "--margin nan"),
        (("good.case.toml", "--integrator", "RK44"), "did you mean"),
    ],
)
def test_expect_refuses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str) -> None:
    inline = 'expect = [{engine = "mujoco", integrator = "Euler", timestep = 0.01, status = "ok"}]\n'
    bare = TUMBLING.split("[[expect]]")[0] + "[body]" + TUMBLING.split("[body]")[1]
    texts = {"good.case.toml": TUMBLING, "inline.case.toml": inline + bare}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput, match=re.escape(words)):
        call("expect", *arguments)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == texts
