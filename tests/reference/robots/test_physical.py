"""What no bodies can have is named, and what some bodies have is not."""

from dataclasses import replace
from random import Random

import numpy as np
import pytest

from bodycheck.reference.robots.model import RobotModel, with_joint, with_link
from bodycheck.reference.robots.physical import rounding, unphysical
from tests.support.robot_trees import random_rotation, random_tree

TURN = random_rotation(Random(5))


def tree() -> RobotModel:
    return random_tree(Random(1), 6, types=("revolute", "prismatic"))


def moments(*values: float) -> np.ndarray:
    """A tensor of these principal moments along turned axes."""
    return TURN @ np.diag(np.array(values, np.longdouble)) @ TURN.T


@pytest.mark.parametrize("seed", range(5))
def test_random_trees_are_possible(seed: int) -> None:
    assert unphysical(random_tree(Random(seed), 20, seed % 2 == 0, ("revolute", "fixed", "planar", "spherical"))) == ()


@pytest.mark.parametrize(
    ("changes", "quantity", "told"),
    [
        ({"mass": -1.0}, "mass", "-1 kg"),
        ({"mass": float("nan")}, "mass", "nan"),
        ({"mass": float("inf")}, "mass", "inf"),
        ({"mass": 0.0}, "inertia", "the mass is zero"),
        ({"center_of_mass": np.array([0, np.nan, 0], np.longdouble)}, "center_of_mass", "not a number"),
        ({"inertia": np.full((3, 3), np.nan, np.longdouble)}, "inertia", "not a number"),
        ({"inertia": moments(-0.1, 0.5, 0.5)}, "inertia", "moments are -0.1, 0.5 and 0.5 kg m^2; no moment is negative"),
        (
            {"inertia": moments(0.1, 0.2, 0.4)},
            "inertia",
            "the largest exceeds the sum of the others by 0.1",
        ),
    ],
)
def test_what_no_link_can_have_is_named(changes: dict, quantity: str, told: str) -> None:
    (fault,) = unphysical(with_link(tree(), "link_2", **changes))
    assert (fault.subject, fault.quantity) == ("link_2", quantity)
    assert told in fault.text


@pytest.mark.parametrize("inertia", [moments(0, 0, 0), moments(0, 0.3, 0.3), moments(0.1, 0.2, 0.3), moments(-1e-35, 0, 1e-35)])
def test_points_rods_and_plates_are_possible(inertia: np.ndarray) -> None:
    # Their moments are at the border of what is possible, and the roundings of turned components are on either side of it.
    assert unphysical(with_link(tree(), "link_2", inertia=inertia)) == ()


def test_numbers_beyond_doubles_are_judged_as_others_are() -> None:
    large = with_link(tree(), "link_2", inertia=np.longdouble("1e308") * np.ones((3, 3)), mass=float("inf"))
    assert [fault.quantity for fault in unphysical(large)] == ["mass"]
    assert [fault.quantity for fault in unphysical(with_link(large, "link_2", mass=1.0))] == ["inertia"]


@pytest.mark.parametrize("quantity", ["armature", "damping", "friction"])
def test_coefficients_are_not_negative(quantity: str) -> None:
    (fault,) = unphysical(with_joint(tree(), "joint_3", **{quantity: -0.5}))
    assert (fault.subject, fault.quantity) == ("joint_3", quantity)
    assert "-0.5" in fault.text


def test_a_joint_that_moves_nothing_is_named() -> None:
    model = tree()
    leaf = next(joint for joint in model.joints if all(other.parent != joint.child for other in model.joints))
    name = model.links[leaf.child].name
    empty = with_link(model, name, mass=0.0, inertia=np.zeros((3, 3), np.longdouble))
    (fault,) = unphysical(empty)
    assert (fault.subject, fault.quantity) == (leaf.name, "mass")
    assert unphysical(with_joint(empty, leaf.name, armature=0.1)) == ()
    welded = replace(leaf, type="fixed")
    assert unphysical(replace(empty, joints=tuple(welded if joint is leaf else joint for joint in empty.joints))) == ()


def test_roundings_of_mass_times_the_square_of_the_size_are_possible() -> None:
    """A foot of iCub: 0.2675 kg, 0.056 m from its frame; its moments are what rounding has left of zero."""
    foot = {"mass": 0.2675, "center_of_mass": np.array([0.008, 0, 0.0553], np.longdouble)}
    assert unphysical(with_link(tree(), "link_2", **foot, inertia=np.diag([-1.35525e-20, 0, 1.35525e-20]))) == ()
    (fault,) = unphysical(with_link(tree(), "link_2", **foot, inertia=np.diag([-1.35525e-14, 0, 1.35525e-14])))
    assert fault.quantity == "inertia"


def test_the_size_of_a_link_is_the_distance_of_its_farthest_joint() -> None:
    origin = np.zeros(3, np.longdouble)
    assert rounding(2.0, origin, []) < rounding(2.0, origin, [origin + 0.5]) == pytest.approx(2 * 1e-14 * 0.25)
    assert rounding(2.0, origin + 0.5, [origin]) == rounding(2.0, origin, [origin + 0.5])
