"""Methods are in one class if, and only if, their motions agree to the precision of their arithmetic."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.judging.schemes.classes import Motion, classes
from bodycheck.reference.kinematics import geodesic_angle, multiply
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.schemes.formulations import world_velocity
from bodycheck.reference.schemes.one_step import rosenbrock_euler, step_through
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import truth
from bodycheck.results.key import RunKey
from bodycheck.studies.audit.classes import TRIALS
from tests.support.programs import motion

TUMBLING, TURNED = TRIALS[0].case.scene, TRIALS[1].case.scene
STEP, STEPS = TRIALS[0].timestep, TRIALS[0].case.samples - 1

#: The smallest differences that must be told apart, relative to what a step changes, by the type of numbers.
LEAST = {np.float64: 1e-9, np.float32: 1e-5}


def names(motions: list[Motion]) -> list[set[str]]:
    """The names of the engines in each class."""
    return [{key.engine for key in own.methods} for own in classes(motions)]


def solution(name: str) -> Motion:
    """The exact motion as that of a method."""
    t = np.arange(STEPS + 1) * STEP
    return Motion(TUMBLING, STEP, RunKey.of_method(name, "step"), truth(TUMBLING, t).trajectory, 2.0**-53)


def turned(name: str, given: Motion, angles: Array) -> Motion:
    """A motion whose attitudes are those of a given one, turned about x by angles (n,), in rad."""
    turn = np.stack([np.cos(angles / 2), np.sin(angles / 2), 0 * angles, 0 * angles], axis=1)
    aside = replace(given.trajectory, quaternion=multiply(turn, given.trajectory.quaternion))
    return Motion(given.scene, given.timestep, RunKey.of_method(name, "step"), aside, given.roundoff)


@pytest.mark.parametrize("scene", [TUMBLING, TURNED], ids=["unturned", "turned"])
@pytest.mark.parametrize(("one", "other"), [(np.float64, np.float64), (np.float32, np.float32), (np.float64, np.float32)])
def test_an_algorithm_that_is_written_twice_is_one_class(one: type, other: type, scene: Scene) -> None:
    own = motion("one", scene, STEP, STEPS, one)
    again = motion("other", scene, STEP, STEPS, other, in_world=True)
    (found,) = classes([own, again])
    assert [key.engine for key in found.methods] == ["one", "other"]
    assert 0 < found.distance < LEAST[other]  # they do not compute the same bits, and are nearer than what is told apart


@pytest.mark.parametrize("part", ["rates", "turn", "velocity", "position"])
@pytest.mark.parametrize("number", [np.float64, np.float32])
def test_steps_that_differ_by_little_are_told_apart(number: type, part: str) -> None:
    for scene in (TUMBLING, TURNED):
        plain = motion("plain", scene, STEP, STEPS, number)
        for sign in (1, -1):
            stretched = motion("stretched", scene, STEP, STEPS, number, in_world=True, stretch=sign * LEAST[number], part=part)
            assert names([plain, stretched]) == [{"plain"}, {"stretched"}]


def test_methods_that_merely_err_alike_are_not_in_one_class() -> None:
    exact = solution("exact")
    left, right = (turned(name, exact, sign * 1e-6 * exact.trajectory.t) for name, sign in (("left", 1), ("right", -1)))
    errors = [geodesic_angle(exact.trajectory.quaternion, own.trajectory.quaternion) for own in (left, right)]
    assert errors[0] == pytest.approx(errors[1], rel=1e-6, abs=1e-15)  # angles of 1e-6 rad have an error of some 1e-16 rad
    assert names([left, right]) == [{"left"}, {"right"}]


def test_two_schemes_of_one_order_are_not_in_one_class() -> None:
    rows = step_through(rosenbrock_euler, world_velocity, TUMBLING, STEP, np.array([0] + [1] * STEPS))
    other = Trajectory(np.arange(STEPS + 1) * STEP, rows[:, :3], rows[:, 3:7], rows[:, 7:10], rows[:, 10:])
    for number in LEAST:
        explicit = motion("explicit", TUMBLING, STEP, STEPS, number)
        implicit = Motion(TUMBLING, STEP, RunKey.of_method("implicit", "step"), other, explicit.roundoff)
        assert names([explicit, implicit]) == [{"explicit"}, {"implicit"}]


def test_a_class_is_a_connected_component_with_its_largest_distance() -> None:
    first = motion("first", TUMBLING, STEP, STEPS)
    most = first.allowed
    chain = [first, *(turned(name, first, share * most) for name, share in (("second", 0.7), ("third", 1.4), ("far", 1e4)))]
    joined, far = classes(chain)
    assert [key.engine for key in joined.methods] == ["first", "second", "third"]
    assert joined.distance == pytest.approx(
        1.4 * float(most[-1]), rel=0.01
    )  # the attitudes themselves have errors of some 1e-16 rad
    assert [key.engine for key in far.methods] == ["far"]
    assert far.distance == 0
    assert names([chain[0], chain[2]]) == [{"first"}, {"third"}]


def test_single_precision_does_not_join_what_double_precision_tells_apart() -> None:
    plain = motion("plain", TUMBLING, STEP, STEPS)
    other = motion("other", TUMBLING, STEP, STEPS, stretch=1e-9, part="turn")
    coarse = [motion(name, TUMBLING, STEP, STEPS, np.float32, in_world=True) for name in ("coarse", "coarse too")]
    again = motion("again", TUMBLING, STEP, STEPS, in_world=True)
    for place in range(3):  # the larger class has those of single precision, wherever it stands
        given = [plain, again, *coarse]
        given.insert(place, other)
        assert sorted(names(given), key=len) == [{"other"}, {"plain", "again", "coarse", "coarse too"}]


def test_methods_of_one_class_agree_in_every_scene() -> None:
    here = [motion(name, TUMBLING, STEP, STEPS) for name in ("one", "other")]
    there = motion("one", TURNED, STEP, STEPS), motion("other", TURNED, STEP, STEPS, stretch=1e-6, part="velocity")
    assert names(here) == [{"one", "other"}]
    assert names([*here, *there]) == [{"one"}, {"other"}]


def test_a_scene_in_which_all_schemes_agree_tells_nothing() -> None:
    spin = Scene(Body(1.0, (2.0, 2.5, 3.0)), State(angular_velocity=(0.0, 0.0, 15.0)), gravity=64.0)
    alike = [motion("one", spin, STEP, STEPS), motion("other", spin, STEP, STEPS, in_world=True)]
    assert classes(alike) == ()
    # where a scene tells them apart, the spin still counts
    told = [motion(name, TUMBLING, STEP, STEPS) for name in ("one", "other")]
    assert names([*alike, *told]) == [{"one", "other"}]
    damped = motion("other", spin, STEP, STEPS, stretch=-1e-6, part="rates")
    assert names([alike[0], damped, *told]) == [{"one"}, {"other"}]


def test_methods_whose_motions_are_exact_are_told_from_no_other_if_they_are_compared_with_the_truth() -> None:
    one, other = solution("one"), solution("other")
    assert names([one, other]) == [{"one", "other"}]
    assert classes([replace(own, exact=one.trajectory) for own in (one, other)]) == ()
    erring = [replace(motion(name, TUMBLING, STEP, STEPS), exact=one.trajectory) for name in ("one", "other")]
    assert names(erring) == [{"one", "other"}]


@pytest.mark.parametrize(("part", "value"), [("quaternion", 0.0), ("angular_velocity", 1e300), ("position", np.nan)])
def test_a_motion_whose_states_cannot_be_is_apart_without_a_warning(part: str, value: float) -> None:
    own, broken = solution("own"), solution("broken")
    states = getattr(broken.trajectory, part).copy()
    states[len(states) // 2] = value
    exact = solution("exact").trajectory
    broken = replace(broken, trajectory=replace(broken.trajectory, **{part: states}), exact=exact)
    with warnings.catch_warnings(action="error"):
        assert names([own, broken, solution("again")]) == [{"own", "again"}, {"broken"}]
