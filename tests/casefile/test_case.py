"""Case files: the grammar, and that every fault is told where it stands."""

import math
import os
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck import Case, CaseFaults, load
from bodycheck.casefile.case import MAX_FILE_BYTES, Fault, parse, shipped
from bodycheck.casefile.expectation import Limit
from bodycheck.casefile.toml_positions import positions
from bodycheck.casefile.values import MAX_EXPECTATIONS, MAX_INSTANTS, MAX_SAMPLES
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Plane, Sphere
from tests.support.cases import a_case

GOOD = """\
format = 1
name = "good"
title = "A good case"

[body]
shape = "brick"
semi_axes = [0.1, 0.3, 0.2]
mass = 2

[initial]
euler_zxz = [0.1, 0.2, 0.3]
euler_rates = [0.0, 0.1, 10.0]

[scene]
gravity = 9.81
[scene.plane]
friction = 0.5
law = "corners"
[scene.drag]
quadratic = 0.01

[run]
duration = 10.0
samples = 1001

[[expect]]
engine = "mujoco"
integrator = "RK4"
timestep = 0.002
attitude_error = 1e-6
"""


def faults(text: str) -> dict[str, str]:
    with pytest.raises(CaseFaults) as caught:
        parse(text, "f")
    return {f"{fault.position.line if fault.position else 0} {fault.key}": fault.message for fault in caught.value.faults}


def test_the_grammar_in_full() -> None:
    case = parse(GOOD, "f")
    scene = case.scene
    assert (case.name, case.duration, case.samples) == ("good", 10.0, 1001)
    assert scene.body.mass == 2.0
    assert scene.body.shape == Brick((0.1, 0.3, 0.2))
    np.testing.assert_allclose(scene.body.moments, [2 * 0.13 / 3, 2 * 0.05 / 3, 2 * 0.1 / 3], rtol=1e-15)
    assert scene.plane == Plane(0.5, "corners", "uniform")
    assert (scene.gravity, scene.drag) == (9.81, 0.01)
    # [G 2.21a] with phi' = 0.
    np.testing.assert_allclose(scene.initial.angular_velocity, [0.1 * math.cos(0.3), -0.1 * math.sin(0.3), 10.0], rtol=1e-15)
    assert math.hypot(*scene.initial.quaternion) == pytest.approx(1, abs=2e-16)
    (expectation,) = case.expectations
    assert expectation.limits == (Limit("attitude_error", None, 1e-6),)


@pytest.mark.parametrize(
    ("body", "shape"),
    [
        ('shape = "ellipsoid"\nsemi_axes = [1.0, 2.0, 3.0]', Ellipsoid((1.0, 2.0, 3.0))),
        ('shape = "cylinder"\nradius = 1.0\nhalf_length = 2.0', Cylinder(1.0, 2.0)),
        ('shape = "sphere"\nradius = 1.0', Sphere(1.0)),
        ('shape = "none"\ninertia = [1.0, 2.0, 3.0]', None),
    ],
)
def test_every_shape(body: str, shape: object) -> None:
    assert parse(GOOD.replace('shape = "brick"\nsemi_axes = [0.1, 0.3, 0.2]', body), "f").scene.body.shape == shape


def test_inertia_overrides_the_shape() -> None:
    assert parse(GOOD.replace("mass = 2", "mass = 2\ninertia = [1, 2, 3]"), "f").scene.body.moments == (1.0, 2.0, 3.0)


def test_shipped_cases_are_what_the_package_promises() -> None:
    names = {
        *("free-brick", "short-axis-spin", "intermediate-axis-flip", "projectile", "gimbal-start"),
        *("osrf-boxes-simple", "osrf-boxes-complex", "mujoco-free-body"),
    }
    assert names <= set(shipped())


def test_shipped_cases_are_named_as_their_files(shipped_case: Case) -> None:
    assert load(shipped_case.name) == shipped_case
    assert shipped_case.source
    if not touches(shipped_case.scene):
        assert {"mujoco", "pinocchio"} <= {expectation.engine for expectation in shipped_case.expectations}


