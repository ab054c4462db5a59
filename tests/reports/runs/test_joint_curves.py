"""The curves of joints over time in a report: those of the truth, and of runs where the difference is seen."""

from dataclasses import replace

import numpy as np
import pytest
import vl_convert

from bodycheck.reference.kinematics import multiply
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reports.runs.charts import joint_curves, time_charts
from tests.support import jointed

T = np.linspace(0, 2, 201)


def moved(mechanism: Mechanism, *coordinates: np.ndarray) -> Trajectory:
    position = np.column_stack(coordinates)
    return kinematics.bodies(mechanism, JointMotion(position, np.zeros_like(position)), t=T)


def test_the_truth_has_a_curve_of_each_coordinate_and_a_run_where_it_is_seen_to_differ() -> None:
    cart = jointed.cart_pole()
    exact = moved(cart, T**2, 0.3 * np.cos(T))
    beside = moved(cart, T**2 * 1.001, 0.3 * np.cos(1.1 * T))
    rows = joint_curves.rows(cart, exact, {"a": (beside, exact), "b": (exact, exact)}, 50)
    assert [(row["joint"], row["kind"], row["method"]) for row in rows] == [
        ("rail", "slide", "the truth"),
        ("pin", "angle", "the truth"),
        ("pin", "angle", "a"),
    ]
    for row, values in zip(rows, (T**2, 0.3 * np.cos(T), 0.3 * np.cos(1.1 * T)), strict=True):
        assert len(row["t"]) <= 50
        # A thousandth of the range of a curve, between the instants that are kept.
        assert np.interp(T, row["t"], row["value"]) == pytest.approx(values, abs=2e-3 * np.ptp(values))
    told = joint_curves.described(rows, cart)
    assert told["slide"][1] == ()
    assert told["angle"][1] == ("Dashed: a, where the difference is seen.",)


def test_the_curve_of_a_ball_is_its_angle() -> None:
    ball = Mechanism(
        (jointed.body("ball", 1.0, (1.0, 1.0, 1.0)),),
        (Joint("socket", "spherical", WORLD, 0, start=(1.0, 0.0, 0.0, 0.0), start_velocity=(0.0, 0.0, 1.0)),),
    )
    turns = np.column_stack([np.cos(T / 2), 0 * T, 0 * T, np.sin(T / 2)])
    tilted = multiply(turns, np.broadcast_to([1.0, 0.0, 0.0, 0.0], turns.shape))
    motion = kinematics.bodies(ball, JointMotion(tilted, np.zeros((201, 3))), t=T)
    (row,) = joint_curves.rows(ball, motion, {}, 50)
    assert (row["joint"], row["kind"]) == ("socket", "angle")
    assert np.interp(1.0, row["t"], row["value"]) == pytest.approx(1.0, abs=2e-3)


def test_a_chart_says_how_many_coordinates_it_leaves_out() -> None:
    hinges = tuple(Joint(f"hinge-{n}", "revolute", n - 1, n, start=(0.1,), start_velocity=(0.0,)) for n in range(11))
    chain = Mechanism(tuple(jointed.body(f"link-{n}", 1.0, (1.0, 1.0, 1.0)) for n in range(11)), hinges)
    rows = joint_curves.rows(chain, moved(chain, *(n * T for n in range(11))), {}, 50)
    told, notes = joint_curves.described(rows, chain)["angle"]
    assert len(rows) == joint_curves.MOST_COORDINATES == 8
    assert notes == ("The first 8 of 11 are shown.",)
    assert notes[0] in told


@pytest.mark.parametrize(("kind", "axis"), [("angle", "Angle, rad"), ("slide", "Displacement, m")])
def test_charts_draw_each_curve(kind: str, axis: str) -> None:
    cart = jointed.cart_pole()
    exact, beside = moved(cart, T, T), moved(cart, 1.5 * T, 2 * T)
    rows = joint_curves.rows(cart, exact, {"a": (beside, exact)}, 50)
    svg = vl_convert.vegalite_to_svg(time_charts.joints(kind) | {"datasets": {"joints": rows}})
    assert svg.count('stroke-dasharray="5,4"') == 1
    assert axis in svg


def test_values_that_are_no_numbers_are_left_out() -> None:
    cart = jointed.cart_pole()
    exact = moved(cart, T, T)
    lost = replace(exact, position=np.where(T[:, None] > 1, np.nan, exact.position + 0.5))
    rows = joint_curves.rows(cart, exact, {"a": (lost, exact)}, 50)
    assert any(row["method"] == "a" for row in rows)
