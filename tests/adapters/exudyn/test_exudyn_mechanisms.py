"""What is special about mechanisms in Exudyn: trees that all solvers step, constraints, and regularised friction."""

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.exudyn import stepping
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array
from tests.support.coupled_joints import hip
from tests.support.coupled_runs import errors, orders
from tests.support.jointed import ball_chain, cart_pole, coordinate, four_bar, on_one_joint, trajectory
from tests.support.orders import observed_mechanism_order

EXUDYN = registry.load("exudyn")

#: Explicit solvers: the steps are so large that the errors of the best ones are above rounding, and orders are seen.
CLAIMED = {"ExplicitEuler": 1, "ExplicitMidpoint": 2, "RK33": 3, "RK44": 4, "ODE23": 3, "DOPRI5": 5, "RK67": 6}


def moved(mechanism: Mechanism, spelling: str, timestep: float, *strides: int) -> tuple[Array, Array]:
    """Coordinates and velocities of one joint after so many steps."""
    simulation = EXUDYN.prepare([mechanism], Method.parse(spelling, timestep))
    return coordinate(mechanism, simulation.advance(np.array(strides)))


@pytest.mark.parametrize("spelling", [*CLAIMED, "GeneralizedAlpha", "TrapezoidalIndex2"])
def test_a_tree_has_the_order_of_its_solver(spelling: str) -> None:
    claimed = CLAIMED.get(spelling, 2)
    coarse = 0.04 if claimed > 3 else 4e-3
    observed = observed_mechanism_order(EXUDYN, cart_pole(), spelling, (coarse, coarse / 2, coarse / 4), 0.8)
    # The next term of the error changes the order by the step times a rate of some per second, more so at a high order.
    assert observed == pytest.approx({"position": claimed, "attitude": claimed}, rel=0.15)


def test_velocity_verlet_is_of_first_order_where_forces_depend_on_velocities() -> None:
    observed = observed_mechanism_order(EXUDYN, cart_pole(), "VelocityVerlet", (4e-3, 2e-3, 1e-3), 0.8)
    assert observed == pytest.approx({"position": 1, "attitude": 1}, abs=0.15)


@pytest.mark.parametrize("spelling", ["TrapezoidalIndex2", "GeneralizedAlpha", "GeneralizedAlpha:settings=engine"])
def test_constraints_on_balls_are_of_second_order(spelling: str) -> None:
    observed = observed_mechanism_order(EXUDYN, ball_chain(), spelling, (4e-3, 2e-3, 1e-3), 0.2)
    # Newton's method ends at changes that limit errors to some 1e-6; these are 1e-5 and more.
    assert observed == pytest.approx({"position": 2, "attitude": 2}, abs=0.1)


def test_generalized_alpha_has_numerical_damping_where_exudyn_requires_it() -> None:
    """Exudyn's documentation requires a spectral radius below 1 for constraints on positions, and its default is 0.9."""
    alpha = Method.parse("GeneralizedAlpha", 1e-3)
    radii = [
        stepping.settings(alpha, constrained).timeIntegration.generalizedAlpha.spectralRadius for constrained in (True, False)
    ]
    assert radii == [0.9, 1.0]


def test_generalized_alpha_steps_a_loop_with_order_2() -> None:
    """Without numerical damping, Newton's method fails on this case."""
    scene = load("slider-crank").scene
    assert isinstance(scene, Mechanism)
    observed = observed_mechanism_order(EXUDYN, scene, "GeneralizedAlpha", (4e-3, 2e-3, 1e-3), 1.0)
    # Newton's method ends at changes that limit errors to some 1e-6; these are 1e-5 and more.
    assert observed == pytest.approx({"position": 2, "attitude": 2}, abs=0.1)


@pytest.mark.parametrize("type", ["revolute", "prismatic"])
@pytest.mark.parametrize("spelling", ["RK44", "GeneralizedAlpha"])
def test_armature_is_inertia(type: str, spelling: str) -> None:
    """One newton on 1 kg and 3 kg of armature: the velocity is t / 4."""
    _, velocity = moved(on_one_joint(type, 0.0, 0.0, armature=3.0, effort=1.0), spelling, 0.1, 10)  # type: ignore[arg-type]
    assert velocity[0] == pytest.approx(0.25, abs=1e-9)  # Newton's method


@pytest.mark.parametrize("spelling", ["RK44", "GeneralizedAlpha"])
def test_dry_friction_stops_a_joint_and_lets_it_creep_under_load(spelling: str) -> None:
    h, friction = 0.01, 0.5
    place, velocity = moved(on_one_joint("prismatic", 0.0, 1.0, friction=friction), spelling, h, 300)
    zone = 2 * h * friction
    # It stops at v0^2 / (2 f), but for the last part of the way, below the speed of the zone.
    assert place[0] == pytest.approx(1 / (2 * friction), abs=zone**2 / friction)
    assert velocity[0] == pytest.approx(0, abs=1e-6)
    _, creeping = moved(on_one_joint("prismatic", 0.0, 0.0, friction=friction, effort=0.8 * friction), spelling, h, 300)
    assert creeping[0] == pytest.approx(0.8 * zone, rel=1e-6)


def test_a_loop_is_closed_on_positions_or_on_velocities() -> None:
    apart = {}
    for spelling, timestep in (("GeneralizedAlpha", 2e-3), ("TrapezoidalIndex2", 2e-3), ("TrapezoidalIndex2", 1e-3)):
        strides = np.full(5, round(0.1 / timestep))
        states = EXUDYN.prepare([four_bar()], Method.parse(spelling, timestep)).advance(strides)
        apart[spelling, timestep] = kinematics.gaps(four_bar(), trajectory(np.cumsum(strides) * timestep, states)).max()
    # Newton's method makes the gap as small as it can; on velocities it grows by the square of the step.
    assert apart["GeneralizedAlpha", 2e-3] < 1e-10
    assert apart["TrapezoidalIndex2", 2e-3] / apart["TrapezoidalIndex2", 1e-3] == pytest.approx(4, rel=0.05)


def test_explicit_solvers_refuse_constraints() -> None:
    with pytest.raises(SceneUnsupported, match="contains constraints"):
        EXUDYN.prepare([ball_chain()], Method.parse("RK44", 1e-3))


@pytest.mark.parametrize(("spelling", "order", "limit"), [("RK44", 4, 1e-9), ("GeneralizedAlpha", 2, 1e-4)])
def test_several_joints_of_a_body_converge_to_the_truth(spelling: str, order: int, limit: float) -> None:
    """A frame without mass that is fixed to another one is part of its link."""
    sizes = errors(EXUDYN, hip(), spelling)
    assert orders(sizes) == pytest.approx([order] * 2, abs=0.2)
    assert sizes[-1] < limit