def test_all_faults_at_once_each_with_its_line() -> None:
    text = """\
format = 3
name = "Bad Name"
frob = 1
[body]
shape = "brick"
semi_axes = [0.1, -0.3, "x"]
mass = 0
inertia = [1, 1, 5]
[initial]
euler_zxz = [0, 0, nan]
quaternion = [1, 0, 0, 0]
euler_rates = [0, 0, 1]
angular_velocity = [0, 0, 1]
[scene.plane]
law = "foo"
[run]
duration = 10.0
samples = 1000000000000
[[expect]]
engine = "mujoco"
integrator = "RK4"
timestep = 0.002
"""
    assert set(faults(text)) == {
        *("1 format", "2 name", "3 frob", "1 title", "6 body.semi_axes[2]", "6 body.semi_axes[3]", "7 body.mass"),
        *("8 body.inertia", "10 initial.euler_zxz[3]", "11 initial.quaternion", "13 initial.angular_velocity"),
        *("15 scene.plane.law", "18 run.samples", "19 expect[1]"),
    }


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("mass = 2", "mass = true", "8 body.mass", "read True"),
        ("mass = 2", 'mass = "2"', "8 body.mass", "read '2'; should be a valid number"),
        ("mass = 2", "mass = inf", "8 body.mass", "finite"),
        ("mass = 2", "mass = 1e-200", "8 body.mass", "at least 1e-100 in size"),
        ("mass = 2\n", "", "5 body.mass", "is missing"),
        ('shape = "brick"', 'shape = "brik"', "6 body.shape", "allowed: brick, ellipsoid, cylinder, sphere, none"),
        ('shape = "brick"\n', "", "5 body.shape", "is missing; allowed: brick"),
        ("gravity = 9.81", "gravty = 9.81", "15 scene.gravty", "unknown key; allowed: gravity, plane, drag"),
        ("10.0]", "1e-160]", "12 initial.euler_rates[3]", "should be 0, or at least 1e-100"),
        ("gravity = 9.81", "gravity = -9.81", "15 scene.gravity", "greater than or equal to 0"),
        ("[0.1, 0.2, 0.3]", "[0.1, 0.2]", "11 initial.euler_zxz", "is missing"),
        ("duration = 10.0", "duration = 1e9", "29 expect[1].timestep", "steps; at most"),
        ("timestep = 0.002", "timestep = 1e-30", "29 expect[1].timestep", "steps; at most"),
        ("timestep = 0.002", "timestep = 10.5", "29 expect[1].timestep", "longer than the run; allowed: at most"),
        ("0.002\nattitude_error = 1e-6", "2e-8\norder = 4.0", "29 expect[1].timestep", "results in 2e+09 steps; at most"),
        ("samples = 1001", "samples = 1e3", "24 run.samples", "valid integer"),
        ("attitude_error = 1e-6", "atitude_error = 1e-6", "30 expect[1].atitude_error", "unknown key; allowed: engine"),
        ('engine = "mujoco"', 'engine = "=cmd()"', "27 expect[1].engine", "'=cmd()' is no name of an engine"),
        ('integrator = "RK4"', 'integrator = "##[error]x"', "28 expect[1].integrator", "is no name of an integrator"),
        ("[body]", "[[body]]", "5 body", "should be a table"),
        ('title = "A good case"', "title = ", "3 ", "not TOML"),
        ("[run]", "[body]", "22 ", "not TOML"),
    ],
)
def test_one_fault(old: str, new: str, place: str, words: str) -> None:
    found = faults(GOOD.replace(old, new, 1))
    assert any(key.startswith(place) and words in message for key, message in found.items()), found


def expecting(steps: int, samples: int, figure: str = "attitude_error") -> str:
    """The good case with so many time steps in its expectations, of which all but the first limit a figure."""
    return GOOD.replace("samples = 1001", f"samples = {samples}") + "".join(
        f'[[expect]]\nengine = "mujoco"\nintegrator = "RK4"\ntimestep = {0.01 + 1e-4 * place!r}\n{figure} = 1.0\n'
        for place in range(1, steps)
    )


