"""Witnesses: they agree with the truth within their bounds, and what they cost is known before."""

import numpy as np
import pytest

from bodycheck import Case, load
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.start import start
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.truth import computed
from bodycheck.reference.witness import angle_between
from bodycheck.reference.witnesses import FARTHEST_RAD, Backend, backend, course, dop853, wide_witness, witnesses

TIMES = np.linspace(0, 10, 101)
TUMBLE = Scene(
    Body(1.0, (0.3, 0.45, 0.6), axes=(0.5, 0.1, -0.7, 0.5)),
    State(velocity=(1.0, 2.0, 3.0), angular_velocity=(2.0, 3.0, -4.0)),
    gravity=9.81,
)

#: A spin about the middle axis that misses the separatrix by 1e-14: rounding is amplified 1e28 times.
NEAR_SEPARATRIX = Scene(Body(1.0, (0.3, 0.45, 0.6)), State(angular_velocity=(1e-14, 3.0, 1e-14)))


@pytest.mark.parametrize("hours", [0, 1])
def test_no_witness_contradicts_the_truth_of_a_flying_case(flying_case: Case, hours: int) -> None:
    times = flying_case.instants + 3600 * hours
    found = computed(flying_case.scene, times)
    assert found.witnesses
    for name in ("error", "angular_velocity_error", "position_error", "velocity_error"):
        if not flying_case.scene.drag:
            np.testing.assert_array_equal(getattr(found.truth.bounds, name), getattr(found.own_bounds, name))


@pytest.mark.parametrize("solver", [backend(), dop853()], ids=lambda solver: solver.name)
def test_every_state_has_a_witness(solver: Backend) -> None:
    ways = witnesses(TUMBLE, TIMES, solver)
    for state in ("quaternion", "angular_velocity", "position", "velocity"):
        assert any(getattr(way, state) is not None for way in ways), state
    at_rest = Scene(TUMBLE.body, State(quaternion=(0.6, 0.0, 0.8, 0.0)), gravity=9.81)
    (still,) = witnesses(at_rest, TIMES, solver)
    assert still.quaternion is not None
    assert angle_between(still.quaternion, np.array([[0.6, 0.0, 0.8, 0.0]])).max() < 1e-15


def test_what_lasts_longer_than_a_period_is_integrated_for_one() -> None:
    short, long = (course(start(TUMBLE), TIMES * factor) for factor in (0.01, 1e5))
    assert not short.repeats
    assert long.repeats
    assert long.turning == long.speed * float(long.period)
    assert long.turning < FARTHEST_RAD < long.speed * 1e6
    assert (np.diff(long.growth) > 0).all()


def test_where_rounding_would_grow_too_large_nothing_is_integrated() -> None:
    for solver in (backend(), dop853()):
        for way in (solver.euler_lagrange, solver.quasi_coordinates):
            with pytest.raises(OutOfReach, match="rounding would grow too large"):
                way(NEAR_SEPARATRIX, TIMES * 5)
        names = [way.name.partition(",")[0] for way in witnesses(NEAR_SEPARATRIX, TIMES * 5, solver)]
        assert names == ["second closed form", "parabola"]


def test_too_far_a_turn_is_not_integrated() -> None:
    """A nearly spherical body, whose polhode takes some 1e6 turns."""
    sphere = Scene(Body(1.0, (1.0, 1.0 + 1e-6, 1.0 + 3e-6)), State(angular_velocity=(2.0, 3.0, -4.0)))
    with pytest.raises(OutOfReach, match="300 rad are the limit"):
        backend().euler_lagrange(sphere, TIMES * 100)


def test_a_wide_witness_says_its_digits_and_is_as_accurate() -> None:
    pytest.importorskip("heyoka")
    case = load("intermediate-axis-flip")
    one, other = (wide_witness(case.scene, case.instants, bits) for bits in (100, 128))
    assert (one.digits, other.digits) == (30, 39)
    assert one.quaternion is not None
    assert other.quaternion is not None
    # Both are rounded to 80 bits at the end, where their bounds say so.
    assert (angle_between(one.quaternion, other.quaternion) <= one.error + other.error).all()
    assert np.max(one.error) < 1e-18


@pytest.mark.parametrize("seed", range(8))
def test_the_bound_of_a_witness_covers_its_error(seed: int) -> None:
    """Against 160 bits, for any body in any frame that turns by up to 1e4 rad."""
    pytest.importorskip("heyoka")
    rng = np.random.default_rng(seed)
    a, b, c = 10 ** rng.uniform(-1.8, 0, 3)
    axes, attitude = (tuple((parts / np.linalg.norm(parts)).tolist()) for parts in rng.normal(size=(2, 4)))
    rates = rng.normal(size=3) * 10 ** rng.uniform(-1, 2)
    p, q, r = rates.tolist()
    body = Body(1.0, (float(b + c), float(c + a), float(a + b)), axes=axes)
    scene = Scene(body, State(quaternion=attitude, angular_velocity=(p, q, r)))
    times = np.linspace(0, 10 ** rng.uniform(0, 4) / np.linalg.norm(rates), 11)
    if course(start(scene), times).turning > 50:
        return  # 160 bits would take long
    exact = wide_witness(scene, times, 160)
    for way in (backend().euler_lagrange, backend().quasi_coordinates):
        found = way(scene, times)
        assert found.quaternion is not None
        assert exact.quaternion is not None
        assert (angle_between(found.quaternion, exact.quaternion) <= found.error + exact.error).all()
        assert found.angular_velocity is not None
        assert exact.angular_velocity is not None
        apart = np.sqrt(((found.angular_velocity - exact.angular_velocity) ** 2).sum(axis=1))
        assert (apart <= found.angular_velocity_error + exact.angular_velocity_error).all()


def test_many_instants_are_left_to_the_second_closed_form_where_each_costs_a_step(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, times = load("free-brick").scene, np.linspace(0.0, 0.1, 11)
    monkeypatch.setattr("bodycheck.reference.witnesses.DOP853_INSTANTS", 10)
    assert [witness.name for witness in witnesses(scene, times, dop853())] == ["second closed form, numpy", "parabola, numpy"]
    assert len(witnesses(scene, times[1:], dop853())) > 2
