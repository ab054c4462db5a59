"""What a wobble does to a spin, against the truth's own motion."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load, truth
from bodycheck.reference.chapter.wobble import cone_angle, largest_wobble
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.truth import truth as truth_of_scene

MOMENTS = {"about the least": (0.32, 0.3, 0.1), "about the largest": (0.15, 0.2, 0.3)}


@pytest.mark.parametrize("moments", MOMENTS.values(), ids=MOMENTS)
@pytest.mark.parametrize("part", [0.99, 1.01])
def test_the_spin_is_lost_beyond_the_limit_and_kept_below(moments: tuple[float, float, float], part: float) -> None:
    wobble = part * largest_wobble(moments, 5.0)
    far = int(np.argmax(moments)) if moments[2] == min(moments) else int(np.argmin(moments))
    rates = [0.0, 0.0, 5.0]
    rates[far] = wobble
    scene = Scene(Body(1.0, moments), State(angular_velocity=(rates[0], rates[1], rates[2])))
    spin = truth_of_scene(scene, np.linspace(0, 20, 401)).trajectory.angular_velocity[:, 2]
    assert bool(spin.min() < 0) is (part > 1)


def test_a_round_ball_bears_any_wobble() -> None:
    assert largest_wobble((0.3, 0.3, 0.1), 5.0) == math.inf


def test_a_spin_about_the_middle_axis_bears_none() -> None:
    with pytest.raises(ValueError, match="unstable without any wobble"):
        largest_wobble((0.1, 0.3, 0.2), 5.0)


def test_the_axis_of_a_round_ball_keeps_its_angle_to_the_angular_momentum() -> None:
    case = load("football-wobble")
    wobble, _, spin = case.scene.initial.angular_velocity
    flight = truth(case).trajectory
    moments = np.array(case.scene.body.moments)
    momentum = rotate(flight.quaternion, moments * flight.angular_velocity)
    axis = rotate(flight.quaternion, np.tile([0.0, 0.0, 1.0], (len(flight), 1)))
    along = (axis * momentum).sum(axis=1) / np.linalg.norm(momentum, axis=1)
    np.testing.assert_allclose(np.arccos(along), cone_angle(case.scene.body.moments, spin, wobble), atol=1e-13)
    # The book's question has the answer: none, as long as the ball is round. Without a spin the axis turns end over end.
    tumbling = replace(case, scene=replace(case.scene, initial=replace(case.scene.initial, angular_velocity=(2.0, 0.0, 0.0))))
    still = truth(tumbling).trajectory
    turned = rotate(still.quaternion, np.tile([0.0, 0.0, 1.0], (len(still), 1)))
    assert np.arccos(np.clip(turned @ turned[0], -1, 1)).max() == pytest.approx(math.pi, abs=0.02)
