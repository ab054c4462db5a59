"""The table `[ensemble]` of case files: its keys, its key paths, and that every fault is told where it stands."""

import json
import re
import tomllib
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from bodycheck import Case, CaseFaults, load
from bodycheck.casefile.authoring import schema
from bodycheck.casefile.case import parse
from bodycheck.casefile.distributions import AnyAttitude, Choice, Distribution, Ensemble, LogUniform, Normal, OnSphere, Uniform
from bodycheck.casefile.identity import identity
from bodycheck.casefile.toml_text import written
from bodycheck.casefile.values import MAX_CHOICES, MAX_MEMBERS, MAX_VARIATIONS
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
    ensemble_of,
    log_uniform,
    normal,
    sphere,
    uniform,
)


def vary(*tables: str, text: str = BRICK) -> Ensemble:
    """The ensemble of a case with these variations."""
    case = parse(ensemble_of(text, *tables), "f")
    assert case.ensemble is not None
    return case.ensemble


def faults(text: str) -> dict[str, str]:
    with pytest.raises(CaseFaults) as caught:
        parse(text, "f")
    return {fault.key: fault.message for fault in caught.value.faults}


def fault(*tables: str, text: str = BRICK) -> tuple[str, str]:
    """The only fault of a case with these variations: its key and its message."""
    (found,) = faults(ensemble_of(text, *tables)).items()
    return found


@pytest.mark.parametrize(
    ("table", "distribution"),
    [
        (uniform("body.mass", 1, 2.0), Uniform((1.0,), (2.0,))),
        (uniform("initial.velocity", [0, 1, 2], [1, 2, 3]), Uniform((0.0, 1.0, 2.0), (1.0, 2.0, 3.0))),
        (uniform("initial.velocity", -1, [1, 2, 3]), Uniform((-1.0, -1.0, -1.0), (1.0, 2.0, 3.0))),
        (log_uniform("body.semi_axes", 0.1, 1), LogUniform((0.1, 0.1, 0.1), (1.0, 1.0, 1.0))),
        (log_uniform("body.semi_axes.2", 0.1, 1), LogUniform((0.1,), (1.0,))),
        (normal("initial.position.1", -3, 0), Normal((-3.0,), (0.0,))),
        (normal("initial.quaternion", [1, 0, 0, 0], 0.1), Normal((1.0, 0.0, 0.0, 0.0), (0.1, 0.1, 0.1, 0.1))),
        (sphere("initial.angular_velocity", 3), OnSphere(3.0)),
        (attitude(), AnyAttitude()),
        (choice("scene.gravity", [0, 1.62, 9.81]), Choice(((0.0,), (1.62,), (9.81,)))),
        (choice("initial.velocity", [[1, 2, 3], [4, 5, 6]]), Choice(((1.0, 2.0, 3.0), (4.0, 5.0, 6.0)))),
    ],
)
def test_every_distribution_with_numbers_and_vectors(table: str, distribution: Distribution) -> None:
    """A single parameter counts for each component of a vector."""
    (variation,) = vary(table).vary
    assert variation.distribution == distribution


def test_an_ensemble_has_members_and_a_seed() -> None:
    assert (vary(attitude()).members, vary(attitude()).seed) == (1000, 1)
    most = ensemble_of(BRICK, attitude()).replace("members = 1000\nseed = 1", f"members = {MAX_MEMBERS}")
    ensemble = parse(most, "f").ensemble
    assert ensemble is not None
    assert (ensemble.members, ensemble.seed) == (MAX_MEMBERS, 0)
    assert parse(BRICK, "f").ensemble is None


EXISTING = {
    BRICK: [
        *(
            "body.mass",
            "body.semi_axes",
            "body.semi_axes.0",
            "body.semi_axes.2",
            "body.inertia",
            "scene.gravity",
            "run.duration",
        ),
        *("initial.position", "initial.position.0", "initial.velocity", "initial.velocity.2", "initial.angular_velocity"),
        *(
            "initial.angular_velocity.1",
            "initial.quaternion",
            "initial.quaternion.3",
            "initial.euler_zxz",
            "initial.euler_zxz.1",
        ),
        "initial.euler_rates",
    ],
    CYLINDER_ON_PLANE: [
        *("body.radius", "body.half_length", "scene.plane.friction", "initial.position.0", "initial.euler_zxz.2"),
        *("initial.euler_rates.2", "initial.quaternion", "initial.angular_velocity"),
    ],
    DRAGGED: ["scene.drag.quadratic", "body.radius", "initial.quaternion.1", "initial.angular_velocity.2"],
    MOMENTS: ["body.mass", "body.inertia", "body.inertia.1"],
    TENSOR: ["body.inertia.0.0", "body.inertia.0.1", "body.inertia.2.2"],
    PARTS: [
        "body.parts.0.radius",
        "body.parts.0.position.2",
        "body.parts.1.semi_axes.0",
        "body.parts.1.position",
        "body.parts.1.mass",
    ],
    PARTICLES: ["body.particles.2.mass", "body.particles.0.position", "body.particles.0.position.1"],
}


