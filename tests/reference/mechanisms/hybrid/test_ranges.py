"""The instants at which joints pass their limits, against closed forms and truths at these instants."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.mechanisms import recursion
from bodycheck.reference.mechanisms.hybrid import ranges
from bodycheck.reference.mechanisms.hybrid.ranges import Passing, passed
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.scene import Plane
from tests.support.jointed import cart_pole, four_bar, free_chain, on_one_joint


@dataclass(frozen=True)
class Limits:
    name: str
    lower: float | None = None
    upper: float | None = None
    form: tuple[tuple[str, float], ...] = ()

    @property
    def terms(self) -> tuple[tuple[str, float], ...]:
        return self.form or ((self.name, 1.0),)


def sine(velocity: float = 2.0, start: float = 0.0) -> Mechanism:
    """A slider of 1 kg on a spring of 4 N/m: without start its coordinate is sin 2t for a velocity of 2 m/s."""
    return on_one_joint("prismatic", start, velocity, stiffness=4.0)


def both(limit: float) -> tuple[Passing, ...]:
    return passed(sine(), [Limits("joint", -limit, limit)], 4.0)


def encloses(passing: Passing, time: float) -> bool:
    return abs(passing.time - time) <= passing.error + math.ulp(time)


def test_instants_of_a_sine_are_those_of_its_inverse() -> None:
    upper, lower = both(0.6)
    assert (upper.side, upper.limit, lower.side, lower.limit) == ("upper", 0.6, "lower", -0.6)
    assert encloses(upper, math.asin(0.6) / 2)
    assert encloses(lower, (math.pi + math.asin(0.6)) / 2)
    assert max(upper.error, lower.error) < 1e-14


@pytest.mark.parametrize("above", [1e-3, 1e-8, 1e-13])
def test_a_limit_that_is_passed_for_a_moment_between_samples_is_passed(above: float) -> None:
    upper, lower = both(1 - above)
    assert encloses(upper, math.asin(1 - above) / 2)
    assert encloses(lower, (math.pi + math.asin(1 - above)) / 2)


@pytest.mark.parametrize("limit", [1.0, 1 + 1e-13, 1.5])
def test_a_limit_that_is_touched_or_not_reached_is_not_passed(limit: float) -> None:
    assert both(limit) == ()


@pytest.mark.parametrize(
    ("start", "velocity", "limits", "expected"),
    [
        (0.5, 0.0, Limits("joint", upper=0.4), (Passing("joint", "upper", 0.4, 0.0, 0.0),)),
        (0.5, 0.1, Limits("joint", upper=0.5), (Passing("joint", "upper", 0.5, 0.0, 0.0),)),
        (0.5, -0.1, Limits("joint", lower=0.5), (Passing("joint", "lower", 0.5, 0.0, 0.0),)),
        (0.5, 0.0, Limits("joint", upper=0.5), ()),
        (0.0, 0.0, Limits("joint", 0.0, 0.0), ()),
    ],
    ids=["outside", "outwards", "outwards below", "inwards", "at rest on both"],
)
def test_the_start_counts(start: float, velocity: float, limits: Limits, expected: tuple[Passing, ...]) -> None:
    assert passed(sine(velocity, start), [limits], 1.0) == expected


def test_a_joint_that_begins_at_rest_on_a_limit_and_accelerates_outwards_passes_it_at_once() -> None:
    (passing,) = passed(sine(0.0, 0.5), [Limits("joint", lower=0.5)], 1.0)
    assert passing.time - passing.error <= 0
    assert passing.time < 1e-8


def test_a_joint_that_returns_to_the_limit_where_it_began_passes_it_then() -> None:
    (passing,) = passed(sine(-2.0, 0.0), [Limits("joint", upper=0.0)], 4.0)
    assert encloses(passing, math.pi / 2)


@pytest.mark.parametrize(
    "mechanism", [cart_pole(), free_chain(), pytest.param(four_bar(), marks=pytest.mark.slow)], ids=["cart", "chain", "loop"]
)
def test_the_truth_is_within_the_limit_before_and_beyond_it_after(mechanism: Mechanism) -> None:
    width = 0.3
    limits = [Limits(joint.name, joint.start[0] - width, joint.start[0] + width) for joint in mechanism.joints]
    passings = passed(mechanism, limits, 1.0)
    names = [joint.name for joint in mechanism.joints]
    assert passings
    assert list(passings) == sorted(passings, key=lambda each: each.time)
    for each in passings:
        apart = max(each.error, 1e-9)
        motion = mechanism_truth(mechanism, np.array([each.time - apart, each.time + apart])).joints
        assert motion is not None
        before, after = motion.position[:, names.index(each.name)]
        assert before < each.limit < after if each.side == "upper" else after < each.limit < before


def test_a_multiple_of_a_coordinate_passes_when_the_coordinate_does() -> None:
    limits = Limits("tendon", -1.2, 1.2, (("joint", -2.0),))
    passings = passed(sine(), [limits], 4.0)
    assert [each.side for each in passings] == ["lower", "upper"]
    assert encloses(passings[0], math.asin(0.6) / 2)
    assert encloses(passings[1], (math.pi + math.asin(0.6)) / 2)


def test_a_linear_form_is_within_its_limit_before_and_beyond_it_after() -> None:
    mechanism = cart_pole()
    names = [joint.name for joint in mechanism.joints]
    terms = tuple(zip(names, (0.7, -1.3), strict=True))
    start = sum(joint.start[0] * factor for joint, (_, factor) in zip(mechanism.joints, terms, strict=True))
    passings = passed(mechanism, [Limits("tendon", start - 0.2, start + 0.2, terms)], 1.0)
    assert passings
    for each in passings:
        apart = max(each.error, 1e-9)
        motion = mechanism_truth(mechanism, np.array([each.time - apart, each.time + apart])).joints
        assert motion is not None
        before, after = motion.position @ [factor for _, factor in terms]
        assert each.name == "tendon"
        assert before < each.limit < after if each.side == "upper" else after < each.limit < before


def test_a_joint_with_dry_friction_passes_a_limit_before_it_sticks() -> None:
    """It is braked by 1 m/s^2 from 1 m/s, and comes 0.5 m far."""
    sliding = on_one_joint("prismatic", 0.0, 1.0, friction=1.0)
    (passing,) = passed(sliding, [Limits("joint", upper=0.375)], 3.0)
    assert encloses(passing, 0.5)
    assert passed(sliding, [Limits("joint", upper=0.5)], 3.0) == ()


def test_the_first_of_many_passings_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The motion is followed a few times, and not once for each limit."""
    calls = []
    solve = recursion.solver()
    monkeypatch.setattr(recursion, "solver", lambda: lambda *given: calls.append(given) or solve(*given))
    limits = [Limits(joint.name, -0.01, 0.01) for joint in free_chain().joints]
    assert len(passed(free_chain(), limits, 20.0)) == 3
    assert len(calls) <= 9 + ranges.ROUNDS


def test_ranges_of_other_joints_and_scenes_are_refused() -> None:
    with pytest.raises(ValueError, match="elbow is no revolute or prismatic joint"):
        passed(cart_pole(), [Limits("elbow", 0.0, 1.0)], 1.0)
    with pytest.raises(NotModelled, match="limits of joints"):
        passed(replace(cart_pole(), plane=Plane(0.5)), [Limits("pin", 0.0, 1.0)], 1.0)
