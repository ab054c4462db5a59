"""Figures of contact: of made-up motions whose figures are known, and of the engines."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bodycheck import CaseFaults, compare, load, simulate, truth
from bodycheck.casefile.case import parse
from bodycheck.figures import contact
from bodycheck.figures.definition import Comparison
from bodycheck.judging import judgement, result_set
from bodycheck.judging.attribution import Attribution, attribute
from bodycheck.reference.bounds import Bounds
from bodycheck.reference.contact_observables import penetration, tilt
from bodycheck.reference.planar import Stop
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.running.plan import plan
from tests.support import campaigns
from tests.support.campaigns import records
from tests.support.cases import shortened

BRICK = Body(1.0, (0.01, 0.01, 0.02), Brick((0.1, 0.2, 0.05)))
T = np.linspace(0, 1, 1001)


def moving(x: np.ndarray, vx: np.ndarray, yaw: np.ndarray, w: np.ndarray, z: float = 0.05, lean: float = 0.0) -> Trajectory:
    zero = np.zeros_like(T)
    quaternion = np.stack([np.cos(yaw / 2), zero + math.sin(lean / 2), zero, np.sin(yaw / 2)], axis=1)
    return Trajectory(
        T,
        np.stack([x, zero, zero + z], axis=1),
        quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True),
        np.stack([vx, zero, zero], axis=1),
        np.stack([zero, zero, w], axis=1),
    )


def slowed(rate: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Way and speed of something that slows evenly to a stop."""
    now = np.minimum(T, end)
    return rate * (now - now**2 / (2 * end)), np.maximum(rate * (1 - T / end), 0.0)


def stop_figures(scene: Scene, expected: Stop, trajectory: Trajectory) -> dict[str, float]:
    """The figures of the stop of a trajectory, by name, where the truth is the same motion with this stop."""
    zero = np.zeros(len(trajectory))
    compared = Comparison(
        Truth(scene, trajectory, Bounds(*[zero] * 6), "made up", "made up", "none", stop=expected), trajectory
    )
    values = {figure.name: figure.compute(compared) for figure in contact.STOP}
    return {name: value for name, value in values.items() if isinstance(value, float)}


def test_a_stop_between_samples_is_found_where_it_is() -> None:
    x, vx = slowed(2.0, 0.40775)
    found = stop_figures(Scene(BRICK, State()), Stop(0.40775, (0.40775, 0.0, 0.05), 0.0), moving(x, vx, 0 * T, 0 * T))
    # The stop is solved for from the samples around it: some roundings of a second and of a metre.
    assert found["stop_time_error"] < 1e-12
    assert found["stop_position_error"] < 1e-12
    assert found["creep"] == 0


def test_full_turns_count() -> None:
    yaw, w = slowed(40.0, 0.5)
    right, short = Stop(0.5, (0, 0, 0.05), 10.0), Stop(0.5, (0, 0, 0.05), 10.0 - 2 * math.pi)
    motion = moving(0 * T, 0 * T, yaw, w)
    # The sign of a quaternion says nothing.
    flipped = replace(motion, quaternion=motion.quaternion * np.where(np.arange(len(T)) % 7 < 3, 1, -1)[:, None])
    for seen in (motion, flipped):
        assert stop_figures(Scene(BRICK, State()), right, seen)["stop_yaw_error"] < 1e-12
        assert stop_figures(Scene(BRICK, State()), short, seen)["stop_yaw_error"] == pytest.approx(2 * math.pi)


def test_creep_is_the_speed_after_the_stop() -> None:
    x, vx = slowed(2.0, 0.5)
    creeping = moving(x + 1e-4 * np.maximum(T - 0.5, 0), vx + np.where(T > 0.5, 1e-4, 0), 0 * T, 0 * T)
    found = stop_figures(Scene(BRICK, State()), Stop(0.5, (0.5, 0.0, 0.05), 0.0), creeping)
    # A stop found a sample of a millisecond early would count the last 4 mm/s of the slowing as creep, forty times as much.
    assert found["creep"] == pytest.approx(1e-4, rel=1e-2)
    assert found["stop_time_error"] < 2e-3


