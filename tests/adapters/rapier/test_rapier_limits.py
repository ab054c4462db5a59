"""Stops of joints in Rapier, which takes no efforts at joints."""

import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms.control import Stops
from tests.support.driven_hinge import PD, hinge
from tests.support.driven_runs import joints_after, landing, slide

RAPIER = registry.load("rapier")
SPELLINGS = ["symplectic-euler", "symplectic-euler:settings=engine"]


@pytest.mark.parametrize("spelling", SPELLINGS)
@pytest.mark.parametrize("stops", [Stops(-0.1, None), Stops(-0.1, 0.5)])
def test_a_limit_holds_a_slide(spelling: str, stops: Stops) -> None:
    """A step moves the body by 1.9 mm when it lands."""
    most, last, speed = landing(RAPIER, spelling, 0.001, slide(stops, driven=False))
    assert most < 0.003
    assert abs(last) < 1e-3
    assert abs(speed) < 1e-2


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_a_limit_holds_a_hinge(spelling: str) -> None:
    stopped = hinge(stops=Stops(-3.0, 0.1), rate=2.0)
    position, velocity = joints_after(RAPIER, stopped, spelling, 0.001, [0.0, 0.1, 0.2])
    assert abs(position[1:, 0] - 0.1).max() < 0.003
    assert abs(velocity[1:, 0]).max() < 1e-2


def test_efforts_are_not_modelled() -> None:
    assert (
        offers.not_modelled(RAPIER.engine, hinge(PD), Method.parse("symplectic-euler", 0.001)) == "does not model controllers"
    )
