"""What a slide costs is known before it is spent: the estimates agree with the steps that slides take."""

from collections.abc import Callable

import numpy as np
import pytest

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.sliding import budget, stepping
from bodycheck.reference.sliding.motion import slide
from bodycheck.reference.trajectory import Array

#: Half-lengths (m) and moments (kg m^2) of a brick of 1 kg.
BRICK, MOMENTS = Brick((0.1, 0.2, 0.05)), (0.0425 / 3, 0.0125 / 3, 0.05 / 3)


def sliding(friction: float, speed: float, spin: float, inertia: float = 1.0) -> Scene:
    """The brick with this coefficient of friction, speed (m/s) and spin (rad/s), and this share of its moments of inertia."""
    moments = tuple(moment * inertia for moment in MOMENTS)
    state = State((0.0, 0.0, 0.05), (1.0, 0.0, 0.0, 0.0), (speed, 0.0, 0.0), (0.0, 0.0, spin))
    return Scene(Body(1.0, moments, BRICK), state, 9.81, Plane(friction))


@pytest.fixture
def steps(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """One entry for each step of integration from now on: its number."""
    counts: list[int] = []
    advance: Callable[..., int] = stepping.advance

    def counted(*arguments: object) -> int:
        counts.append(advance(*arguments))
        return counts[-1]

    monkeypatch.setattr(stepping, "advance", counted)
    return counts


def until(time: float) -> Array:
    return np.linspace(0.0, time, 11)


def test_a_slide_that_would_turn_too_often_is_refused_after_a_few_steps(steps: list[int]) -> None:
    """Its centre of rotation crosses the edges at each turn, which takes 37 steps a radian of some 1200 rad."""
    with pytest.raises(
        OutOfReach, match=r"would take some [34]e\+04 integration steps, since the body turns through some 1\.2e\+03 rad"
    ):
        slide(sliding(0.02, 6.0, 50.0), until(500.0))
    assert len(steps) == budget.PROBED_STEPS


def test_a_stiff_slide_is_refused_before_any_step(steps: list[int]) -> None:
    """The moment of inertia of the brick is 1e-4 of what it should be, so that its spin is gone in 1e-3 of the slide."""
    with pytest.raises(
        OutOfReach, match=r"would take some 4\.4e\+04 integration steps, since friction brakes the spin 8e\+03 times"
    ):
        slide(sliding(0.3, 1.0, 5.0, inertia=2.5e-5), until(5.0))
    assert not steps


@pytest.mark.parametrize(("speed", "time"), [(0.5, 6.0), (10.0, 1.0)], ids=["within the edges", "across the edges"])
def test_turning_costs_what_is_expected(speed: float, time: float, steps: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    """A probe is as good as the pace is even: within a factor of two, which is enough to tell seconds from minutes."""
    expected: list[float] = []
    monkeypatch.setattr(budget, "refuse_long", lambda taken, turned, left: expected.append(taken * (1 + left / turned)))
    slide(sliding(0.001, speed, 50.0), until(time))
    (guess,) = expected
    assert 0.5 < guess / len(steps) < 2


def test_stiffness_costs_what_is_expected(steps: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    scene = sliding(0.3, 1.0, 5.0, inertia=1e-3)
    with monkeypatch.context() as patch:
        patch.setattr(budget, "MAX_SLIDE_STEPS", 100)
        with pytest.raises(OutOfReach, match=r"would take some 1\.1e\+03 integration steps"):
            slide(scene, until(5.0))
    slide(scene, until(5.0))
    assert 0.5 < 1100 / len(steps) < 2


def test_what_was_not_expected_is_stopped_in_the_end(steps: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "MAX_SLIDE_STEPS", 10)
    with pytest.raises(OutOfReach, match="the slide takes more than 12 integration steps; 10 are the limit"):
        slide(sliding(0.5, 1.0, 3.0), until(1.5))
    assert len(steps) == 12