def test_what_never_stops_stops_at_the_end_at_the_earliest() -> None:
    found = stop_figures(Scene(BRICK, State()), Stop(0.4, (0.4, 0, 0.05), 0.0), moving(2 * T, 0 * T + 2, 0 * T, 0 * T))
    assert found["stop_time_error"] == pytest.approx(0.6)
    assert found["stop_position_error"] == pytest.approx(1.6)


def test_depth_and_lean_of_the_lowest_corner() -> None:
    sunk = moving(0 * T, 0 * T, 0 * T, 0 * T, z=0.049)
    # A difference of 5 cm and 4.9 cm; of lengths of decimetres with sines of the angle: some roundings each.
    np.testing.assert_allclose(penetration(Scene(BRICK, State(), plane=Plane()), sunk), 1e-3, atol=1e-15)
    assert not penetration(Scene(BRICK, State(), plane=Plane()), moving(0 * T, 0 * T, 0 * T, 0 * T, z=0.06)).any()
    leaning = moving(0 * T, 0 * T, 0 * T, 0 * T, lean=0.1)
    np.testing.assert_allclose(tilt(leaning), 2 * math.atan(math.sin(0.05)), rtol=1e-12)
    angle = tilt(leaning)[0]
    np.testing.assert_allclose(
        penetration(Scene(BRICK, State(), plane=Plane()), leaning),
        0.2 * math.sin(angle) + 0.05 * (math.cos(angle) - 1),
        rtol=1e-12,
    )


@pytest.mark.parametrize("integrator", ["admm", "law-force"])
def test_pinocchio_converges_to_the_straight_slide_with_order_1(integrator: str) -> None:
    case = load("sliding-brick")
    exact = truth(case)
    assert exact.stop is not None
    # A closed form: some roundings.
    assert exact.stop.time == pytest.approx(2.0 / (0.5 * 9.81), rel=1e-15, abs=0)
    assert exact.stop.position[0] == pytest.approx(2.0**2 / (2 * 0.5 * 9.81), rel=1e-15, abs=0)
    errors = [
        compare(exact, simulate(case, "pinocchio", integrator, h)).maxima()["stop_position_error"] for h in (2e-3, 1e-3, 5e-4)
    ]
    # The terms of second order are some thousandth of the first at these steps.
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 1, atol=0.1)


def attributed(tmp_path: Path, name: str, integrators: tuple[str, ...]) -> dict[tuple[str, str], Attribution]:
    """The parts at the smaller of two steps, by integrator and quantity."""
    tasks = plan([load(name)], records("mujoco", "pinocchio"), integrators, (1e-3, 5e-4))
    results = campaigns.results(tasks, tmp_path)
    found = attribute(results, judgement.judge(results))
    return {(part.integrator, part.quantity): part for part in found if part.timestep == 5e-4}


def test_the_parts_of_a_straight_slide(tmp_path: Path) -> None:
    parts = attributed(tmp_path, "sliding-brick", ("Euler", "admm", "law-force"))
    soft = parts["Euler", "stop_distance"]
    assert soft.model_form == pytest.approx(0, abs=1e-15)
    # A soft contact's friction is viscous at last: v1^2 / 2 mu g further, v1 = mu g / b, b = 95 / s. No step mends it.
    assert soft.constraint == pytest.approx(2.5e-4, abs=4e-5)
    # The force of a step acts on the velocity first: the way is v0 h / 2 short.
    assert soft.time_step == pytest.approx(-2.0 * 5e-4 / 2, rel=0.1)
    for integrator in ("admm", "law-force"):
        rigid = parts[integrator, "stop_distance"]
        assert rigid.constraint == pytest.approx(0, abs=1e-6)
        assert rigid.time_step == pytest.approx(-2.0 * 5e-4 / 2, rel=0.01)
    for part in parts.values():
        assert part.total == pytest.approx(part.model_form + part.constraint + part.time_step, abs=1e-15)


def test_cones_are_told_apart_by_the_curling_brick(tmp_path: Path) -> None:
    """The friction of a pyramid depends on its direction, so that it is farther from the law of its own four corners."""
    parts = attributed(tmp_path, "curling-brick", ("Euler", "Euler:cone=elliptic", "admm", "law-force"))
    pyramid, cone, rigid = (parts[name, "stop_yaw"] for name in ("Euler", "Euler:cone=elliptic", "admm"))
    # Corners stop the turn by 1.3 rad earlier than the area does, whichever engine has them.
    for part in (pyramid, cone, rigid):
        assert part.model_form == pytest.approx(-1.33, abs=0.05)
    assert abs(pyramid.constraint) > 5 * abs(cone.constraint) > 50 * abs(rigid.constraint)
    assert parts["law-force", "stop_yaw"].model_form == 0