@pytest.mark.parametrize(("text", "key"), [(text, key) for text, known in EXISTING.items() for key in known])
def test_every_number_and_vector_has_a_path(text: str, key: str) -> None:
    """Also where the file leaves it to its default, and where a whole vector replaces another key of the same quantity."""
    (variation,) = vary(uniform(key, 0.5, 1.5), text=text).vary
    assert variation.key.text == key
    assert variation.key.names == (
        (key,) if variation.key.components is None else tuple(f"{key}.{k}" for k in range(variation.key.components))
    )


@pytest.mark.parametrize(
    ("text", "key", "message"),
    [
        (BRICK, "body.mas", "there is no number or vector of this path; allowed: body.mass, .*; did you mean 'body.mass'?"),
        (BRICK, "body.radius", "there is no number or vector of this path"),
        (BRICK, "mass", "there is no number"),
        (BRICK, "body", "there is no number"),
        (BRICK, "body.shape", "there is no number"),
        (BRICK, "run.samples", "there is no number"),
        (BRICK, "expect.0.timestep", "there is no number"),
        (BRICK, "joints.pin.damping", "there is no number"),
        (BRICK, "initial.velocity.x", "there is no number"),
        (BRICK, "initial.velocity.-1", "there is no number"),
        (BRICK, "initial.velocity.00", "there is no number"),
        (BRICK, "initial.velocity.3", "there is no such component; allowed: initial.velocity.0 to initial.velocity.2"),
        (BRICK, "initial.velocity.0.0", "there is no such component|there is no number"),
        (BRICK, "body.inertia.1", "the file gives no body.inertia; give it, or draw the whole vector"),
        (BRICK, "scene.plane.friction", r"the file has no table \[scene.plane\]"),
        (BRICK, "scene.drag.quadratic", r"the file has no table \[scene.drag\]"),
        (BRICK, "initial.euler_rates.0", "the file gives initial.angular_velocity instead"),
        (
            CYLINDER_ON_PLANE,
            "initial.quaternion.0",
            "the file gives initial.euler_zxz instead; .* or the whole vector initial.quaternion",
        ),
        (TENSOR, "body.inertia", "is a tensor, which is drawn by its components, such as body.inertia.0.0"),
        (TENSOR, "body.inertia.1.0", "below the diagonal of a symmetric tensor; allowed: body.inertia.0.1, which means both"),
        (TENSOR, "body.inertia.0", "there is no such component; allowed: body.inertia.0.0 to body.inertia.2.2"),
        (PARTS, "body.mass", "there is no number"),
        (PARTS, "body.parts.2.mass", "there is no number"),
        (PARTS, "body.parts.0.half_length", "there is no number"),
    ],
)
def test_a_path_that_leads_nowhere_is_a_fault(text: str, key: str, message: str) -> None:
    where, told = fault(uniform(key, 0.5, 1.5), text=text)
    assert where == "ensemble.vary[1].key"
    assert re.search(message, told), told


