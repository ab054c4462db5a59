"""The members of an ensemble as scenes, as cases and as files, which are the same to the last bit."""

import pickle
import re
import tomllib
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.casefile.case import Case, parse, shipped
from bodycheck.casefile.expectation import Limit
from bodycheck.casefile.toml_text import written
from bodycheck.errors import BadInput
from bodycheck.reference.exact.numbers import Real, Wide, real
from bodycheck.reference.exact.start import start
from bodycheck.reference.flight.closed_form import flight
from bodycheck.reference.flight.flights import flights
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scenes import Scenes
from bodycheck.studies.ensemble.drawing import members
from tests.support.cases import a_case, expecting
from tests.support.ensemble_texts import (
    BRICK,
    CYLINDER_ON_PLANE,
    DRAGGED,
    MOMENTS,
    PARTICLES,
    PARTS,
    TENSOR,
    attitude,
    choice,
    columns_of,
    ensemble_of,
    log_uniform,
    normal,
    sphere,
    uniform,
)

BALL = a_case("ball", body={"shape": "sphere", "radius": 0.1, "mass": 1.0})
ROD = a_case("rod", body={"shape": "cylinder", "radius": 0.1, "half_length": 0.5, "mass": 1.0})
TURNED = a_case(
    "turned",
    body={"shape": "brick", "semi_axes": [0.1, 0.3, 0.2], "mass": 1.0},
    initial={"euler_zxz": [0.1, 0.2, 0.3], "euler_rates": [0.0, 0.1, 10.0]},
)

QUICK = {
    "every key": ensemble_of(
        BRICK,
        *(log_uniform("body.mass", 0.1, 10), uniform("body.semi_axes", [0.1, 0.1, 0.1], [1, 2, 3]), attitude()),
        *(normal("initial.velocity", 0, 1), sphere("initial.angular_velocity", 5), uniform("initial.position", -1, 1)),
        choice("scene.gravity", [0, 1.62, 9.81]),
    ),
    "components": ensemble_of(
        BRICK,
        *(uniform("body.semi_axes.1", 0.1, 1), normal("initial.velocity.2", 0, 1), normal("initial.angular_velocity.0", 0, 3)),
        *(uniform("initial.quaternion.1", -1, 1), uniform("initial.position.0", 1, 2)),
    ),
    "moments": ensemble_of(MOMENTS, uniform("body.inertia.1", 2, 3), uniform("body.mass", 1, 2)),
    "moments of a brick": ensemble_of(BRICK, uniform("body.inertia", [1, 1.5, 2], [1.4, 1.9, 2.4])),
    "radius": ensemble_of(BALL, uniform("body.radius", 1, 2)),
    "cylinder": ensemble_of(ROD, uniform("body.half_length", 1, 2), uniform("body.radius", 0.1, 0.2)),
    "any quaternion": ensemble_of(BRICK, normal("initial.quaternion", 0, 1)),
    "Euler angles that stay": ensemble_of(
        BRICK.replace("[initial]", "[initial]\neuler_zxz = [0.1, 1.0, 0.3]"), uniform("body.semi_axes", 0.1, [0.2, 0.3, 0.4])
    ),
    "instead of Euler angles": ensemble_of(TURNED, attitude(), normal("initial.angular_velocity", 0, 3)),
}

