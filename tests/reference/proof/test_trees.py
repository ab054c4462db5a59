"""Enclosures of trees: polynomials near to a motion are proved to be near to it, whatever they come from."""

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from bodycheck.casefile.case import load
from bodycheck.reference.candidate import candidate_of
from bodycheck.reference.mechanisms.mechanism import BodyStart, Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.proof.enclosure import QUANTITIES, Enclosure
from bodycheck.reference.scene import Tensor
from bodycheck.reference.truths import Truth
from tests.support.proved_scenes import two_links

pytest.importorskip("flint")
pytest.importorskip("heyoka")

from flint import arb

from bodycheck.reference.proof import one_joint, proving
from bodycheck.reference.proof.balls import precision
from bodycheck.reference.proof.trees import dynamics, polynomials, validated
from bodycheck.reference.proof.trees import tree as trees
from bodycheck.reference.proof.trees.derivatives import along, each_alone


def proof(scene: Mechanism, found: Truth) -> Enclosure:
    """The enclosure of a tree at the states of a truth."""
    return proving.enclosed(scene, found.trajectory, found.joints, candidate_of(scene), math.inf)


def below(enclosure: Enclosure, found: Truth) -> list[str]:
    """The quantities in which a printed bound is smaller than the proved distance."""
    return [name for name in QUANTITIES if (enclosure.nearest[name] > getattr(found.bounds, name)).any()]


@pytest.mark.parametrize("seed", range(6))
def test_no_printed_bound_of_a_tree_is_below_its_proof(seed: int) -> None:
    scene = two_links(seed)
    found = mechanism_truth(scene, np.linspace(0, 0.1, 5))
    enclosure = proof(scene, found)
    assert enclosure.until is None
    assert enclosure.radius < 2.0**-60
    assert below(enclosure, found) == []


def test_a_free_body_with_an_arm_is_enclosed() -> None:
    """A hub of a turned attitude, which is the child of no joint, and an arm on a hinge, in gravity."""
    arm = two_links(0)
    start = BodyStart((0.1, 0.2, 0.3), (0.9, 0.1, -0.3, 0.2), (1.0, -2.0, 0.5), (0.3, 1.5, -0.7))
    hub = replace(arm.bodies[0], start=start)
    scene = replace(arm, bodies=(hub, arm.bodies[1]), joints=(replace(arm.joints[1], type="revolute"),))
    found = mechanism_truth(scene, np.linspace(0, 0.1, 5))
    enclosure = proof(scene, found)
    assert enclosure.until is None
    assert below(enclosure, found) == []


def test_errors_grow_no_more_than_those_of_the_motion() -> None:
    """In 5 s errors of the double pendulum grow a million times; bounds that grow much faster would use up all bits."""
    scene = load("double-pendulum").scene
    assert isinstance(scene, Mechanism)
    found = mechanism_truth(scene, np.linspace(0, 5, 11))
    enclosure = proof(scene, found)
    assert (enclosure.until, enclosure.bits) == (None, proving.BITS_OF_TREES[0])
    assert enclosure.radius < 1e-18


def test_polynomials_and_the_closed_form_enclose_the_same_pendulum() -> None:
    """The balls of a swing by Jacobi's functions and those of the same pendulum as a tree overlap, though they are tiny."""
    scene = load("pendulum-large").scene
    assert isinstance(scene, Mechanism)
    candidate = candidate_of(scene)
    assert candidate is not None
    with precision(160):
        closed = one_joint.states(scene)
        steps = validated.steps(trees.tree_of(scene), Fraction(1), candidate, 160, np.inf)
        assert steps[-1].end >= 1
        for step in steps:
            (position,), (velocity,) = step.at(step.part.centre)
            (exact, rate), *_ = closed(step.part.centre)
            assert position.overlaps(exact)
            assert velocity.overlaps(rate)
            assert max(float(value.rad()) for value in (position, velocity)) < 1e-25


def test_steps_follow_each_other_and_their_nodes_are_doubles() -> None:
    scene = load("double-pendulum").scene
    candidate, times = candidate_of(scene), list[float]()
    assert isinstance(scene, Mechanism)
    assert candidate is not None

    def noted(instants: np.ndarray, bits: int) -> list[list[arb]]:
        times.extend(instants.tolist())
        return candidate(instants, bits)

    with precision(64):
        steps = polynomials.mesh(trees.tree_of(scene), Fraction(3, 2), noted)
    ends = [centre + half for centre, half in steps]
    assert [centre - half for centre, half in steps] == [0, *ends[:-1]]
    assert ends[-1] >= Fraction(3, 2)
    assert len({half for _, half in steps}) > 1
    unit = min(half for _, half in steps) * Fraction(1, 2**polynomials.NODE_BITS)
    assert all((Fraction(time) / unit).denominator == 1 for time in times)


