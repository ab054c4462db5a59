"""Coefficients of bodies from which engines make those of pairs, and the pushes that act in each step."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck import load
from bodycheck.adapters.pair_coefficients import COMBINED, Coefficients, Combination, coefficients, differences
from bodycheck.adapters.touching import acting, switches, touching_bodies
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism, PairContact
from bodycheck.reference.scene import Plane, Push

#: Functions that combine the coefficients of two bodies.
RULES = COMBINED

STACK = load("stack-of-ten").scene
assert isinstance(STACK, Mechanism)

#: Three bodies that touch.
THREE = replace(STACK, bodies=STACK.bodies[:3])

positive = st.floats(0.05, 2.0)


def with_pairs(plane: Plane, *pairs: PairContact) -> Mechanism:
    """The three bodies with coefficients of the plane and of pairs."""
    return replace(THREE, plane=plane, contacts=pairs)


@pytest.mark.parametrize("rule", RULES)
@given(friction=st.floats(0, 10), restitution=st.floats(0, 1))
def test_equal_pairs_get_exactly_their_coefficient(rule: Combination, friction: float, restitution: float) -> None:
    scene = with_pairs(Plane(friction, restitution=restitution))
    given = coefficients(scene, 3, rule)
    for one, other in itertools.combinations(given.values(), 2):
        # A square root and a product round twice.
        assert RULES[rule](one.friction, other.friction) == pytest.approx(friction, rel=1e-15)
        assert RULES[rule](one.restitution, other.restitution) == pytest.approx(restitution, rel=1e-15)
    assert differences(scene, touching_bodies(scene), rule) == []


@pytest.mark.parametrize("rule", RULES)
@given(bodies=st.lists(positive, min_size=4, max_size=4))
def test_pairs_of_bodies_with_coefficients_of_their_own_are_all_met(rule: Combination, bodies: list[float]) -> None:
    """If some coefficients of bodies give all pairs, then those that are chosen do too."""
    own = dict(zip((WORLD, 0, 1, 2), bodies, strict=True))
    wanted = {pair: RULES[rule](own[pair[0]], own[pair[1]]) for pair in itertools.combinations(own, 2)}
    scene = with_pairs(Plane(1.0), *(PairContact(pair, friction, 0.0) for pair, friction in wanted.items()))
    given = coefficients(scene, 3, rule)
    for (one, other), friction in wanted.items():
        assert RULES[rule](given[one].friction, given[other].friction) == pytest.approx(friction, rel=1e-8)
    assert differences(scene, touching_bodies(scene), rule) == []


@pytest.mark.parametrize("rule", RULES)
def test_the_pairs_of_the_case_and_those_of_the_plane_come_first(rule: Combination) -> None:
    """In this case only balls that are a metre apart get another coefficient, and it is named."""
    scene = load("simbenchmark-rolling").scene
    given = coefficients(scene, 26, rule)
    combined = RULES[rule]
    assert combined(given[WORLD].friction, given[0].friction) == pytest.approx(0.4)
    assert [combined(given[0].friction, given[ball].friction) for ball in range(1, 26)] == pytest.approx([0.8] * 25)
    assert [combined(given[WORLD].friction, given[ball].friction) for ball in range(1, 26)] == pytest.approx([0.4] * 25)
    (difference,) = differences(scene, touching_bodies(scene), rule)
    assert difference == "friction 0.8 instead of 0.4 of ball-1 and ball-2 and of 299 other pairs"


@pytest.mark.parametrize("rule", RULES)
def test_a_pair_without_restitution_beside_others_with_it(rule: Combination) -> None:
    """A body whose pairs all lack restitution has none; a mean cannot give what a product can."""
    scene = with_pairs(Plane(0.5), PairContact((0, 1), 0.5, 0.8), PairContact((0, 2), 0.5, 0.8), PairContact((1, 2), 0.5, 0.8))
    given = coefficients(scene, 3, rule)
    assert RULES[rule](given[0].restitution, given[1].restitution) == pytest.approx(0.8)
    named = differences(scene, touching_bodies(scene), rule)
    expected = [] if rule != "mean" else ["restitution 0.4 instead of 0 of the plane and brick-1 and of 2 other pairs"]
    assert named == expected


def test_a_coefficient_above_the_largest_of_the_engine_is_named() -> None:
    scene = with_pairs(Plane(25.0))
    assert coefficients(scene, 3, "product")[WORLD] == Coefficients(5.0, 0.0)
    (difference,) = differences(scene, touching_bodies(scene), "product", 10.0)
    assert difference == "friction 10 instead of 25 of the plane and brick-1 and of 5 other pairs"


@given(st.lists(st.tuples(st.integers(0, 40), st.integers(1, 40)), max_size=4))
def test_the_pushes_of_each_step_are_those_of_the_switches(spans: list[tuple[int, int]]) -> None:
    pushes = [Push((1.0 + i, 0.0, 0.0), start=first * 0.1, end=(first + n) * 0.1) for i, (first, n) in enumerate(spans)]
    by_step = switches(pushes, 0.1)
    for step, now in zip(range(100), acting(pushes, 0.1), strict=False):
        assert now == by_step[max(begin for begin in by_step if begin <= step)]
        impulse = np.sum([push.force for push in now]) if now else 0.0
        assert impulse == sum(1.0 + i for i, (first, n) in enumerate(spans) if first <= step < first + n)
