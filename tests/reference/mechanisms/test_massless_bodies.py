"""Bodies without mass: frames between joints of one body, roots of trees, and branches, against equivalent mechanisms."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.truths import Truth
from tests.support.jointed import body, four_bar

TIMES = np.linspace(0.0, 1.0, 6)
SOLID = body("solid", 1.25, (0.02, 0.03, 0.025), (0.1, -0.05, -0.3))
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def frame(name: str) -> JointedBody:
    return body(name, 0.0, (0.0, 0.0, 0.0))


def truth_of(bodies: tuple[JointedBody, ...], joints: tuple[Joint, ...], gravity: float = 9.81) -> Truth:
    return mechanism_truth(Mechanism(bodies, joints, gravity=gravity), TIMES)


def same(one: Truth, other: Truth, one_body: int = 0, other_body: int = 0) -> bool:
    """Whether a body moves alike in two truths, as far as their bounds say, and both bounds are small."""
    bounds = one.bounds, other.bounds
    largest = max(float(each.error.max()) for each in bounds)
    first, second = one.trajectory.body(one_body), other.trajectory.body(other_body)
    apart = np.abs(first.position - second.position).max(axis=1)
    slower = np.abs(first.velocity - second.velocity).max(axis=1)
    return bool(
        largest < 1e-13
        and (apart <= bounds[0].position_error + bounds[1].position_error).all()
        and (slower <= bounds[0].velocity_error + bounds[1].velocity_error).all()
    )


def test_two_hinges_of_one_body_are_a_universal_joint() -> None:
    hinges = (
        Joint("one", "revolute", WORLD, 0, (0.0, 0.0, 2.0), axis=X, start=(0.4,), start_velocity=(0.5,)),
        Joint("two", "revolute", 0, 1, axis=Y, start=(-0.7,), start_velocity=(1.5,)),
    )
    universal = Joint("both", "universal", WORLD, 0, (0.0, 0.0, 2.0), start=(0.4, -0.7), start_velocity=(0.5, 1.5))
    assert same(truth_of((frame("frame"), SOLID), hinges), truth_of((SOLID,), (universal,)), one_body=1)


def test_a_frame_with_a_body_fixed_to_it_is_this_body() -> None:
    hinge = Joint("hinge", "revolute", WORLD, 0, (0.0, 0.0, 2.0), axis=X, damping=0.1, start=(0.4,), start_velocity=(0.5,))
    carried = Joint("weld", "fixed", 0, 1)
    assert same(truth_of((frame("frame"), SOLID), (hinge, carried)), truth_of((SOLID,), (hinge,)), one_body=1)


def test_a_frame_at_the_root_of_a_free_base_carries_its_mass_as_a_fixed_child() -> None:
    """The state of the root is that of its origin, about which the body turns."""
    arm = body("arm", 0.5, (0.01, 0.02, 0.015), (0.0, 0.2, 0.1))
    root = replace(frame("root"), start=BodyStart((0.0, 0.0, 1.0), velocity=(0.5, 0.0, 1.0), rotation=(1.0, 2.0, -0.5)))
    spin, centre = np.array([1.0, 2.0, -0.5]), np.array(SOLID.center_of_mass)
    moved = tuple((np.array([0.5, 0.0, 1.0]) + np.cross(spin, centre)).tolist())
    start = BodyStart((0.1, -0.05, 0.7), velocity=moved, rotation=(1.0, 2.0, -0.5))
    hinge = Joint("hinge", "revolute", 1, 2, (0.0, 0.3, 0.0), axis=X, start=(0.3,), start_velocity=(2.0,))
    with_frame = truth_of((root, SOLID, arm), (Joint("weld", "fixed", 0, 1), hinge))
    alone = truth_of((replace(SOLID, start=start), arm), (replace(hinge, parent=0, child=1),))
    assert with_frame.bounds.error.max() < 1e-14
    for one, other in ((1, 0), (2, 1)):  # the velocity of the solid is rounded in the second mechanism
        first, second = with_frame.trajectory.body(one), alone.trajectory.body(other)
        np.testing.assert_allclose(first.position, second.position, rtol=0, atol=2e-15)
        np.testing.assert_allclose(first.angular_velocity, second.angular_velocity, rtol=0, atol=2e-14)


def test_a_frame_at_the_end_of_a_branch_changes_nothing() -> None:
    hinge = Joint("hinge", "revolute", WORLD, 0, axis=X, start=(0.4,), start_velocity=(0.5,))
    slider = Joint("slider", "prismatic", 0, 1, axis=Z, stiffness=50.0, start=(0.1,), start_velocity=(0.0,))
    bodies = SOLID, replace(SOLID, name="bead")
    bare = truth_of(bodies, (hinge, slider))
    tip = Joint("tip", "fixed", 1, 2, (0.0, 0.0, 0.5))
    assert same(truth_of((*bodies, frame("tip")), (hinge, slider, tip)), bare, one_body=1, other_body=1)


def test_a_body_without_mass_moves_by_its_armature() -> None:
    wheel = Joint("wheel", "revolute", WORLD, 0, axis=X, armature=0.5, effort=2.0, start=(0.0,), start_velocity=(1.0,))
    truth = truth_of((frame("wheel"),), (wheel,))
    assert truth.joints is not None
    np.testing.assert_allclose(truth.joints.position[:, 0], TIMES + 2 * TIMES**2, rtol=1e-15, atol=1e-16)
    assert not truth.bounds.angular_momentum_error.any()


@pytest.mark.slow
def test_a_frame_in_a_loop_has_a_truth() -> None:
    bar = four_bar()
    joints = (replace(bar.joints[0], child=3), Joint("weld", "fixed", 3, 0), *bar.joints[1:])
    with_frame = mechanism_truth(replace(bar, bodies=(*bar.bodies, frame("frame")), joints=joints), TIMES)
    assert same(with_frame, mechanism_truth(bar, TIMES), 1, 1)


def test_a_mass_matrix_that_becomes_singular_ends_the_truth_with_the_joint_and_the_time() -> None:
    """Three hinges of one body at right angles: the second one makes the axes of the others parallel, at pi / 2."""
    names = "first", "second", "third"
    joints = tuple(
        Joint(name, "revolute", n - 1, n, axis=axis, start=(0.0,), start_velocity=(velocity,))
        for n, (name, axis, velocity) in enumerate(zip(names, (Z, Y, X), (0.0, 2.0, 0.0), strict=True))
    )
    bodies = frame("one"), frame("two"), body("solid", 1.0, (0.02, 0.03, 0.025))
    with pytest.raises(OutOfReach, match=r"t = 0\.785398 s: what the joint first moves") as caught:
        truth_of(bodies, joints, gravity=0.0)
    assert "mass matrix" in str(caught.value)
