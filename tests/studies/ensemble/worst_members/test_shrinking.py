import tomllib
from collections.abc import Callable, Sequence
from hashlib import sha256
from typing import Any

import pytest

from bodycheck.casefile.case import parse
from bodycheck.casefile.toml_text import short
from bodycheck.studies.ensemble.worst_members.shrinking import Document, shrink
from bodycheck.studies.ensemble.worst_members.worst import MOST_LINES

DRAWN = """
format = 1
name = "drawn"
title = "A member as it was drawn"
[body]
shape = "brick"
semi_axes = [0.10372, 0.30118, 0.19977]
mass = 1.0731
[initial]
position = [0.1123, -0.7734, 0.4412]
velocity = [1.0317, -0.2211, 2.0171]
quaternion = [0.5046, 0.4955, 0.4991, 0.5007]
angular_velocity = [-0.01733, 2.32718, 7.10331]
[scene]
gravity = 9.81
drag = {quadratic = 0.0113}
[run]
duration = 2.0
samples = 101
"""

PARTICLES = """
format = 1
name = "drawn"
title = "Six point masses"
[body]
particles = [
    {mass = 1.0, position = [1.0, 0.0, 0.0]}, {mass = 1.0, position = [-1.0, 0.0, 0.0]},
    {mass = 1.0, position = [0.0, 2.0, 0.0]}, {mass = 1.0, position = [0.0, -2.0, 0.0]},
    {mass = 1.0, position = [0.0, 0.0, 3.0]}, {mass = 1.0, position = [0.0, 0.0, -3.0]},
]
[run]
duration = 2.0
samples = 101
"""


def shrunk(drawn: str, fails: Callable[[Document], bool], most: int = 300) -> tuple[Document, int]:
    """What a document is made to, and after how many trials."""
    trials: list[Document] = []

    def each(documents: Sequence[Document]) -> list[bool]:
        trials.extend(documents)
        return [fails(one) for one in documents]

    return shrink(tomllib.loads(drawn), each, shortest=0.002, most=most), len(trials)


def spin(document: Document) -> list[float]:
    found: list[float] = document.get("initial", {}).get("angular_velocity", [0.0, 0.0, 0.0])
    return found


def test_only_what_the_failure_needs_is_left() -> None:
    found, trials = shrunk(DRAWN, lambda one: 2.31 < spin(one)[1] < 2.34 and one["run"]["duration"] > 0.3)
    assert found == {
        "format": 1,
        "name": "drawn",
        "title": "A member as it was drawn",
        "body": {"shape": "brick", "semi_axes": [0.1, 0.3, 0.2], "mass": 1.0},
        "initial": {"angular_velocity": [0.0, 2.33, 0.0]},
        "run": {"duration": 0.5, "samples": 2},
    }
    assert trials < 100


def test_an_attitude_becomes_round_angles() -> None:
    def needs_an_attitude(one: Document) -> bool:
        initial = one.get("initial", {})
        return "quaternion" in initial or "euler_zxz" in initial

    found, _ = shrunk(DRAWN, needs_an_attitude)
    assert list(found["initial"]) == ["euler_zxz"]
    assert set(found["initial"]["euler_zxz"]) <= {0.0, 2.0}  # the angles are near 0 and 1.57, with one digit
    parse(short(found), "it")  # and it is a valid case


def test_parts_of_a_body_are_left_out() -> None:
    def needs_two(one: Document) -> bool:
        heights = [part["position"][2] for part in one["body"]["particles"]]
        return 3.0 in heights and len(heights) > 1

    found, _ = shrunk(PARTICLES, needs_two)
    assert len(found["body"]["particles"]) == 2
    assert [0.0, 0.0, 3.0] in [part["position"] for part in found["body"]["particles"]]


@pytest.mark.parametrize("seed", range(20))
def test_what_is_found_fails_and_trials_are_bounded(seed: int) -> None:
    """Whatever fails: here what a checksum says, as an engine might whose failures follow no rule."""

    def fails(one: Document) -> bool:
        return one == tomllib.loads(DRAWN) or sha256(f"{seed} {one!r}".encode()).digest()[0] < 100

    found, trials = shrunk(DRAWN, fails, most=40)
    assert fails(found)
    assert trials <= 40
    assert shrunk(DRAWN, fails, most=40) == (found, trials)


def test_a_case_that_needs_everything_stays_as_it_is() -> None:
    drawn = tomllib.loads(DRAWN)
    found, _ = shrunk(DRAWN, lambda one: one == drawn)
    assert found == drawn


@pytest.mark.parametrize("drawn", [DRAWN, PARTICLES])
def test_the_text_of_a_case_is_what_it_was_made_of(drawn: str) -> None:
    document: dict[str, Any] = tomllib.loads(drawn)
    expect = {"engine": "mujoco", "integrator": 'Euler:a="b"', "timestep": 1e-05, "energy_drift": {"at_least": 1e-300}}
    document["expect"] = [expect]
    text = short(document, ["One.", "Two."], MOST_LINES)
    assert tomllib.loads(text) == document
    assert text.startswith("# One.\n# Two.\nformat = 1\n")
    assert len(text.splitlines()) <= MOST_LINES