BAD = {
    "low above high": (uniform("body.mass", 2, 1), "high", "must be above low, 2"),
    "low equal to high": (uniform("body.mass", 2, 2), "high", "must be above low"),
    "one component": (uniform("initial.velocity", [0, 0, 0], [1, 1, 0]), "high", "must be above low.* in every component"),
    "log of nothing": (log_uniform("body.mass", 0, 1), "low", "greater than 0"),
    "log of less": (log_uniform("initial.velocity", [1, -1, 1], 2), "low[2]", "greater than 0"),
    "log downwards": (log_uniform("body.mass", 3, 1), "high", "must be above low"),
    "negative deviation": (normal("body.mass", 1, -1), "standard_deviation", "greater than or equal to 0"),
    "negative in a vector": (normal("initial.velocity", 0, [1, 1, -1]), "standard_deviation[3]", "greater than or equal to 0"),
    "short": (normal("initial.velocity", [0, 0], 1), "mean", "a vector of 3 components; allowed: a number, or 3 numbers"),
    "long": (uniform("initial.velocity", 0, [1, 1, 1, 1]), "high", "a vector of 3 components"),
    "vector for a number": (normal("body.mass", [1], 1), "mean", "body.mass is a number; allowed: a number"),
    "nothing": (normal("initial.velocity", [], 1), "mean", "has 0 items"),
    "text": (normal("body.mass", "1", 1), "mean", "valid number"),
    "infinite": ('key = "body.mass"\ndistribution = "uniform"\nlow = 1\nhigh = inf', "high", "finite|less than"),
    "negative masses": (uniform("body.mass", -1, 1), "low", "draws negative numbers; body.mass is positive"),
    "negative mean": (normal("body.semi_axes", [1, -1, 1], 1), "mean", "draws negative numbers"),
    "negative friction": (normal("scene.gravity", 0, 1), "mean", "draws negative numbers; scene.gravity is not negative"),
    "sphere of a number": (sphere("body.mass", 1), "", "vectors of three components, and body.mass is a number"),
    "sphere of a quaternion": (sphere("initial.quaternion", 1), "", "vectors of three components"),
    "sphere of lengths": (sphere("body.semi_axes", 1), "", "draws negative numbers"),
    "sphere without size": (sphere("initial.velocity", 0), "radius", "greater than 0"),
    "no choice": (choice("body.mass", []), "values", "has 0 items; allowed: at least 1"),
    "too much choice": (choice("body.mass", [1] * (MAX_CHOICES + 1)), "values", "allowed: at most 1000"),
    "choice of a number for a vector": (choice("initial.velocity", [1]), "values[1]", "allowed: 3 numbers"),
    "choice of a vector for a number": (choice("body.mass", [1, [1]]), "values[2]", "allowed: a number"),
    "choice of a wrong length": (choice("initial.velocity", [[1, 2, 3], [1, 2]]), "values[2]", "allowed: 3 numbers"),
    "choice of no mass": (choice("body.mass", [1, 0]), "values[2]", "body.mass is positive"),
    "unknown distribution": (
        'key = "body.mass"\ndistribution = "gaussian"',
        "distribution",
        "allowed: uniform, log-uniform, normal",
    ),
    "misspelled distribution": ('key = "body.mass"\ndistribution = "norml"', "distribution", "did you mean 'normal'?"),
    "no distribution": ('key = "body.mass"', "distribution", "is missing; allowed: uniform"),
    "parameter of another": (normal("body.mass", 1, 1) + "\nlow = 1", "low", "unknown key; allowed: key, distribution, mean"),
    "parameter missing": ('key = "body.mass"\ndistribution = "normal"\nmean = 1', "standard_deviation", "is missing"),
    "no key": ('distribution = "uniform"\nlow = 0\nhigh = 1', "key", "is missing"),
    "attitude with a key": (attitude() + '\nkey = "initial.quaternion"', "key", "unknown key; allowed: distribution"),
}


@pytest.mark.parametrize("name", BAD)
def test_parameters_that_do_not_fit_are_faults(name: str) -> None:
    table, key, message = BAD[name]
    where, told = fault(table)
    assert where == f"ensemble.vary[1]{'.' if key else ''}{key}"
    assert re.search(message, told), told


@pytest.mark.parametrize(
    "tables",
    [
        (uniform("body.mass", 1, 2), normal("body.mass", 1, 0.1)),
        (uniform("initial.velocity", 1, 2), normal("initial.velocity.1", 1, 0.1)),
        (uniform("initial.velocity.0", 1, 2), sphere("initial.velocity", 1)),
        (attitude(), attitude()),
        (attitude(), uniform("initial.euler_zxz", 1, 2)),
        (uniform("initial.euler_zxz.1", 1, 2), attitude()),
        (attitude(), normal("initial.quaternion", 1, 2)),
        (uniform("initial.euler_zxz", 1, 2), normal("initial.quaternion", 1, 2)),
        (uniform("initial.euler_rates", 1, 2), normal("initial.angular_velocity", 1, 2)),
    ],
)
def test_two_variations_of_one_quantity_are_a_fault(tables: tuple[str, ...]) -> None:
    where, told = fault(*tables)
    assert where.startswith("ensemble.vary[2]")
    assert "is drawn twice" in told
    assert vary(uniform("initial.velocity.0", 0, 1), uniform("initial.velocity.1", 0, 1)), "others are allowed"


@pytest.mark.parametrize(
    ("line", "key", "message"),
    [
        ("members = 0", "ensemble.members", "greater than or equal to 1"),
        ("members = -5", "ensemble.members", "greater than or equal to 1"),
        (f"members = {MAX_MEMBERS + 1}", "ensemble.members", "less than or equal to 1000000000"),
        ("members = 10.0", "ensemble.members", "valid integer"),
        ("members = true", "ensemble.members", "valid integer"),
        ("", "ensemble.members", "is missing"),
        ("members = 10\nseed = -1", "ensemble.seed", "greater than or equal to 0"),
        ("members = 10\nseed = 0.5", "ensemble.seed", "valid integer"),
        (f"members = 10\nseed = {2**63}", "ensemble.seed", "less than or equal to 9223372036854775807"),
        ("members = 10\nsize = 3", "ensemble.size", "unknown key; allowed: members, seed, vary"),
    ],
)
def test_members_and_seed_are_whole_numbers_with_bounds(line: str, key: str, message: str) -> None:
    ((where, told),) = faults(ensemble_of(BRICK, attitude()).replace("members = 1000\nseed = 1", line)).items()
    assert where == key
    assert message in told


