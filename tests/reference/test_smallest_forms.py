"""The smallest forms of the reference: each agrees with the full one, and is within its bound."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck import load
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.start import start
from bodycheck.reference.flight import closed_form, symmetric_top, torque_free
from bodycheck.reference.flight.closed_form import STORED_ERROR_RAD, smallest_form
from bodycheck.reference.flight.drag.translation import translation
from bodycheck.reference.independent.closed_form import NAME as CLOSED_FORM_NAME
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.planar import planar_state
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Scene, State, Vector
from bodycheck.reference.sliding.friction import friction
from bodycheck.reference.sliding.motion import coupled, slide, smallest_friction
from bodycheck.reference.truth import truth as truth_of_scene
from bodycheck.reference.truths import distance
from bodycheck.reference.witness import angle_between
from bodycheck.reference.witnesses import Backend, backend, dop853
from tests.support.flat_slides import BRICK, DISK, PLANES, flat

try:
    from bodycheck.reference.integration import taylor
except ImportError:
    taylor = None  # where heyoka is not installed

TIMES = np.linspace(0, 5, 51)
EPS = float(np.finfo(float).eps)


def thrown(moments: Vector, rates: Vector) -> Scene:
    start = State((1.0, 2.0, 3.0), (0.5, 0.5, -0.5, 0.5), (3.0, -4.0, 5.0), rates)
    return Scene(Body(1.5, moments), start, gravity=9.81)


FORMS = {
    "constant attitude": thrown((0.1, 0.2, 0.25), (0.0, 0.0, 0.0)),
    "steady turn, sphere": thrown((0.2, 0.2, 0.2), (1.0, -2.0, 3.0)),
    "steady turn, principal axis": thrown((0.1, 0.2, 0.25), (0.0, -3.0, 0.0)),
    "steady turn, across the axis": thrown((0.2, 0.2, 0.25), (1.0, 2.0, 0.0)),
    "symmetric top": thrown((0.2, 0.2, 0.25), (1.0, -2.0, 3.0)),
    "symmetric top about I": thrown((0.1, 0.2, 0.2), (3.0, 1.0, 0.5)),
    "symmetric top about J": thrown((0.2, 0.3, 0.2), (1.0, 2.0, -1.0)),
    "elliptic functions": thrown((0.1, 0.2, 0.25), (1.0, -2.0, 3.0)),
}


@pytest.mark.parametrize("name", FORMS)
def test_each_scene_gets_its_smallest_closed_form_and_says_why(name: str) -> None:
    found = truth_of_scene(FORMS[name], TIMES)
    assert found.model == f"closed form: {name.partition(',')[0].partition(' about')[0]}"
    assert found.backend == "numpy"
    assert found.reason
    assert found.witnesses


@pytest.mark.parametrize("solver", [dop853(), backend()], ids=lambda solver: solver.name)
@pytest.mark.parametrize("name", FORMS)
def test_every_form_agrees_with_the_full_integration(name: str, solver: Backend) -> None:
    """In all coordinates, by both forms of the equations; nothing that is not needed changes the truth beyond its bound."""
    found = truth_of_scene(FORMS[name], TIMES, solver)
    # DOP853 at 2.3e-14 a step is good to some 1e-13 after 20 rad; Taylor's method in 80 bits to the rounding of a quaternion.
    own = 1e-12 if solver.name == dop853().name else 1e-16
    for way in (solver.euler_lagrange, solver.quasi_coordinates) if any(FORMS[name].initial.angular_velocity) else ():
        integrated = way(FORMS[name], TIMES).quaternion
        assert integrated is not None
        assert (angle_between(integrated, found.trajectory.quaternion) <= found.bounds.error + own).all()
    assert found.bounds.error.max() < 1e-14


@pytest.mark.parametrize("name", FORMS)
def test_every_form_is_within_its_bound_of_128_bits(name: str) -> None:
    if taylor is None:
        pytest.skip("needs heyoka")
    exact = taylor.euler_lagrange(FORMS[name], TIMES, "quadruple").quaternion
    found = closed_form.flight(FORMS[name], TIMES).motion.quaternion
    assert (taylor.attitude_difference(found, exact) <= closed_form.flight(FORMS[name], TIMES).bounds.error).all()


MOMENT = st.one_of(st.floats(0.05, 1.0), st.floats(-9, 0).map(lambda power: 10.0**power))
RATE = st.one_of(st.floats(-10, 10), st.floats(-1e-8, 1e-8), st.just(0.0))


@settings(max_examples=200)
@given(equal=MOMENT, part=st.floats(1e-9, 2.0), axis=st.integers(0, 2), rates=st.tuples(RATE, RATE, RATE))
def test_the_symmetric_top_is_the_elliptic_motion_of_a_symmetric_body(
    equal: float, part: float, axis: int, rates: Vector
) -> None:
    moments = [equal] * 3
    moments[axis] = part * equal
    i, j, k = moments
    begin = start(Scene(Body(1.0, (i, j, k)), State(quaternion=(0.5, -0.5, 0.5, 0.5), angular_velocity=rates)))
    if part == 1 or smallest_form(begin.moments, begin.rates).rotation is not symmetric_top.rotation:
        return
    times = np.array([0.0, 0.7, 5.0, 1000.0])
    small, general = symmetric_top.rotation(begin, times), torque_free.rotation(begin, times)
    # Each errs by some ten roundings and by those of its angles, a part in 1e19 of at most 3e4 rad.
    assert geodesic_angle(small.attitude, general.attitude).max() <= 2 * STORED_ERROR_RAD + 1e-14
    assert np.abs(small.angular_velocity - general.angular_velocity).max() <= (2 * STORED_ERROR_RAD + 1e-14) * math.hypot(
        *rates
    )


def test_a_nearly_symmetric_body_gets_the_general_form_and_moves_alike() -> None:
    symmetric = FORMS["symmetric top"]
    nearly = replace(symmetric, body=replace(symmetric.body, moments=(0.2, math.nextafter(0.2, 1.0), 0.25)))
    one, other = truth_of_scene(symmetric, TIMES), truth_of_scene(nearly, TIMES)
    assert other.model == "closed form: elliptic functions"
    # A relative change of one rounding in a moment turns the body by as much a radian, of which there are 20.
    assert geodesic_angle(one.trajectory.quaternion, other.trajectory.quaternion).max() < 100 * EPS


def test_what_does_not_act_changes_no_digit() -> None:
    still, turning = FORMS["constant attitude"], FORMS["elliptic functions"]
    sphere = replace(still, body=Body(1.5, (0.3, 0.3, 0.3)))
    flight = truth_of_scene(still, TIMES).trajectory
    np.testing.assert_array_equal(truth_of_scene(sphere, TIMES).trajectory.quaternion, flight.quaternion)
    np.testing.assert_array_equal(truth_of_scene(turning, TIMES).trajectory.position, flight.position)
    in_place = replace(turning, gravity=0.0, initial=State(quaternion=(0.5, 0.5, -0.5, 0.5), angular_velocity=(1.0, -2.0, 3.0)))
    np.testing.assert_array_equal(
        truth_of_scene(in_place, TIMES).trajectory.quaternion, truth_of_scene(turning, TIMES).trajectory.quaternion
    )


@pytest.mark.parametrize("name", FORMS)
def test_drag_that_is_nothing_changes_the_truth_by_less_than_the_bounds(name: str) -> None:
    """1e-300 kg/m is below every rounding, but the translation is computed otherwise."""
    without, dragged = (truth_of_scene(scene, TIMES) for scene in (FORMS[name], replace(FORMS[name], drag=1e-300)))
    assert dragged.model != without.model
    apart = distance(without.trajectory.position, dragged.trajectory.position)
    assert (apart <= without.bounds.position_error + dragged.bounds.position_error).all()
    np.testing.assert_array_equal(without.trajectory.quaternion, dragged.trajectory.quaternion)


@pytest.mark.parametrize("case", ["sliding-brick", "sliding-brick-slippery"])
def test_a_slide_solved_as_if_it_span_is_the_straight_one(case: str) -> None:
    scene, times = load(case).scene, load(case).instants
    assert scene.plane is not None
    found = slide(scene, times)
    one, other = (motion.rows[:, :2] for motion in coupled(scene, scene.plane, planar_state(scene), times))
    own_bound = 2 * np.maximum.accumulate(np.hypot(*(one - other).T)) + found.position_error
    assert (np.hypot(*(one - found.trajectory.position[:, :2]).T) <= own_bound + found.position_error).all()


def test_where_no_integration_can_follow_other_ways_stand_in() -> None:
    def refuse(*_: Any) -> Any:
        raise OutOfReach("too many steps")

    scene = FORMS["symmetric top"]
    found = truth_of_scene(scene, TIMES, Backend("none", refuse, refuse))
    assert [name.partition(",")[0] for name in found.witnesses] == [CLOSED_FORM_NAME.partition(",")[0], "parabola"]
    np.testing.assert_array_equal(found.bounds.error, closed_form.flight(scene, TIMES).bounds.error)


def test_a_truth_that_is_not_vouched_for_is_the_closed_form_alone() -> None:
    scene = FORMS["symmetric top"]
    found = truth_of_scene(scene, TIMES, vouched=False)
    assert found.witnesses == ()
    np.testing.assert_array_equal(found.bounds.error, closed_form.flight(scene, TIMES).bounds.error)


def test_drag_is_computed_only_where_something_moves() -> None:
    spinning = replace(FORMS["symmetric top"], gravity=0.0, initial=State(angular_velocity=(1.0, 2.0, 3.0)), drag=0.1)
    assert truth_of_scene(spinning, TIMES).model == "closed form: symmetric top"
    assert not translation(spinning, TIMES).position.any()


@pytest.mark.parametrize("shape", [BRICK, DISK])
@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize(("velocity", "spin"), [((2.0, 1.0), 0.0), ((0.0, 0.0), -7.0), ((0.0, 0.0), 0.0)])
def test_the_smallest_friction_is_the_whole_one(
    plane: Plane, shape: Brick | Cylinder, velocity: tuple[float, float], spin: float
) -> None:
    if plane.law == "corners" and shape is DISK:
        return
    scene = flat(velocity, spin, plane, shape)
    (small, apart), whole = smallest_friction(scene, plane), friction(scene.body, plane, scene.gravity)
    assert apart
    for part in (1.0, 0.3, 1e-6):
        motion = velocity[0] * part, velocity[1] * part, spin * part
        # Sums over the face and a linear system of three equations, in units of the weight times the reach.
        np.testing.assert_allclose(small(*motion), whole(*motion), rtol=0, atol=1e-13)


def test_a_body_that_slides_and_spins_has_the_whole_friction() -> None:
    motion = (2.0, 1.0, 3.0)
    for plane in PLANES:
        scene = flat(motion[:2], motion[2], plane)
        law, apart = smallest_friction(scene, plane)
        assert law(*motion) == friction(scene.body, plane, 9.81)(*motion)
        assert apart is (plane.law == "decoupled")
