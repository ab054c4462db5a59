"""Rest that dry friction holds is decided exactly, at the limit of friction too."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.proof.enclosure import Enclosure, NotEnclosed
from bodycheck.reference.scene import Tensor
from bodycheck.reference.trajectory import Trajectory

pytest.importorskip("flint")

from bodycheck.reference.proof import proving

TIMES = np.linspace(0.0, 1.0, 3)


def arm(count: int, excess: float = 0.0) -> Mechanism:
    """Rods on hinges in a horizontal line, each of which needs all its friction to be held; the last one `excess` times more.

    The loads are small integers, and the excess is that of a spring at the last hinge.
    """
    bodies, joints = [], []
    for number in range(count):
        tensor = Tensor(1.0, ((0.25, 0.0, 0.0), (0.0, 0.25, 0.0), (0.0, 0.0, 0.25)))
        bodies.append(JointedBody(f"rod {number}", tensor, (0.5, 0.0, 0.0)))
        rest = count - number
        load = 8.0 * rest * rest / 2  # gravity times the rods from here on, at half of their length
        joints.append(
            Joint(
                *(f"hinge {number}", "revolute", number - 1 if number else WORLD, number),
                position=(1.0 if number else 0.0, 0.0, 0.0),
                axis=(0.0, -1.0, 0.0),
                friction=load,
                start=(0.0,),
                start_velocity=(0.0,),
            )
        )
    joints[-1] = replace(joints[-1], stiffness=4.0 * abs(excess), rest=-1.0 if excess > 0 else 1.0)
    return Mechanism(tuple(bodies), tuple(joints), gravity=8.0)


def proof(scene: Mechanism) -> Enclosure:
    """The enclosure of the motion of an arm, whose printed states are at rest."""
    count, zeros = len(scene.bodies), np.zeros((len(scene.bodies), len(TIMES), 3))
    position, attitude = zeros.copy(), np.zeros((count, len(TIMES), 4))
    position[:, :, 0], attitude[:, :, 0] = np.arange(count)[:, None] + 0.5, 1.0
    still = np.zeros((len(TIMES), count))
    return proving.enclosed(scene, Trajectory(TIMES, position, attitude, zeros, zeros), JointMotion(still, still))


@pytest.mark.parametrize("count", [2, 3, 4])
def test_friction_that_is_just_enough_holds_and_its_joints_are_named(count: int) -> None:
    enclosure = proof(arm(count))
    assert enclosure.until is None
    assert enclosure.distance < 1e-300
    assert all(f"hinge {number}" in enclosure.way for number in range(count))


@pytest.mark.parametrize("excess", [1e-15, 1e-30])
@pytest.mark.parametrize("count", [2, 3, 4])
def test_an_excess_far_below_the_digits_of_doubles_decides(count: int, excess: float) -> None:
    """The efforts of springs differ by 1e-30 of the friction, which doubles do not show."""
    held = proof(arm(count, -excess))
    assert held.until is None
    assert f"hinge {count - 1}" not in held.way
    assert f"hinge {count - 2}" in held.way
    with pytest.raises(NotEnclosed, match=f"hinge {count - 1} slips"):
        proof(arm(count, excess))


def test_friction_in_motion_is_not_enclosed() -> None:
    scene = arm(2)
    moving = replace(scene, joints=(replace(scene.joints[0], start_velocity=(1.0,)), scene.joints[1]))
    with pytest.raises(NotEnclosed, match="moves"):
        proof(moving)
