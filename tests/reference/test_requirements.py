"""What a scene requires is derived from it; what an engine lacks is named by it."""

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from bodycheck import load, simulate
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.commands.command_line import app
from bodycheck.reference.requirements import Requirements, missing, requirements, symmetry
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State

BODY = Body(1.0, (0.1, 0.2, 0.25), Brick((0.1, 0.2, 0.05)))
FLYING = Scene(BODY, State(velocity=(1.0, 0.0, 0.0), angular_velocity=(0.0, 0.0, 1.0)), gravity=9.81)
LYING = Scene(BODY, State((0.0, 0.0, 0.05), velocity=(1.0, 0.0, 0.0)), 9.81, Plane(0.5))


@pytest.mark.parametrize(
    ("case", "names", "rotation", "freedom"),
    [
        ("projectile", {"gravity", "translation"}, "none", 3),
        ("free-brick", {"gravity", "translation", "rotation"}, "asymmetric", 6),
        ("osrf-boxes-simple", {"translation", "rotation"}, "asymmetric", 6),
        ("mujoco-free-body", {"rotation"}, "asymmetric", 3),
        ("football-drag", {"gravity", "translation", "rotation", "drag"}, "symmetric", 6),
        ("sliding-brick", {"gravity", "translation", "rotation", "contact", "friction"}, "planar", 3),
        ("curling-disk", {"gravity", "translation", "rotation", "contact", "friction"}, "planar", 3),
    ],
)
def test_shipped_scenes_require_what_they_must(case: str, names: set[str], rotation: str, freedom: int) -> None:
    needs = requirements(load(case).scene)
    assert set(needs.names()) == names
    assert (needs.rotation, needs.degrees_of_freedom) == (rotation, freedom)


def test_what_is_there_but_not_needed_is_not_required() -> None:
    at_rest = replace(FLYING, initial=State(), gravity=0.0, drag=0.1)
    assert requirements(at_rest) == Requirements(False, False, "none", False, False, False, 0)
    spinning = replace(at_rest, initial=State(angular_velocity=(0.0, 0.0, 1.0)))
    assert requirements(spinning).names() == ("rotation",)  # drag acts on what moves
    assert requirements(replace(FLYING, initial=State())).rotation == "none"
    for plane, gravity in ((Plane(0.0), 9.81), (Plane(0.5), 0.0)):
        assert not requirements(replace(LYING, plane=plane, gravity=gravity)).friction


def test_three_coordinates_are_enough_only_for_what_lies_flat() -> None:
    assert requirements(LYING).degrees_of_freedom == 3
    lean = State((0.0, 0.0, 0.05), (math.cos(0.1), math.sin(0.1), 0.0, 0.0))
    leaning = requirements(replace(LYING, initial=lean))
    assert (leaning.rotation, leaning.degrees_of_freedom) == ("asymmetric", 6)


def test_nearly_symmetric_is_asymmetric() -> None:
    assert symmetry((1.0, 1.0, 1.0)) == "sphere"
    assert symmetry((1.0, 1.7, 1.0)) == "symmetric"
    assert symmetry((1.0, 1.7, math.nextafter(1.0, 2.0))) == "asymmetric"
    assert symmetry((1.0, 1.0, math.nextafter(1.0, 2.0))) == "symmetric"


def test_what_is_missing_is_named() -> None:
    assert missing(LYING, {"gravity", "translation", "rotation"}) == "contact, friction"
    assert missing(FLYING, {"translation", "rotation", "drag"}) == "gravity"
    assert missing(FLYING, {"gravity", "translation", "rotation"}) is None


def test_an_engine_that_lacks_something_is_unsupported_by_its_name(miniatures: Path) -> None:
    run = simulate(load("sliding-brick"), "exact", "closed-form", 0.01)
    assert (run.outcome.status, run.outcome.reason) == ("unsupported", "exact 1.0 does not model contact, friction")


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
def test_engines_name_what_they_cannot_model(engine: str) -> None:
    adapter = registry.load(engine)
    method = Method.parse({"mujoco": "Euler", "pinocchio": "law-force"}[engine], 1e-3)
    with pytest.raises(SceneUnsupported, match="does not model drag together with contact"):
        offers.prepare(adapter, [replace(LYING, drag=0.1)], method)
    offers.prepare(adapter, [LYING], method)
    assert offers.not_modelled(adapter.engine, FLYING, method) is offers.not_modelled(adapter.engine, LYING, method) is None


def test_the_command_shows_them(capsys: pytest.CaptureFixture[str]) -> None:
    assert app(["cases", "--requires"], result_action="return_value") == 0
    lines = {line.split()[0]: line.split()[1:] for line in capsys.readouterr().out.splitlines()}
    assert lines["projectile"] == [
        "yes",
        "yes",
        "none",
        "-",
        "-",
        "-",
        "3",
        "-",
        "-",
        "-",
        "-",
        "-",
        "-",
        "-",
    ]  # the last column is that of mechanisms
    assert app(["cases", "--requires", "--json"], result_action="return_value") == 0
    told = {case.pop("name"): case for case in json.loads(capsys.readouterr().out)}
    assert Requirements(**told["sliding-brick"]) == requirements(load("sliding-brick").scene)