def cart_pole() -> Mechanism:
    scene = load("cart-pole").scene
    assert isinstance(scene, Mechanism)
    return scene


CHANGES: dict[str, Callable[[Mechanism], Mechanism]] = {
    "gravity times 1 + 1e-9": lambda scene: replace(scene, gravity=scene.gravity * (1 + 1e-9)),
    "damping": lambda scene: replace(scene, joints=(scene.joints[0], replace(scene.joints[1], damping=1e-6))),
    "armature": lambda scene: replace(scene, joints=(scene.joints[0], replace(scene.joints[1], armature=1e-9))),
    "axis exchanged": lambda scene: replace(scene, joints=(scene.joints[0], replace(scene.joints[1], axis=(0.0, -1.0, 0.0)))),
}


@pytest.mark.parametrize("fault", CHANGES)
def test_a_truth_of_another_motion_is_contradicted(fault: str) -> None:
    scene = cart_pole()
    found = mechanism_truth(CHANGES[fault](scene), np.linspace(0, 0.2, 5))
    assert below(proof(scene, found), found) != []


def test_a_candidate_that_is_wrong_proves_nothing() -> None:
    """A candidate that drifts away by 1e-9 has a defect, with which the balls grow beyond what is accepted."""
    scene = cart_pole()
    found = mechanism_truth(scene, np.linspace(0, 0.2, 5))
    right = candidate_of(scene)
    assert right is not None

    def wrong(times: np.ndarray, bits: int) -> list[list[arb]]:
        rows = right(times, bits)
        return [[value + arb(1e-9 * time**2) for value in row] for row, time in zip(rows, times.tolist(), strict=True)]

    with pytest.raises(proving.NotEnclosed):
        proving.enclosed(scene, found.trajectory, found.joints, wrong, limit=0.0)


def test_a_proof_that_has_no_more_time_says_until_when() -> None:
    scene = cart_pole()
    found = mechanism_truth(scene, np.linspace(0, 1, 201))
    enclosure = proving.enclosed(scene, found.trajectory, found.joints, candidate_of(scene), limit=0.0)
    assert enclosure.until is not None
    assert enclosure.until < 1
    assert np.isnan(enclosure.farthest["error"][-1])


def test_derivatives_are_those_of_the_efforts() -> None:
    with precision(200):
        tree = trees.tree_of(two_links(1))
        size = len(tree.links)
        rng = np.random.default_rng(3)
        point = [[arb(float(value)) for value in row] for row in rng.normal(size=(3, size))]

        def efforts(values: list[list[arb]]) -> list[arb]:
            return dynamics.efforts(tree, *values, [q.sin() for q in values[0]], [q.cos() for q in values[0]])  # type: ignore[call-arg]

        turns = [q.sin() for q in point[0]], [q.cos() for q in point[0]]
        exact, step = [along(tree, point, turns, each_alone(size, part)) for part in range(3)], arb(2) ** -60  # type: ignore[call-arg]
        for part in range(3):
            for index in range(size):
                moved = [list(row) for row in point]
                moved[part][index] += step
                slopes = [(a - b) / step for a, b in zip(efforts(moved), efforts(point), strict=True)]
                assert all(abs(slope - exact[part][row].get(index, 0)) < 1e-15 for row, slope in enumerate(slopes))
        mass = exact[2]
        assert all(mass[i][j].overlaps(mass[j][i]) for i in range(size) for j in range(size))


def test_a_candidate_for_one_body_is_not_needed() -> None:
    assert candidate_of(load("free-brick").scene) is None


def test_a_damped_pendulum_is_followed_as_a_tree() -> None:
    scene = load("sensor-pendulum").scene
    assert isinstance(scene, Mechanism)
    found = mechanism_truth(scene, np.linspace(0, 0.2, 5))
    enclosure = proof(scene, found)
    assert enclosure.way.startswith("validated polynomials")
    assert below(enclosure, found) == []


def test_a_truth_of_a_ball_of_other_inertia_is_contradicted() -> None:
    scene = load("spherical-pendulum").scene
    assert isinstance(scene, Mechanism)
    (body,) = scene.bodies
    assert isinstance(body.inertia, Tensor)
    (a, b, c), *others = body.inertia.rows
    other = replace(
        body, inertia=replace(body.inertia, rows=((a, b, c + 1e-6 * a), others[0], (others[1][0] + 1e-6 * a, *others[1][1:])))
    )
    found = mechanism_truth(replace(scene, bodies=(other,)), np.linspace(0, 0.2, 5))
    assert below(proof(scene, found), found) != []


def test_a_tree_is_enclosed_at_its_start_alone() -> None:
    scene = cart_pole()
    found = mechanism_truth(scene, np.zeros(1))
    enclosure = proof(scene, found)
    assert enclosure.until is None
    assert enclosure.distance < 1e-15  # rounding of the printed attitude
