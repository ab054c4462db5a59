"""Links that are joined where they are welded: the same robot with fewer links."""

from dataclasses import replace
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck.reference.robots.dynamics import terms_at
from bodycheck.reference.robots.fusing import fused, joined
from bodycheck.reference.robots.model import RobotLink, with_link
from bodycheck.reference.robots.states import seeded_states
from tests.support.robot_trees import random_tree

GRAVITY = (0.3, -0.2, -9.81)

#: Some roundings in double precision, which the mass of a link has.
ROUNDINGS = 1e-15


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32), st.integers(1, 15), st.booleans(), st.booleans())
def test_fused_links_move_as_they_did(seed: int, count: int, floating: bool, keeping: bool) -> None:
    model = random_tree(Random(seed), count, floating, ("revolute", "prismatic", "spherical", "fixed", "fixed"))
    kept = {link.name for link in model.links[::2]} if keeping else set()
    other = fused(model, kept)
    fixed = {model.links[joint.child].name for joint in model.joints if joint.type == "fixed"}
    assert {link.name for link in model.links} - {link.name for link in other.links} == fixed - kept
    assert [joint.name for joint in other.joints if joint.type != "fixed"] == [
        joint.name for joint in model.joints if joint.type != "fixed"
    ]
    states = seeded_states(model, 2, 1)
    for one, two in zip(terms_at(model, states, GRAVITY), terms_at(other, states, GRAVITY), strict=True):
        for name in ("mass_matrix", "gravity_force", "coriolis_force", "inverse_dynamics"):
            before, after = getattr(one, name), getattr(two, name)
            assert np.abs(before - after).max() <= ROUNDINGS * np.abs(before).max(initial=1)
        for name, pose in two.poses.items():
            apart = np.abs(pose - one.poses[name])[:3].max()
            assert apart <= ROUNDINGS
            assert abs(pose[3:] @ one.poses[name][3:]) == pytest.approx(1, abs=ROUNDINGS)


def test_what_is_welded_to_the_world_is_the_root() -> None:
    model = random_tree(Random(3), 4)
    welded = replace(model, joints=tuple(replace(joint, type="fixed") for joint in model.joints))
    alone = fused(welded, [])
    assert [link.name for link in alone.links] == ["base"]
    assert alone.links[0].mass == pytest.approx(sum(link.mass for link in model.links), rel=1e-15)  # roundings of doubles
    assert alone.joints == ()


def test_two_points_are_a_rod_without_thickness() -> None:
    zero = np.zeros((3, 3), np.longdouble)
    points = [RobotLink(name, 2.0, np.array([x, 0, 0], np.longdouble), zero) for name, x in (("one", 1), ("other", -1))]
    rod = joined(points)
    assert (rod.name, rod.mass) == ("one", 4.0)
    assert not rod.center_of_mass.any()
    assert np.array_equal(rod.inertia, np.diag([0, 4, 4]))


def test_masses_that_cancel_have_their_inertia_about_the_origin() -> None:
    zero = np.zeros((3, 3), np.longdouble)
    points = [RobotLink(name, mass, np.array([1, 0, 0], np.longdouble), zero) for name, mass in (("one", 2.0), ("other", -2.0))]
    assert np.array_equal(joined(points).inertia, zero)


def test_an_infinite_mass_has_no_centre() -> None:
    zero = np.zeros((3, 3), np.longdouble)
    points = [RobotLink(name, np.inf, np.array([1, 0, 0], np.longdouble), zero) for name in ("one", "other")]
    assert np.isnan(joined(points).center_of_mass[0])


def test_a_link_without_mass_that_is_kept_stays_as_it_is() -> None:
    model = with_link(random_tree(Random(8), 5, types=("revolute", "fixed")), "link_2", mass=0.0, inertia=np.zeros((3, 3)))
    names = [link.name for link in fused(model, {link.name for link in model.links}).links]
    assert names == [link.name for link in model.links]
