"""Numbers that others published, reproduced."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bodycheck import Case, compare, load, simulate, truth
from bodycheck.reference.observables import observe
from tests.support import ROOT

ANCHORS = pd.read_csv(ROOT / "tests" / "data" / "osrf_boxes_complex_2015.csv", comment="#")
SCHEMES = {
    "ode": (("mujoco", "Euler"), ("pinocchio", "semi-implicit-euler")),
    "bullet": (("mujoco", "implicit"), ("mujoco", "implicitfast")),
}
QUANTITIES = ["position_error", "angular_momentum_drift", "energy_drift"]


def at_every_step(case: Case, timestep: float) -> Case:
    """The published errors are maxima over all steps."""
    return replace(case, samples=round(case.duration / timestep) + 1)


@pytest.mark.parametrize("timestep", [1e-3, 5e-4])
@pytest.mark.parametrize(("row", "method"), [(row, method) for row, methods in SCHEMES.items() for method in methods])
def test_the_integrator_explains_the_box_benchmark_of_2015(row: str, method: tuple[str, str], timestep: float) -> None:
    """ODE's rows are the semi-implicit Euler scheme's, Bullet's the linearly implicit one's."""
    case = at_every_step(load("osrf-boxes-complex"), timestep)
    measured = compare(truth(case), simulate(case, *method, timestep)).maxima()
    anchor = ANCHORS[(ANCHORS.engine == row) & np.isclose(ANCHORS.timestep, timestep)].iloc[0]
    # Published to six digits from C++ code with its own box inertia and rounding; two schemes differ by 5 per cent.
    np.testing.assert_allclose([measured[q] for q in QUANTITIES], anchor[QUANTITIES].astype(float), rtol=3e-4)


@pytest.mark.parametrize(
    ("method", "expected"),
    [
        (("mujoco", "Euler"), (0.0490, 0.01307, 0.01246)),
        (("mujoco", "implicit"), (0.0490, 0.01245, 0.01358)),
        (("mujoco", "implicitfast"), (0.0490, 0.01245, 0.01358)),
    ],
)
def test_box_benchmark_at_one_millisecond(method: tuple[str, str], expected: tuple[float, ...]) -> None:
    case = load("osrf-boxes-complex")
    measured = compare(truth(case), simulate(case, *method, 1e-3)).maxima()
    # Printed to four digits.
    np.testing.assert_allclose([measured[q] for q in QUANTITIES], expected, rtol=5e-4)


def test_pinocchio_semi_implicit_euler_equals_mujoco_euler_to_six_digits() -> None:
    case = load("osrf-boxes-complex")
    exact = truth(case)
    ours, theirs = (
        compare(exact, simulate(case, *method, 1e-3)).maxima()
        for method in (("pinocchio", "semi-implicit-euler"), ("mujoco", "Euler"))
    )
    names = [*QUANTITIES, "attitude_error", "angular_velocity_error", "rotational_energy_drift"]
    # Six digits, as the name says. The two programs of one scheme differ by rounding, 3e-9 of the errors.
    np.testing.assert_allclose([ours[q] for q in names], [theirs[q] for q in names], rtol=1e-6)


def test_the_naive_step_moves_the_centre_of_mass_by_17_metres() -> None:
    case = load("osrf-boxes-complex")
    measured = compare(truth(case), simulate(case, "pinocchio", "body-twist-euler", 1e-3)).maxima()
    assert measured["position_error"] == pytest.approx(17.3, abs=0.05)
    # What is wrong is the translation alone.
    euler = compare(truth(case), simulate(case, "mujoco", "Euler", 1e-3)).maxima()
    assert measured["attitude_error"] == pytest.approx(euler["attitude_error"], rel=1e-6)


@pytest.mark.parametrize(
    ("integrator", "ratio"),
    [("Euler", 1.086895), ("implicit", 0.926008), ("implicitfast", 0.926008), ("RK4", 1.000000)],
)
def test_energy_after_mujocos_own_test(integrator: str, ratio: float) -> None:
    case = load("mujoco-free-body")
    energy = observe(case.scene, simulate(case, "mujoco", integrator, 0.01).outcome.trajectory).total_energy
    # Printed with six decimals.
    assert energy[-1] / energy[0] == pytest.approx(ratio, abs=5e-7)


@pytest.mark.parametrize(("engine", "integrator"), [("mujoco", "RK4"), ("pinocchio", "rk4")])
def test_rounding_of_the_flight_turns_the_brick_of_nasa(engine: str, integrator: str) -> None:
    """The torque v x m v is zero, but not after m v is rounded. A mass that is a power of two does not round it."""

    def rates_off_by(case: Case) -> float:
        return compare(truth(case), simulate(case, engine, integrator, 0.01)).maxima()["angular_velocity_error"]

    case = load("nesc-tumbling-brick")
    scene = case.scene
    still = replace(case, scene=replace(scene, gravity=0.0, initial=replace(scene.initial, velocity=(0.0, 0.0, 0.0))))
    of_2_kg = replace(case, scene=replace(scene, body=replace(scene.body, mass=2.0)))
    # The classical Runge-Kutta scheme's 3.3e-10 deg/s; in flight it was 3.8e-9 rad/s or more, from rounding alone.
    assert rates_off_by(still) == pytest.approx(5.7e-12, rel=0.02)
    assert rates_off_by(of_2_kg) == pytest.approx(5.7e-12, rel=0.02)
    assert rates_off_by(case) > 1e-10
