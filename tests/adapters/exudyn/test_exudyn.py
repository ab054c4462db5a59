"""What is special about Exudyn: the orders of its solvers, its formulations of rotation, its own loop, and its contacts."""

import math
from dataclasses import replace

import exudyn
import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters.contract import EngineDiverged, ErrorControlled, Method, SceneUnsupported
from bodycheck.adapters.exudyn import contact, stepping
from bodycheck.adapters.exudyn import engine as adapter
from bodycheck.adapters.stepping import Normalised
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth

FLIGHT, DRAG, BRICK = (load(name).scene for name in ("osrf-boxes-complex", "football-drag", "sliding-brick"))


def end(scene: Scene, method: str, timestep: float, steps: int) -> Array:
    return adapter.prepare([scene], Method.parse(method, timestep)).advance(np.array([steps]))[0, 0, 0]


@pytest.mark.parametrize(
    ("method", "order", "steps"),
    [
        ("ExplicitEuler", 1, 800),
        ("ExplicitMidpoint", 2, 200),
        ("RK33", 3, 100),
        ("ODE23", 3, 100),
        ("RK44", 4, 50),
        ("RK44:formulation=Rxyz", 4, 100),
        ("DOPRI5", 5, 25),
        ("RK67", 6, 25),
        ("VelocityVerlet", 1, 800),
        ("GeneralizedAlpha", 2, 100),
        ("GeneralizedAlpha:settings=engine", 2, 100),
        ("GeneralizedAlpha:formulation=EP", 2, 100),
        ("GeneralizedAlpha:formulation=Rxyz", 2, 100),
        ("TrapezoidalIndex2", 2, 100),
    ],
)
def test_attitudes_in_a_flight_with_drag_converge_with_the_order_of_the_solver(method: str, order: int, steps: int) -> None:
    exact = truth(DRAG, np.array([0.0, 0.5])).trajectory
    errors = [
        geodesic_angle(end(DRAG, method, 0.5 / number, number)[3:7], exact.quaternion[-1])
        for number in (steps, 2 * steps, 4 * steps)
    ]
    # The steps are such that the errors are above rounding, and the next term of the error is small.
    np.testing.assert_allclose(np.log2(errors[:-1]) - np.log2(errors[1:]), order, atol=0.15)


@pytest.mark.parametrize(("method", "order"), [("RK33", 3), ("RK44", 4)])
def test_drag_is_evaluated_in_every_stage(method: str, order: int) -> None:
    """A force that is held over a step would make the order of the position 1."""
    exact = truth(DRAG, np.array([0.0, 0.5])).trajectory
    errors = [float(np.linalg.norm(end(DRAG, method, 0.5 / steps, steps)[:3] - exact.position[-1])) for steps in (4, 8, 16)]
    np.testing.assert_allclose(np.log2(errors[:-1]) - np.log2(errors[1:]), order, atol=0.2)


@pytest.mark.parametrize("method", ["RK44", "GeneralizedAlpha:settings=engine"])
@pytest.mark.parametrize("scene", [FLIGHT, BRICK])
def test_the_loop_over_strides_is_exudyns_own(scene: Scene, method: str) -> None:
    """Its function `SolveDynamic` with its own settings, but for those that a fixed step and no files need."""
    steps, timestep = 600, 1e-3
    own = adapter.model(scene, Method.parse(method, timestep)).stepper
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, steps * timestep
    kind = exudyn.DynamicSolverType.RK44 if method == "RK44" else exudyn.DynamicSolverType.GeneralizedAlpha
    own.system.SolveDynamic(settings, solverType=kind)
    data = own.system.systemData
    theirs = np.concatenate([data.GetODE2Coordinates(), data.GetODE2Coordinates_t()])
    here = adapter.model(scene, Method.parse(method, timestep)).stepper
    here.advance(np.array([100, 0, 500]))
    data = here.system.systemData
    ours = np.concatenate([data.GetODE2Coordinates(), data.GetODE2Coordinates_t()])
    # Explicit steps differ by the rounding of the time step, which Exudyn gets from a sum. Modified Newton begins again with
    # each stride, and stops at another error below the tolerance 1e-8 of each step.
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 if method == "RK44" else 2e-5)


def test_angles_meet_gimbal_lock_and_the_other_formulations_do_not() -> None:
    exact = truth(FLIGHT, np.array([0.0, 1.0])).trajectory.quaternion[-1]
    errors = [geodesic_angle(end(FLIGHT, f"RK44{own}", 2e-3, 500)[3:7], exact) for own in ("", ":formulation=Rxyz")]
    # At 2 ms and 5 rad/s; the angles pass within a degree of gimbal lock.
    assert errors[0] < 1e-9
    assert not errors[1] < 1e-2
    locked = replace(FLIGHT, initial=State(quaternion=(math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)))
    with pytest.raises(SceneUnsupported, match="gimbal lock"):
        end(locked, "RK44:formulation=Rxyz", 1e-3, 1)


