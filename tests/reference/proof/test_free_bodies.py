"""Enclosures of free bodies: they contain the motion of other code, no printed bound is below them, and faults are found."""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from bodycheck.casefile.case import load, parse
from bodycheck.reference import certificate
from bodycheck.reference.exact.start import defined_scene
from bodycheck.reference.proof.enclosure import QUANTITIES, Enclosure, NotEnclosed
from bodycheck.reference.scene import Definition, Push, Scene, Tensor
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from bodycheck.running import truths
from tests.support.bound_checks import figures
from tests.support.proved_scenes import TURNED, flight_with_drag
from tests.support.random_cases import REGIMES, drawn

pytest.importorskip("flint")

from bodycheck.reference.proof import bodies, free_body, proving
from bodycheck.reference.proof.balls import applied, precision

#: The shipped cases of one free body without drag.
FREE = (
    *("intermediate-axis-flip", "free-brick", "short-axis-spin", "dumbbell", "football-spiral"),
    *("football-wobble", "projectile", "gimbal-start", "extreme-spin", "mujoco-free-body"),
    *("nesc-tumbling-brick", "osrf-boxes-simple", "osrf-boxes-complex"),
)

#: The most that two enclosures of the same distance may be apart: both are printed in doubles, rounded outwards.
ROUNDED = 1e-14


def below(enclosure: Enclosure, found: Truth) -> list[str]:
    """The quantities in which a printed bound is smaller than the proved distance."""
    return [name for name in QUANTITIES if (enclosure.nearest[name] > getattr(found.bounds, name)).any()]


@pytest.mark.parametrize("name", FREE)
def test_every_shipped_free_body_is_enclosed(name: str) -> None:
    case = load(name)
    found = truth(case.scene, np.linspace(0, case.duration, 101))
    enclosure = proving.enclosed(case.scene, found.trajectory)
    assert enclosure.radius <= 2.0**-60
    assert below(enclosure, found) == []


@pytest.mark.parametrize("regime", REGIMES)
def test_an_enclosure_contains_what_other_code_computes_in_many_digits(regime: str) -> None:
    for seed in range(2):
        text, times = drawn(regime, seed)
        scene = parse(text, regime).scene
        found = truth(scene, np.array(times))
        enclosure = proving.enclosed(scene, found.trajectory)
        assert below(enclosure, found) == []
        for name, figure in figures(text, found).items():
            if name in QUANTITIES:
                low, high = enclosure.nearest[name], enclosure.farthest[name]
                assert (low * (1 - ROUNDED) - enclosure.radius <= figure.error).all(), (seed, name)
                assert (figure.error <= high * (1 + ROUNDED) + enclosure.radius).all(), (seed, name)


@pytest.mark.slow
@pytest.mark.parametrize("regime", REGIMES)
def test_no_printed_bound_is_below_its_proof(regime: str) -> None:
    for seed in range(100, 163):  # 1,000 cases with those of all regimes
        text, times = drawn(regime, seed)
        scene = parse(text, regime).scene
        found = truth(scene, np.array(times))
        assert below(proving.enclosed(scene, found.trajectory), found) == [], seed


def tensor_of(scene: Scene, change: Callable[[list[list[float]]], None]) -> Scene:
    """The same scene with a changed inertia tensor."""
    assert scene.definition is not None
    assert isinstance(scene.definition.inertia, Tensor)
    rows = [list(row) for row in scene.definition.inertia.rows]
    change(rows)
    (a, b, c), (d, e, f), (g, h, i) = rows
    inertia = replace(scene.definition.inertia, rows=((a, b, c), (d, e, f), (g, h, i)))
    return defined(scene, replace(scene.definition, inertia=inertia))


def defined(scene: Scene, definition: Definition) -> Scene:
    """The same scene with another definition of its body."""
    new = defined_scene(definition, None)
    initial = replace(scene.initial, quaternion=new.initial.quaternion, angular_velocity=new.initial.angular_velocity)
    return replace(scene, body=new.body, initial=initial, definition=new.definition)


def larger(rows: list[list[float]]) -> None:
    rows[1][1] *= 1 + 1e-9


def other_products(rows: list[list[float]]) -> None:
    rows[0][1], rows[1][0] = -rows[0][1], -rows[1][0]


def exchanged(rows: list[list[float]]) -> None:
    rows[0][0], rows[1][1] = rows[1][1], rows[0][0]


def gyroscopic(found: Truth) -> Truth:
    """The same motion with the angular velocity in the axes of a body that turns backwards."""
    return replace(found, trajectory=replace(found.trajectory, angular_velocity=-found.trajectory.angular_velocity))


