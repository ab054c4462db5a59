"""Driven joints in Newton: forces of the control, and limits of joints."""

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.mechanisms.control import Stops
from bodycheck.reference.scene import Vector
from tests.support.coupled_runs import orders
from tests.support.driven_hinge import PD, hinge
from tests.support.driven_runs import arm_errors, landing, sampled_error, slide, turned_against_a_stop

NEWTON = registry.load("newton")


@pytest.mark.parametrize("spelling", ["Featherstone", "XPBD", "Steel", "MuJoCo-euler"])
def test_a_sampled_law_converges_with_the_order_of_the_scheme(spelling: str) -> None:
    errors = np.array([sampled_error(NEWTON, spelling, step) for step in (0.002, 0.001)])
    assert orders(errors) == pytest.approx([1], abs=0.2)


def test_a_sampled_law_is_exact_to_single_precision() -> None:
    assert sampled_error(NEWTON, "MuJoCo-rk4", 0.002) < 1e-5
    assert arm_errors(NEWTON, "MuJoCo-rk4", 100.0, (0.0025,)).max() < 1e-5


@pytest.mark.parametrize("spelling", ["Featherstone", "Steel"])
def test_an_arm_is_driven_with_the_order_of_the_scheme(spelling: str) -> None:
    errors = arm_errors(NEWTON, spelling, 100.0, (0.0025, 0.00125))
    assert orders(errors) == pytest.approx([1], abs=0.2)
    assert errors[-1] < 1e-2


@pytest.mark.parametrize("spelling", ["Steel", "XPBD:relaxation=1"])
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.0, 0.6, 0.8)])
def test_a_rigid_limit_holds_a_slide(spelling: str, axis: Vector) -> None:
    """To single precision: a step ends at the limit."""
    most, last, speed = landing(NEWTON, spelling, 0.001, slide(Stops(-0.1, None), axis))
    assert most < 1e-5
    assert abs(last) < 1e-5
    assert abs(speed) < 1e-2


@pytest.mark.parametrize("spelling", ["Steel", "XPBD:relaxation=1"])
def test_a_rigid_limit_holds_a_hinge(spelling: str) -> None:
    angle, rate = turned_against_a_stop(NEWTON, spelling, 0.001, Stops(-4.0, 0.1))
    assert angle.max() < 0.1 + 1e-5
    assert abs(rate[-1]) < 1e-5


@pytest.mark.parametrize(("spelling", "pull"), [("Featherstone", 0.2), ("MuJoCo-rk4", 0.05), ("MuJoCo-euler", 1e-3)])
def test_elastic_limits(spelling: str, pull: float) -> None:
    """Featherstone's limit also pulls a joint that returns; MuJoCo's does not, and RK4 evaluates it at the stages."""
    most, last, speed = landing(NEWTON, spelling, 0.001, Stops(-0.1, None, None, 2000.0, 100.0))
    assert most < 0.025  # the weight less the effort, 11.7 N, bends the stop by 5.85 mm at rest
    assert abs(last) < 6e-3
    assert abs(speed) < 1e-2
    stops = Stops(-4.0, 0.1, None, 40.0, 0.3)
    (_, own), (_, given) = (
        turned_against_a_stop(NEWTON, method, 0.0005, stops) for method in (spelling, f"{spelling}:limits=effort")
    )
    assert np.abs(own - given).max() < pull


@pytest.mark.parametrize(
    ("spelling", "stops", "reason"),
    [
        ("Featherstone", Stops(-1.0, 1.1), "Featherstone has no rigid stops"),
        ("Steel", Stops(-1.0, 1.1, None, 40.0, 1.0), "Steel has no elastic stops"),
        ("Steel", Stops(-1.0, 1.1, 0.5), "no rebound"),
        ("MuJoCo-rk4", Stops(-1.0, 1.1, None, 40.0), "no limit without damping"),
    ],
)
def test_what_a_solver_lacks_is_refused(spelling: str, stops: Stops, reason: str) -> None:
    with pytest.raises(SceneUnsupported, match=reason):
        offers.prepare(NEWTON, [hinge(PD, stops=stops)], Method.parse(spelling, 0.001))