def test_a_solver_that_stops_is_a_divergence_with_its_states() -> None:
    with pytest.raises(EngineDiverged, match=r"Exudyn's solver fails: .*reduction of step size") as caught:
        end(FLIGHT, "GeneralizedAlpha:formulation=Rxyz", 4e-3, 250)
    assert caught.value.states.shape == (1, 1, 1, 13)
    assert np.isfinite(caught.value.states).all()


@pytest.mark.parametrize(
    ("method", "least", "most"),
    [("GeneralizedAlpha:settings=engine", 0.0, 1e-14), ("TrapezoidalIndex2:formulation=EP", 1e-10, 1e-5)],
)
def test_the_norm_of_euler_parameters_is_kept_or_its_rate_is(method: str, least: float, most: float) -> None:
    simulation = adapter.prepare([FLIGHT], Method.parse(method, 2e-3))
    assert isinstance(simulation, Normalised)
    simulation.advance(np.array([500]))
    # A norm that is solved for is off by rounding; the drift of the other is of the error of the step.
    assert least <= simulation.quaternion_norm_error <= most


@pytest.mark.parametrize("method", ["RK44", "GeneralizedAlpha"])
def test_a_brick_sinks_in_as_the_contacts_are_stiff_and_loses_speed_by_friction(method: str) -> None:
    timestep, steps = 1e-3, 200
    row = end(BRICK, method, timestep, steps)
    plane = BRICK.plane
    assert plane is not None
    rate = 1 / max(contact.TIME_CONSTANT_S, contact.STEPS_IN_TIME_CONSTANT * timestep)
    # Fifty time constants after the start the brick has settled; it still slides.
    assert 0.05 - row[2] == pytest.approx(BRICK.gravity / rate**2, rel=1e-6)
    assert 2.0 - row[7] == pytest.approx(plane.friction * BRICK.gravity * timestep * steps, rel=1e-6)


def test_a_cylinder_has_no_contacts() -> None:
    with pytest.raises(SceneUnsupported, match=r"corners, which .*cylinder does not have"):
        end(load("curling-disk").scene, "RK44", 1e-3, 1)


@pytest.mark.parametrize(("method", "order"), [("ODE23", 3), ("DOPRI5", 5)])
def test_solvers_with_an_estimate_control_their_error_and_count_their_steps(method: str, order: int) -> None:
    """The work of a hundredth of the tolerance grows as the order of the solver says."""
    exact, steps, errors = truth(FLIGHT, np.array([0.0, 1.0])).trajectory.quaternion[-1], [], []
    for accuracy in ("1e-6", "1e-8"):
        simulation = adapter.prepare([FLIGHT], Method.parse(f"{method}:accuracy={accuracy}", 1.0))
        assert isinstance(simulation, ErrorControlled)
        errors.append(geodesic_angle(simulation.reach(np.array([1.0]))[0, 0, 0, 3:7], exact))
        steps.append(simulation.work.steps)
    assert errors[1] < errors[0] < 1e-3
    # The estimate has the order of the solver; a step is at most a fifth longer or shorter than it says.
    assert steps[1] / steps[0] == pytest.approx(100 ** (1 / order), rel=0.2)


def test_samples_end_steps_with_error_control_and_change_no_more() -> None:
    """The state at a sample is that of the time, and control goes on with the last step."""
    method, times = Method.parse("DOPRI5:accuracy=1e-8", 1.0), np.linspace(0.0, 1.0, 11)
    exact = truth(FLIGHT, times).trajectory
    simulation = adapter.prepare([FLIGHT], method)
    assert isinstance(simulation, ErrorControlled)
    rows = simulation.reach(times)[0, :, 0]
    assert geodesic_angle(rows[:, 3:7], exact.quaternion).max() < 1e-6
    np.testing.assert_allclose(rows[:, :3], exact.position, rtol=0, atol=1e-7)  # a parabola, and rounding of the end time
    free = adapter.prepare([FLIGHT], method)
    assert isinstance(free, ErrorControlled)
    free.reach(times[-1:])
    assert free.work.steps < simulation.work.steps < free.work.steps + 3 * len(times)


def test_the_engines_own_settings_are_those_of_exudyn() -> None:
    """Only the step and what is written differ from the settings that a user gets."""
    defaults, plain = exudyn.SimulationSettings().timeIntegration, Method.parse("GeneralizedAlpha:settings=engine", 1e-3)
    here = stepping.settings(plain, constrained=True).timeIntegration
    assert here.newton.useModifiedNewton == defaults.newton.useModifiedNewton
    assert here.adaptiveStep == defaults.adaptiveStep
    assert here.generalizedAlpha.spectralRadius == defaults.generalizedAlpha.spectralRadius