def test_options_of_the_users_own_are_run(tmp_path: Path) -> None:
    parts = attributed(tmp_path, "spinning-brick", ("Euler:cone=elliptic,pads=2",))
    (part,) = [part for (_, quantity), part in parts.items() if quantity == "stop_time"]
    assert part.model_form is None  # pads are no law of the reference
    assert part.total == pytest.approx(0.328 - 0.286, abs=5e-3)


def test_corners_and_area_are_told_apart() -> None:
    """Pinocchio's four points are the corner law: 0.152 s, where the area law has 0.286 s."""
    area, corners = (truth(load(name)) for name in ("spinning-brick", "spinning-brick-corners"))
    assert area.stop is not None
    assert corners.stop is not None
    assert (round(area.stop.time, 3), round(corners.stop.time, 3)) == (0.286, 0.152)
    run = simulate(load("spinning-brick"), "pinocchio", "admm", 5e-4)
    with_corners = simulate(load("spinning-brick-corners"), "pinocchio", "admm", 5e-4)
    assert compare(corners, with_corners).maxima()["stop_time_error"] < 1e-3
    assert compare(area, run).maxima()["stop_time_error"] == pytest.approx(0.1344, abs=1e-3)


def test_a_brick_at_rest_stays_at_rest() -> None:
    case = load("resting-brick")
    found = truth(case)
    assert found.stop is not None
    assert found.stop.time == 0
    assert not found.trajectory.velocity.any()
    maxima = compare(found, simulate(case, "pinocchio", "law-force", 2e-3)).maxima()
    assert maxima["creep"] == maxima["penetration"] == maxima["tilt"] == 0


def test_the_stop_is_stored_and_its_columns_follow(tmp_path: Path) -> None:
    case = shortened(load("curling-brick"), 0.8, 81)
    tasks = plan([case, load("projectile")], records("mujoco", "pinocchio"), ("Euler", "law-force", "rk4"), (0.01,))
    results = campaigns.results(tasks, tmp_path)
    stored, exact = results.truth(case.name, 0.01), truth(case)
    assert stored.stop == exact.stop
    result_set.write([result_set.judged(results)], tmp_path)
    table = pd.read_csv(tmp_path / "results.csv")
    columns = ["energy_error", "rotational_energy_error", "angular_momentum_error"]
    columns += ["stop_time_error", "stop_position_error", "stop_yaw_error", "creep", "penetration", "tilt"]
    loads = ["mean_load", "peak_load", "time_in_contact"]
    assert [name for name in table.columns if name in columns + loads] == columns + loads
    assert table[table.engine == "mujoco"].dropna(subset="tilt")[loads].notna().all(axis=None)
    assert table[table.engine == "pinocchio"][loads].isna().all(axis=None)
    assert table[table.case == "projectile"][columns].isna().all(axis=None)
    assert table[table.case == case.name][columns].notna().all(axis=None)
    assert table[table.case == case.name].energy_drift.isna().all()


def test_the_load_comes_in_bursts_and_is_the_weight_on_the_average() -> None:
    """MuJoCo's convex friction throws the brick up; see docs/contacts.md."""
    case = load("spinning-brick")
    bouncing = simulate(case, "mujoco", "Euler:cone=elliptic,pads=8", 5e-4)
    maxima = compare(truth(case), bouncing).maxima()
    # The impulses of the load and of gravity are equal but for the height and speed that are left at the stop.
    assert maxima["mean_load"] == pytest.approx(1, abs=0.01)
    assert maxima["peak_load"] > 5
    assert maxima["time_in_contact"] < 0.6


def test_a_body_given_no_position_lies_on_the_plane() -> None:
    assert load("sliding-brick").scene.initial.position == (0.0, 0.0, 0.05)
    with pytest.raises(CaseFaults, match="creeep"):
        parse(load("sliding-brick").text + '[[expect]]\nengine="a"\nintegrator="b"\ntimestep=0.1\ncreeep=1.0\n', "f")