def test_something_must_vary() -> None:
    assert faults(BRICK + "[ensemble]\nmembers = 10\n") == {"ensemble.vary": "is missing"}
    assert faults(BRICK + "[ensemble]\nmembers = 10\nvary = []\n") == {
        "ensemble.vary": "read []; has 0 items; allowed: at least 1"
    }
    many = [uniform(f"body.particles.{k % 3}.mass", 1, 2) for k in range(MAX_VARIATIONS + 1)]
    assert "at most 50" in faults(ensemble_of(PARTICLES, *many))["ensemble.vary"]


def test_all_faults_at_once_each_with_its_line() -> None:
    text = ensemble_of(BRICK, uniform("body.mas", 1, 2), normal("initial.velocity", [1, 2], -1), attitude(), attitude())
    with pytest.raises(CaseFaults) as caught:
        parse(text.replace("members = 1000", "members = 0").replace("mass = 1.0", "mass = 0"), "f")
    lines = text.splitlines()
    told = [(fault.key, lines[fault.position.line - 1]) for fault in caught.value.faults if fault.position]
    assert told == [
        ("body.mass", "mass = 1.0"),
        ("ensemble.members", "members = 1000"),
        ("ensemble.vary[1].key", 'key = "body.mas"'),
        ("ensemble.vary[2].mean", "mean = [1, 2]"),
        ("ensemble.vary[2].standard_deviation", "standard_deviation = -1"),
        ("ensemble.vary[4]", "[[ensemble.vary]]"),
    ]


@pytest.mark.parametrize(
    "content", ["3", "[]", '"x"', "{}", "{vary = 3}", "{vary = [3]}", "{vary = [{key = 3}]}", "{vary = {}}"]
)
def test_what_is_no_table_is_a_fault(content: str) -> None:
    assert all(key.startswith("ensemble") for key in faults(f"ensemble = {content}\n{BRICK}"))


def test_a_body_with_faults_hides_no_fault_of_the_ensemble() -> None:
    text = ensemble_of(BRICK.replace('"brick"', '"brik"'), uniform("body.mass", 1, 2), uniform("initial.x", 1, 2))
    assert set(faults(text)) == {"body.shape", "ensemble.vary[2].key"}


def test_the_schema_knows_ensembles() -> None:
    validator = Draft202012Validator(json.loads(schema()))

    def valid(*vary: dict[str, Any], **more: Any) -> bool:
        run = {"duration": 1.0, "samples": 11}
        body = {"shape": "sphere", "radius": 1.0, "mass": 1.0}
        document = {"format": 1, "name": "x", "title": "x", "body": body, "run": run}
        return bool(validator.is_valid(document | {"ensemble": {"members": 10, "vary": list(vary)} | more}))

    scalar = {"key": "body.mass", "distribution": "uniform", "low": 1, "high": 2}
    assert valid(scalar, {"distribution": "attitude"}, seed=3)
    assert valid({"key": "initial.velocity", "distribution": "normal", "mean": [0, 0, 0], "standard_deviation": 1})
    assert valid({"key": "initial.velocity", "distribution": "choice", "values": [[0, 0, 0], [1, 1, 1]]})
    assert not valid()
    assert not valid(scalar, members=0)
    assert not valid(scalar, seed=-1)
    assert not valid(scalar | {"distribution": "gaussian"})
    assert not valid(scalar | {"mean": 1})
    assert not valid({"distribution": "attitude", "key": "initial.quaternion"})
    assert not valid(scalar | {"distribution": "log-uniform", "low": 0})


def test_an_ensemble_is_not_part_of_the_physics() -> None:
    """A baseline of the case stays that of the case."""
    assert identity(parse(ensemble_of(BRICK, attitude()), "f")) == identity(parse(BRICK, "f"))


def test_shipped_cases_of_one_body_can_have_one(case_of_one_body: Case) -> None:
    alone = {key: value for key, value in tomllib.loads(load(case_of_one_body.name).text).items() if key != "ensemble"}
    text = ensemble_of(written(alone), normal("initial.angular_velocity", 0, 1), uniform("run.duration", 1, 2))
    ensemble = parse(text, "f").ensemble
    assert ensemble is not None
    assert len(ensemble.vary) == 2
