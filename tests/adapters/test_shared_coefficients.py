"""Coefficients of bodies from which engines make those of pairs: their product, their harmonic mean, or their mean."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.adapters.touching import coefficients, differing, shares
from bodycheck.reference.mechanisms.mechanism import WORLD, PairContact
from bodycheck.reference.scene import Plane
from bodycheck.reference.trajectory import Array
from tests.support.touching import BALL, OF_BALL, RADIUS, on, several

Rule = tuple[Callable[[Array], Array], Callable[[Array], Array], Callable[[Array, Array], Array]]

#: How engines combine two coefficients, with the function whose mean this is and its inverse.
RULES: dict[str, Rule] = {
    "product": (lambda p: np.log(p) / 2, np.exp, lambda a, b: a * b),
    "harmonic mean": (np.reciprocal, np.reciprocal, lambda a, b: 2 / (1 / a + 1 / b)),
    "mean": (np.asarray, np.asarray, lambda a, b: (a + b) / 2),
}
BALLS = several([(BALL, (0.0, y, RADIUS)) for y in (0.0, 1.0, 2.0)], Plane(0.3, restitution=0.5))


@pytest.mark.parametrize("rule", RULES)
@given(of_bodies=st.lists(st.floats(0.05, 1.0), min_size=3, max_size=6))
def test_what_bodies_can_give_is_given(rule: str, of_bodies: list[float]) -> None:
    forward, backward, combine = RULES[rule]
    bodies = np.array(of_bodies)
    apart = ~np.eye(len(bodies), dtype=bool)
    of_pairs = combine(bodies[:, None], bodies)
    given_to_bodies = shares(of_pairs, apart, forward, backward)
    # Three bodies and more have as many pairs at least; the equations are well conditioned. Harmonic means differ by up to 20.
    np.testing.assert_allclose(combine(given_to_bodies[:, None], given_to_bodies)[apart], of_pairs[apart], rtol=1e-11)


@pytest.mark.parametrize("rule", RULES)
def test_one_pair_shares_its_coefficient_equally(rule: str) -> None:
    forward, backward, combine = RULES[rule]
    one, other = shares(np.full((2, 2), 0.7), ~np.eye(2, dtype=bool), forward, backward)
    assert one == pytest.approx(other, rel=1e-15)
    assert combine(one, other) == pytest.approx(0.7, rel=1e-15)


def test_a_body_without_a_coefficient_has_none_with_any_other() -> None:
    scene = replace(BALLS, contacts=tuple(PairContact(pair, 0.0, 0.0) for pair in ((0, 1), (0, 2), (WORLD, 0))))
    pairs = coefficients(scene)
    given_to_bodies = shares(pairs.friction, pairs.stated, np.reciprocal, np.reciprocal)
    assert given_to_bodies[0] == 0
    assert given_to_bodies[1:] == pytest.approx([0.3] * 3, rel=1e-15)


def test_pairs_that_the_scene_states_count_where_not_all_can_be_given() -> None:
    """A ball touches the others with another coefficient than the plane, and these never touch each other."""
    scene = replace(BALLS, contacts=tuple(PairContact(pair, 0.8, 0.5) for pair in ((0, 1), (0, 2))))
    pairs = coefficients(scene)
    given_to_bodies = shares(pairs.friction, pairs.stated, np.reciprocal, np.reciprocal)
    means = 2 / (1 / given_to_bodies[:, None] + 1 / given_to_bodies)
    assert means[pairs.stated & ~np.eye(4, dtype=bool)] == pytest.approx(
        pairs.friction[pairs.stated & ~np.eye(4, dtype=bool)], rel=1e-13
    )
    (phrase,) = differing("friction", means, pairs.friction, pairs.names)
    assert phrase.endswith("instead of 0.3 between body-1 and body-2")


def test_a_scene_has_the_coefficients_of_its_plane_and_of_its_pairs() -> None:
    single = coefficients(on(Plane(0.4, restitution=0.2), OF_BALL))
    assert (single.names, single.friction[0, 1], single.restitution[0, 1]) == (("body", "the plane"), 0.4, 0.2)
    scene = replace(BALLS, contacts=(PairContact((WORLD, 2), 0.1, 0.9),))
    pairs = coefficients(scene)
    assert pairs.names == ("body-0", "body-1", "body-2", "the plane")
    assert [*pairs.friction[2, :2].tolist(), pairs.friction[2, 3]] == [0.3, 0.3, 0.1]
    assert pairs.restitution[3, 2] == 0.9
    assert not pairs.stated[0, 1]
    assert pairs.stated[3, 1]