ONE_BY_ONE = {
    "drag": (ensemble_of(DRAGGED, log_uniform("scene.drag.quadratic", 0.01, 1)), "drag"),
    "duration": (ensemble_of(BRICK, uniform("run.duration", 0.1, 0.2)), "duration"),
    "Euler angles": (ensemble_of(TURNED, uniform("initial.euler_zxz.1", 0.1, 3)), "euler_zxz"),
    "Euler rates": (ensemble_of(TURNED, normal("initial.euler_rates", 0, 3)), "euler_rates"),
    "rates follow the attitude": (ensemble_of(TURNED, attitude()), "quaternion"),
    "plane": (
        ensemble_of(CYLINDER_ON_PLANE, uniform("scene.plane.friction", 0.1, 1), uniform("initial.position.0", 0, 1)),
        "friction",
    ),
    "tensor": (ensemble_of(TENSOR, uniform("body.inertia.0.1", -0.2, 0.2)), "inertia"),
    "parts": (
        ensemble_of(PARTS, uniform("body.parts.1.semi_axes.0", 0.1, 0.4), normal("body.parts.0.position.2", 0, 1)),
        "parts",
    ),
    "particles": (ensemble_of(PARTICLES, uniform("body.particles.1.mass", 1, 2)), "particles"),
}


def source_of(text: str) -> tuple[Case, members.Source]:
    case = parse(text, "f")
    return case, members.drawn(case)


def exactly(value: Wide) -> Real:
    """A number of NumPy's widest type, which two doubles hold."""
    return real(float(value)) + real(float(value - Wide(float(value))))


@pytest.mark.parametrize("name", QUICK)
def test_members_as_arrays_are_those_of_their_files(name: str) -> None:
    case, source = source_of(QUICK[name])
    scenes = members.scenes(case, source.values(37, 20), 37)
    assert isinstance(scenes, Scenes)
    assert len(scenes) == 20
    for k in range(20):
        alone = parse(members.text(case, source, 37 + k), "f").scene
        # The scene of a file knows its definition besides the nearest doubles.
        assert scenes.scene(k) == replace(alone, definition=None)
        # The moments are exact in both ways: a double and its rest have 100 bits and more.
        exact = start(alone).moments
        for moment, one, rest in zip(exact, scenes.exact_moments.high[k], scenes.exact_moments.low[k], strict=True):
            assert abs(moment - exactly(one) - exactly(rest)) <= moment * 1e-30


@pytest.mark.parametrize("name", QUICK)
def test_the_motion_of_a_member_is_that_of_its_file(name: str) -> None:
    """Within the bounds of both."""
    case, source = source_of(QUICK[name])
    scenes = members.scenes(case, source.values(0, 5))
    assert isinstance(scenes, Scenes)
    many = flights(scenes, case.instants)
    for k in range(5):
        alone = flight(parse(members.text(case, source, k), "f").scene, case.instants)
        apart = geodesic_angle(many.trajectory.quaternion[k], alone.motion.quaternion)
        assert (apart <= many.bounds.error[k] + alone.bounds.error).all()
        apart = np.abs(many.trajectory.position[k] - alone.motion.position).max(axis=1)
        assert (apart <= many.bounds.position_error[k] + alone.bounds.position_error).all()


@pytest.mark.parametrize("name", ONE_BY_ONE)
def test_other_members_are_cases_of_their_own(name: str) -> None:
    text, differs = ONE_BY_ONE[name]
    case, source = source_of(text)
    made = members.scenes(case, source.values(5, 4), 5)
    assert isinstance(made, list)
    assert [one.name for one in made] == [f"{case.name}-{member}" for member in range(5, 9)]
    assert [one.text for one in made] == [members.text(case, source, member) for member in range(5, 9)]
    assert len({one.text.partition("title")[2].partition("\n")[2] for one in made}) == 4
    assert all(differs in one.text and parse(one.text, "f") == one for one in made)
    assert all(one.ensemble is None for one in made)


def test_a_text_has_the_very_numbers_that_are_drawn() -> None:
    case, source = source_of(QUICK["every key"])
    values, table = source.values(999, 1), tomllib.loads(members.text(case, source, 999))
    for key, array in values.items():
        room, name = key.split(".")
        assert table[room][name] == array[0].tolist(), key
    assert "ensemble" not in table
    assert table["name"] == "brick-999"
    assert table["title"] == "Member 999 of brick: A brick that tumbles"