def test_a_case_may_expect_something_at_many_time_steps() -> None:
    assert len(parse(expecting(MAX_EXPECTATIONS, 1001), "good").expectations) == MAX_EXPECTATIONS


@pytest.mark.parametrize(("figure", "runs"), [("attitude_error", 1), ("order", 3)])
def test_the_instants_of_all_time_steps_are_bounded(figure: str, runs: int) -> None:
    """The truth is computed at all of them, so that the work that a file asks for is known before any of it is done.

    An order is measured with two smaller time steps too.
    """
    most = 1 + (MAX_INSTANTS // MAX_SAMPLES - 1) // runs
    assert len(parse(expecting(most, MAX_SAMPLES, figure), "good").expectations) == most
    ((place, message),) = faults(expecting(most + 1, MAX_SAMPLES, figure)).items()
    assert place == "26 expect"
    told = f"for {1 + runs * most} time steps with 100001 samples each; at most {MAX_INSTANTS:.3g} are allowed"
    assert message.endswith(told)


def test_a_missing_coordinate_is_one_fault() -> None:
    assert set(faults(GOOD.replace("[0.1, 0.2, 0.3]", "[0.1, 0.2]"))) == {"11 initial.euler_zxz[3]"}


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    huge, binary = tmp_path / "huge.case.toml", tmp_path / "binary.case.toml"
    huge.write_text("#" * (MAX_FILE_BYTES + 1))
    binary.write_bytes(b"\xff\xfe\x00")
    marked, pipe, endless = (tmp_path / f"{name}.case.toml" for name in ("marked", "pipe", "endless"))
    marked.write_bytes(b'\xef\xbb\xbfformat = 1\nname = "marked"\n')
    os.mkfifo(pipe)
    endless.symlink_to("/dev/zero")
    for path, words in (
        (huge, "larger than"),
        (binary, "cannot be read"),
        (marked, "1:1: begins with a byte order mark"),
        (tmp_path / "absent", "no such file"),
        (tmp_path, "is not a regular file"),
        (pipe, "is not a regular file"),
        (endless, "is not a regular file"),
    ):
        with pytest.raises(CaseFaults, match=words) as caught:
            load(path)
        assert str(path) in str(caught.value)


def test_deep_nesting_is_a_fault() -> None:
    assert "nested" in "".join(faults("x = " + "[" * 100_000).values())


@settings(max_examples=300)
@given(st.data())
def test_a_mutilated_file_is_a_case_or_has_faults(data: st.DataObject) -> None:
    """Whatever a stranger's file says, it is answered by faults that name a line of it."""
    lines = GOOD.splitlines()
    at = data.draw(st.integers(0, len(lines) - 1))
    lines[at] = data.draw(
        st.one_of(
            st.text(max_size=30),
            st.sampled_from(
                ["[", "]]", "[a.b]", '"x" = 1', "mass = 1" + "0" * 400, "samples = -1", "tags = [[[]]]", "expect = 3"]
            ),
            st.sampled_from(lines),
            st.builds(re.sub, st.just(r"[0-9]+"), st.sampled_from(["-1", "nan", "9" * 40, '"x"', "{}"]), st.just(lines[at])),
        )
    )
    text = "\n".join(lines)
    try:
        parse(text, "f")
        found: tuple[Fault, ...] = ()
    except CaseFaults as error:
        found = error.faults or (Fault("no fault is named", "?"),)
    assert all(fault.position and 1 <= fault.position.line <= text.count("\n") + 2 for fault in found)


KEY = st.sampled_from(["a", "b", "c d", "é"])


@given(st.dictionaries(KEY, st.one_of(st.integers(), st.lists(st.integers()), st.dictionaries(KEY, st.integers()))))
def test_every_key_has_a_position(document: dict[str, object]) -> None:
    def quoted(key: str) -> str:
        return key if key.isascii() and key.isalnum() else f'"{key}"'

    def written(value: object) -> str:
        if isinstance(value, dict):
            return "{" + ", ".join(f"{quoted(k)} = {v}" for k, v in value.items()) + "}"
        return str(value)

    text = "\n".join(f"{quoted(key)} = {written(value)}" for key, value in document.items())
    assert tomllib.loads(text) == document
    inner = {
        (key, part)
        for key, value in document.items()
        for part in (value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ())
    }
    found = positions(text, [*inner, *((key,) for key in document)])
    assert set(found) == {(), *inner, *((key,) for key in document)}
    for line, key in enumerate(document, start=1):
        assert found[(key,)] == (line, 1)
        assert all(found[path].line == line for path in inner if path[0] == key)


def test_positions_in_arrays_of_tables() -> None:
    text = "[[a]]\nx = 1\n[[a]]\n[a.b]\ny.z = 2\n[[a.c]]\nw = [\n 1,\n 2]\n"
    found = positions(text, [("a", 0, "x"), ("a", 1, "b", "y", "z"), ("a", 1, "c", 0, "w", 1), ("a", 2), ("b",)])
    assert ("a", 2) not in found
    assert ("b",) not in found
    assert found["a", 0, "x"].line == 2
    assert found["a", 1].line == 3
    assert found["a", 1, "b", "y", "z"].line == 5
    assert found["a", 1, "c", 0, "w", 1].line == 9


@pytest.mark.parametrize(
    ("mass", "size", "initial", "what"),
    [
        ("1e100", "1e10", "angular_velocity = [0.1, 0.0, 1e40]", "kinetic energy is 3.33e+199 J"),
        ("1e100", "1", "velocity = [0.0, 0.0, 1e30]", "kinetic energy is 5.0e+159 J"),
        ("1e100", "1e40", "angular_velocity = [0.0, 0.0, 1e-20]", "angular momentum is 6.67e+159 kg m^2/s"),
    ],
)
def test_a_motion_whose_numbers_would_overflow_is_refused(mass: str, size: str, initial: str, what: str) -> None:
    text = GOOD.replace("mass = 2", f"mass = {mass}").replace("[0.1, 0.3, 0.2]", f"[{size}, {size}, {size}]", 1)
    before = text.partition("[initial]")[2].partition("\n[")[0]
    ((where, message),) = faults(text.replace(before, f"\n{initial}\n")).items()
    assert where.endswith("initial")
    assert what in message
    assert "at most 1e+150" in message


@pytest.mark.parametrize(
    ("place", "change", "what"),
    [
        (
            "body",
            {"mass = 2": "mass = 1e100", "[0.1, 0.3, 0.2]": "[1e30, 1e30, 1e30]", "[0.0, 0.1, 10.0]": "[0.0, 0.0, 0.0]"},
            "largest moment of inertia is 6.67e+159",
        ),
        (
            "body",
            {"mass = 2": "mass = 1e-100", "[0.1, 0.3, 0.2]": "[1e-30, 1e-30, 1e-30]"},
            "smallest moment of inertia, inverted, is 1.5e+160",
        ),
        (
            "initial",
            {
                "mass = 2": "mass = 1e100",
                "[0.1, 0.3, 0.2]": "[1e100, 0.9e100, 0.8e100]",
                "[0.0, 0.1, 10.0]": "[0.1, 0.0, 1e10]",
            },
            "kinetic energy is 3.02e+319 J",
        ),
        (
            "run.duration",
            {"10.0\nsamples": "1e90\nsamples", "timestep = 0.002": "timestep = 1e85"},
            "distance from the origin at the end is",
        ),
    ],
)
def test_a_body_or_a_way_whose_numbers_would_overflow_is_refused(place: str, change: dict[str, str], what: str) -> None:
    text = GOOD
    for one, other in change.items():
        assert one in text
        text = text.replace(one, other, 1)
    ((where, message),) = faults(text).items()
    assert where.endswith(place)
    assert what in message


def test_a_part_without_a_direction_is_refused() -> None:
    parts = """[[body.parts]]
shape = "sphere"
radius = 1.0
mass = 1.0
quaternion = [0.0, 0.0, 0.0, 0.0]
"""
    text = a_case(body={}).replace("[body]\n", parts)
    ((where, message),) = faults(text).items()
    assert where.endswith("body.parts[1].quaternion")
    assert message.endswith("its length is 0; any other length is allowed")
