"""The truth: its witnesses agree, it conserves what mechanics conserves, and no attitude is out of its reach."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck import Case, load
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.flight import closed_form
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.integration import dop853 as integration
from bodycheck.reference.integration import lagrangian
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.truth import truth
from bodycheck.reference.witness import angle_between
from bodycheck.reference.witnesses import Backend, backend, dop853
from tests.support.cases import shortened

try:
    from bodycheck.reference.integration import taylor
except ImportError:
    taylor = None  # where heyoka is not installed

TIMES = np.linspace(0, 2, 21)


BACKENDS = {solver.name: solver for solver in (dop853(), backend())}


@pytest.fixture(params=BACKENDS)
def solver(request: pytest.FixtureRequest) -> Backend:
    """SciPy's DOP853, and heyoka's 80-bit Taylor series where it is installed."""
    return BACKENDS[request.param]


def disagreement(solver: Backend, scene: Scene, times: np.ndarray) -> np.ndarray:
    one, other = solver.euler_lagrange(scene, times).quaternion, solver.quasi_coordinates(scene, times).quaternion
    assert one is not None
    assert other is not None
    return angle_between(one, other)


def test_two_ways_agree_to_1e_11_at_one_second(flying_case: Case, solver: Backend) -> None:
    times = flying_case.instants
    if not any(flying_case.scene.initial.angular_velocity):
        return  # nothing is integrated
    apart = disagreement(solver, flying_case.scene, times)
    assert apart[times <= 1.0].max() <= 1e-11


def test_the_bound_is_that_of_the_closed_form_and_not_of_its_witnesses(flying_case: Case, solver: Backend) -> None:
    found = truth(flying_case.scene, flying_case.instants, solver)
    alone = closed_form.flight(flying_case.scene, flying_case.instants)
    np.testing.assert_array_equal(found.bounds.error, alone.bounds.error)
    assert found.witnesses


def test_energy_and_angular_momentum_are_conserved(conservative_case: Case, solver: Backend) -> None:
    found = truth(conservative_case.scene, conservative_case.instants, solver)
    seen = observe(conservative_case.scene, found.trajectory)
    scale = seen.kinetic_energy.max()
    # DOP853 at its tightest loses some 1e-14 a radian of turn; these cases turn by up to 100 rad.
    np.testing.assert_allclose(seen.total_energy, seen.total_energy[0], rtol=0, atol=1e-11 * scale)
    size = np.linalg.norm(seen.angular_momentum[0])
    assert np.linalg.norm(seen.angular_momentum - seen.angular_momentum[0], axis=1).max() <= 1e-11 * size


def test_translation_is_the_parabola(conservative_case: Case) -> None:
    scene, t = conservative_case.scene, conservative_case.instants[:, None]
    fall = np.array([0, 0, -scene.gravity])
    expected = np.array(scene.initial.position) + np.array(scene.initial.velocity) * t + fall * t * t / 2
    found = truth(scene, conservative_case.instants)
    apart = np.linalg.norm(found.trajectory.position - expected, axis=1)
    # Some roundings of the farthest that the body comes, on either side.
    assert apart.max() <= 1e-13 * (1 + np.abs(expected).max())
    assert (apart <= found.bounds.position_error + 1e-13).all()


def brick(semi_axes: tuple[float, float, float]) -> Body:
    return Body(1.0, principal_moments(Brick(semi_axes), 1.0))


def test_starts_at_the_singularity(solver: Backend) -> None:
    scene = Scene(brick((0.1, 0.2, 0.3)), State(angular_velocity=(0.5, -0.3, 5.0)))
    # DOP853 at its tightest loses some 1e-14 a radian of turn, and this body turns by up to 50 rad.
    assert disagreement(solver, scene, TIMES).max() < 1e-12


def test_passes_through_the_singularity(solver: Backend) -> None:
    """A tumble about I carries K through the vertical four times, exactly."""
    scene = Scene(brick((0.1, 0.2, 0.3)), State(angular_velocity=(2 * np.pi, 0.0, 0.0)))
    found = truth(scene, TIMES, solver).trajectory
    expected = np.stack([np.cos(np.pi * TIMES), np.sin(np.pi * TIMES), 0 * TIMES, 0 * TIMES], axis=1)
    assert geodesic_angle(found.quaternion, expected).max() < 1e-13
    tumbling = Scene(brick((0.1, 0.2, 0.3)), State(angular_velocity=(6.0, 0.3, -0.2)))
    assert disagreement(solver, tumbling, TIMES).max() < 1e-12


def moments(shape: tuple[float, float, float]) -> Body:
    """A body from three weights: discs where one is zero, needles where one is nearly all, symmetric where two are equal."""
    a, b, c = (x + 1e-12 for x in shape)
    return Body(1.0, (b + c, c + a, a + b))


WEIGHT = st.one_of(st.floats(0.05, 1.0), st.sampled_from([0.0, 1e-6, 0.5, 0.5 + 1e-9, 1.0]))
SHAPE = st.tuples(WEIGHT, WEIGHT, WEIGHT).filter(lambda shape: sorted(shape)[1] > 1e-3)
ATTITUDE = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: float(np.linalg.norm(q)) > 0.1)
RATE = st.one_of(st.floats(1e-3, 5), st.floats(-5, -1e-3), st.sampled_from([0.0, 1e-8, 1e-100]))
SPIN = st.tuples(RATE, RATE, RATE)


@settings(max_examples=40)
@given(SHAPE, ATTITUDE, SPIN)
def test_any_body_attitude_and_tumble_agrees_to_the_bound(
    shape: tuple[float, float, float], quaternion: tuple[float, ...], spin: tuple[float, float, float]
) -> None:
    w, x, y, z = normalise(np.array(quaternion)).tolist()
    scene = Scene(moments(shape), State(quaternion=(w, x, y, z), angular_velocity=spin))
    for solver in BACKENDS.values():
        found = truth(scene, TIMES, solver)
        # Nothing grows in a closed form: 16 roundings in double precision.
        assert found.bounds.error.max() < 1e-14
        if taylor is not None:
            exact = taylor.euler_lagrange(scene, TIMES, "quadruple").quaternion
            assert (taylor.attitude_difference(found.trajectory.quaternion, exact) <= found.bounds.error).all()


def test_where_the_world_is_turned_the_motion_is_turned() -> None:
    """Without gravity no direction is special, but to the Euler angles they are: an independent check of every chart."""
    body, spin = brick((0.1, 0.3, 0.2)), (0.1, 1.0, 5.0)
    plain = lagrangian.integrate(Scene(body, State(angular_velocity=spin)), TIMES).angular_velocity
    for quaternion in ((0.5, 0.5, 0.5, 0.5), (0.0, 1.0, 0.0, 0.0), (0.6, 0.0, 0.8, 0.0), (0.6, 0.8, 0.0, 0.0)):
        turned = lagrangian.integrate(Scene(body, State(quaternion=quaternion, angular_velocity=spin)), TIMES)
        np.testing.assert_allclose(turned.angular_velocity, plain, rtol=0, atol=1e-12)


def test_instants_need_not_be_even_nor_start_at_zero() -> None:
    case = load("free-brick")
    all_of_them = truth(case.scene, np.array([0.0, 0.1, 0.1, 0.7, 1.3]))
    some = all_of_them.at(np.array([0.7]))
    # The closed form does not depend on the other instants: rounding, of which the reduction of angles may make some more.
    assert geodesic_angle(some.trajectory.quaternion[0], all_of_them.trajectory.quaternion[3]) < 1e-13
    assert all_of_them.at(all_of_them.trajectory.t) is all_of_them
    assert (np.diff(all_of_them.bounds.error) >= 0).all()


def test_a_body_at_rest_stays_at_rest() -> None:
    found = truth(Scene(brick((0.1, 0.2, 0.3)), State()), TIMES).trajectory
    assert not found.position.any()
    assert not found.angular_velocity.any()
    # The rounding of a quaternion.
    assert geodesic_angle(found.quaternion, np.array([1.0, 0, 0, 0])).max() < 1e-15


def test_what_is_not_modelled_is_named() -> None:
    sliding = load("sliding-brick").scene
    for scene, words in (
        (replace(sliding, drag=0.1), "drag on a body that slides"),
        (replace(sliding, body=replace(sliding.body, axes=(0.0, 1.0, 0.0, 0.0))), "principal axes"),
        (replace(sliding, plane=Plane(3.0, pressure="balanced")), "would tip"),
    ):
        with pytest.raises(NotModelled, match=words):
            truth(scene, TIMES)


def test_a_motion_that_takes_too_many_steps_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(integration, "MAX_STEPS", 20)
    case = shortened(load("free-brick"), 10.0, 11)
    with pytest.raises(integration.OutOfReach, match="more than 20 integration steps"):
        lagrangian.integrate(case.scene, case.instants)