def test_a_component_leaves_the_others_as_they_are() -> None:
    case, source = source_of(QUICK["components"])
    made = parse(members.text(case, source, 3), "f").scene
    assert made.initial.angular_velocity[1:] == case.scene.initial.angular_velocity[1:]
    assert made.initial.velocity[:2] == (0.0, 0.0)
    assert made.initial.position[1:] == (0.0, 0.0)
    assert made.body.shape is not None


def test_a_body_on_a_plane_lies_on_it_wherever_it_starts() -> None:
    text = ensemble_of(CYLINDER_ON_PLANE, uniform("initial.position.0", 1, 2), uniform("body.half_length", 0.5, 1))
    case, source = source_of(text)
    made = members.scenes(case, source.values(0, 5))
    assert isinstance(made, list)
    for k, one in enumerate(made):
        half = source.values(0, 5)["body.half_length"][k]
        assert one.scene.initial.position == (source.values(0, 5)["initial.position.0"][k], 0.0, half)


def test_a_product_of_inertia_counts_at_both_places() -> None:
    case, source = source_of(ONE_BY_ONE["tensor"][0])
    inertia = tomllib.loads(members.text(case, source, 2))["body"]["inertia"]
    assert inertia[0][1] == inertia[1][0] == source.values(2, 1)["body.inertia.0.1"][0]


def test_names_are_those_of_single_numbers() -> None:
    _, source = source_of(QUICK["components"].replace('"initial.position.0"', '"initial.position"'))
    assert source.names[-3:] == ("initial.position.0", "initial.position.1", "initial.position.2")
    assert tuple(columns_of(source.values(10, 3))) == source.names
    assert pickle.loads(pickle.dumps(source)) == source


def test_a_long_name_keeps_the_number_of_the_member() -> None:
    case, source = source_of(ensemble_of(a_case("x" * 100), attitude()))
    name = parse(members.text(case, source, 123), "f").name
    assert len(name) == 100
    assert name.endswith("x-123")


INVALID = {
    "mass": (ensemble_of(BRICK, normal("body.mass", 1, 1)), r"brick: member (\d+): body.mass: .*greater than 0"),
    "triangle": (
        ensemble_of(MOMENTS, uniform("body.inertia", 1, 4)),
        r"member (\d+): body.inertia: .*no body has these moments",
    ),
    "tensor": (ensemble_of(TENSOR, uniform("body.inertia.0.1", 0, 3)), r"member (\d+): body.inertia: .*must be positive"),
    "quaternion": (
        ensemble_of(BRICK, choice("initial.quaternion", [[1, 0, 0, 0], [0, 0, 0, 0]])),
        r"(\d+): initial.quaternion: .*its length is 0",
    ),
    "speed over a long time": (
        ensemble_of(BRICK.replace("duration = 0.5", "duration = 1e90"), uniform("scene.gravity", 1, 2)),
        r"member (\d+): run.duration: .*its distance from the origin",
    ),
    "speed": (ensemble_of(BRICK, log_uniform("initial.velocity", 1, 1e90)), r"member (\d+): initial: its kinetic energy"),
}


@pytest.mark.parametrize("name", INVALID)
def test_a_member_that_is_no_case_is_told_with_its_key(name: str) -> None:
    text, message = INVALID[name]
    case, source = source_of(text)
    with pytest.raises(BadInput, match=message) as told:
        members.check(case, source)
    for made in (lambda: members.scenes(case, source.values(0, 1000)),):
        with pytest.raises(BadInput, match=message) as again:
            made()
        assert str(again.value) == str(told.value)


def test_members_that_are_valid_pass_the_check() -> None:
    for text in (*QUICK.values(), *(text for text, _ in ONE_BY_ONE.values())):
        members.check(*source_of(text))