@pytest.mark.parametrize(
    ("fault", "quantity"),
    [
        (lambda scene: tensor_of(scene, larger), "error"),
        (lambda scene: tensor_of(scene, other_products), "error"),
        (lambda scene: tensor_of(scene, exchanged), "error"),
        (lambda scene: replace(scene, gravity=-scene.gravity), "position_error"),
        (lambda scene: replace(scene, gravity=scene.gravity * (1 + 1e-12)), "velocity_error"),
    ],
    ids=["a moment times 1 + 1e-9", "products of inertia", "axes exchanged", "gravity upwards", "gravity times 1 + 1e-12"],
)
def test_a_truth_of_another_motion_is_contradicted(fault: Callable[[Scene], Scene], quantity: str) -> None:
    case = parse(TURNED, "turned")
    found = truth(fault(case.scene), case.instants)
    assert quantity in below(proving.enclosed(case.scene, found.trajectory), found)


def test_a_contradiction_is_told_with_its_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    case = parse(TURNED, "turned")
    checked = truths.certify(case)
    assert (checked.word, checked.certified) == ("enclosed", True)
    right = certificate.certify
    monkeypatch.setattr(certificate, "certify", lambda *given: replace(right(*given), truth=gyroscopic(right(*given).truth)))
    wrong = truths.certify(case)
    assert not wrong.certified
    assert any("the printed bound of the error in angular velocity" in fault for fault in wrong.faults)


@pytest.mark.parametrize("signs", [(1, 1, 1), (1, -1, 1), (-1, 1, 1), (1, 1, -1), (-1, -1, -1)])
def test_exactly_on_the_separatrix(signs: tuple[int, int, int]) -> None:
    """With moments 2, 5 and 6 and rates p = r, twice the energy times the middle moment is the square of the momentum."""
    rates = (float(signs[0]), 0.5 * signs[1], float(signs[2]))
    definition = Definition(Tensor(1.0, ((2.0, 0.0, 0.0), (0.0, 5.0, 0.0), (0.0, 0.0, 6.0))), rotation=rates)
    scene = defined(parse(TURNED, "turned").scene, definition)
    found = truth(scene, np.linspace(0, 10, 41))
    enclosure = proving.enclosed(scene, found.trajectory)
    assert below(enclosure, found) == []
    assert enclosure.bits == 96  # decided by rational numbers, not by more and more digits


@pytest.mark.parametrize("seed", range(7))
def test_no_printed_bound_with_drag_is_below_its_proof(seed: int) -> None:
    scene = flight_with_drag(seed)
    found = truth(scene, np.linspace(0, 2, 5))
    enclosure = proving.enclosed(scene, found.trajectory)
    assert enclosure.radius <= 2.0**-60
    assert below(enclosure, found) == []
    assert enclosure.farthest["position_error"].max() < 1e-12
    wrong = truth(replace(scene, drag=scene.drag * (1 + 1e-9)), np.linspace(0, 2, 5))
    moves = any(scene.initial.velocity) or bool(scene.gravity)
    assert ("velocity_error" in below(proving.enclosed(scene, wrong.trajectory), wrong)) == moves


def test_reasons_why_there_is_no_proof() -> None:
    scene = load("free-brick").scene
    found = truth(scene, np.zeros(1)).trajectory
    with pytest.raises(NotEnclosed, match="pushes"):
        proving.enclosed(replace(scene, pushes=(Push((1.0, 0.0, 0.0)),)), found)


def test_energy_and_momentum_are_kept_in_balls() -> None:
    """A property of the motion that the closed form does not use as such: the balls of the momentum in the world overlap."""
    scene = parse(TURNED, "turned").scene
    with precision(128):
        body = bodies.rotor(scene)
        rotation = free_body.rotation(body)
        first, later = (
            applied(attitude, applied(body.tensor, rates)) for attitude, rates in (rotation(Fraction(0)), rotation(Fraction(7)))
        )
        assert all(a.overlaps(b) and float((a - b).rad()) < 1e-25 for a, b in zip(first, later, strict=True))


def test_a_proof_imports_no_way_to_a_truth() -> None:
    code = "import sys, bodycheck.reference.proof.proving; print(*[name for name in sys.modules if 'bodycheck' in name])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    ways = ("exact", "flight", "independent", "integration", "sliding", "contact", "witness", "truth", "followed", "lagrangian")
    below = (name.removeprefix("bodycheck.reference.proof.") for name in done.stdout.split())
    assert [name for name in below if name.startswith("bodycheck.") and any(way in name.split(".") for way in ways)] == []