def test_the_check_looks_at_the_first_members_and_the_others_are_told_when_they_are_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    case, source = source_of(INVALID["tensor"][0])
    with pytest.raises(BadInput) as told:
        members.check(case, source)
    first = int(re.findall(r"member (\d+)", str(told.value))[0])
    monkeypatch.setattr(members, "CHECKED", first)
    members.check(case, source)
    with pytest.raises(BadInput, match=f"member {first}: body.inertia"):
        members.scenes(case, source.values(first, 1), first)


def test_columns_of_single_numbers_are_put_together() -> None:
    vary = (choice("initial.quaternion", [[1, 0, 0, 0], [0, 0, 0, 1]]), uniform("body.mass", 1, 2))
    case, source = source_of(ensemble_of(BRICK, *vary, uniform("initial.velocity.1", 1, 2), uniform("body.semi_axes", 1, 2)))
    values = source.values(0, 5)
    columns = {
        name: array if array.ndim == 1 else array[:, place]
        for key, array in values.items()
        for place, name in enumerate([key] if array.ndim == 1 else [f"{key}.{one}" for one in range(array.shape[1])])
    }
    found = members.of_columns(case, columns)
    assert found.keys() == values.keys()
    assert all(np.array_equal(found[key], values[key]) for key in values)


def test_the_shipped_ensemble_has_valid_members() -> None:
    """Its case itself is cheap to run: the table `[ensemble]` adds nothing to it."""
    case = load("ensemble-of-bricks")
    source = members.drawn(case)
    members.check(case, source)
    assert isinstance(members.scenes(case, source.values(0, source.size)), Scenes)
    assert case.duration * case.samples < load("free-brick").duration * load("free-brick").samples


def test_a_case_without_an_ensemble_has_no_members() -> None:
    with pytest.raises(BadInput, match=r"spin: has no table \[ensemble\]"):
        members.drawn(parse(a_case(), "f"))
    case, source = source_of(QUICK["radius"])
    assert members.drawn(case, 5).size == 5
    with pytest.raises(BadInput, match="read 0 members; allowed: 1 to 1,000,000,000"):
        members.drawn(case, 0)
    with pytest.raises(BadInput, match="read member 1000; allowed: 0 to 999"):
        members.text(case, source, 1000)


def limits_of(case: Case) -> set[tuple[str, str, Limit]]:
    """All limits of the expectations of a case, each with the engine and method that it is for."""
    expectations = case.expectations
    return {(expected.engine, str(expected.method), limit) for expected in expectations for limit in expected.limits}


@pytest.mark.parametrize("name", shipped())
def test_members_of_shipped_cases_are_cases(name: str) -> None:
    """With all else that is not about many members: longer ones have all limits, shorter ones those that can fail."""
    text = written({key: value for key, value in tomllib.loads(load(name).text).items() if key != "ensemble"})
    long = load(name).duration
    for low, high in ((long, 2 * long), (0.001 * long, 0.002 * long)):
        case = parse(ensemble_of(text, uniform("run.duration", low, high)), "f")
        made = parse(members.text(case, members.drawn(case), 7), "f")
        assert made.expectations == case.expectations or (low < long and limits_of(made) < limits_of(case))
        assert (made.samples, made.tags, made.source) == (case.samples, case.tags, case.source)
        assert made.scene == case.scene
        assert made.duration == members.drawn(case).values(7, 1)["run.duration"][0]


def test_limits_that_cannot_fail_in_a_shorter_member_are_left_out() -> None:
    limits = {"stop_time_error": {"at_least": 0.001, "at_most": 0.4}, "creep": 0.1}
    expected = [expecting("mujoco", "Euler", 0.002, **limits), expecting("mujoco", "RK4", 0.002, stop_time_error=0.4)]
    case = parse(ensemble_of(a_case(expect=expected), uniform("run.duration", 0.1, 0.2)), "f")
    (kept,) = parse(members.text(case, members.drawn(case), 0), "f").expectations
    assert kept.limits == (Limit("stop_time_error", 0.001, None), Limit("creep", None, 0.1))
