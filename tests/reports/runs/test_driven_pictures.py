"""Targets and stops of driven joints in the charts, in the animation and in the words of a report."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import vl_convert
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from bodycheck.casefile.case import parse
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.control import Controller, Samples, Sine, Stops
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reports.runs.charts import joint_curves, time_charts
from bodycheck.reports.runs.motions.driven import arm_of, driven, places_at_targets
from bodycheck.reports.runs.motions.playback import Frame
from bodycheck.reports.runs.scenes import describe
from bodycheck.reports.runs.targets import target_of
from tests.support import jointed
from tests.support.driven_hinge import PD, hinge
from tests.support.mechanism_texts import CART_POLE

T = np.linspace(0, 2, 201)
ANGLES = st.floats(-3, 3)


def moved(mechanism: Mechanism, *coordinates: Any) -> Any:
    """Return the motion of the bodies from coordinates (n,), at rest."""
    position = np.column_stack(np.broadcast_arrays(*coordinates, T)[:-1])
    return kinematics.bodies(mechanism, JointMotion(position, np.zeros_like(position)), t=T)


def chain() -> Mechanism:
    """Return an arm of two links with turned frames on a slide, of which all joints have targets, and two have stops."""
    place: dict[str, Any] = {"position": (0.1, -0.2, 0.4), "attitude": (0.8, 0.2, -0.4, 0.4)}
    joints = (
        Joint("elbow", "revolute", 2, 0, axis=(0.0, 3.0, 4.0), **place),
        Joint("rail", "prismatic", WORLD, 1, axis=(0.0, 2.0, 0.0), stops=Stops(-0.5, None), **place),
        Joint("shoulder", "revolute", 1, 2, axis=(1.0, 0.0, 1.0), stops=Stops(-1.0, 2.0), **place),
    )
    started = tuple(replace(joint, start=(0.0,), start_velocity=(0.0,)) for joint in joints)
    bodies = tuple(jointed.body(name, 1.0, (0.1, 0.1, 0.1), (0.1, 0.2, k)) for k, name in enumerate(("hand", "cart", "arm")))
    return Mechanism(bodies, started, controllers=tuple(Controller(joint, kp=1.0, target=0.1) for joint in range(3)))


def test_targets_and_stops_are_rows_of_the_chart() -> None:
    target = Samples((0.5, 1.0), (0.2, -0.4))
    mechanism = hinge(replace(PD, target=target), stops=Stops(-0.7, 50.0))
    rows = joint_curves.rows(mechanism, moved(mechanism, 0.3 * np.sin(T)), {}, 50)
    assert [(row["joint"], row["kind"], row["method"]) for row in rows] == [
        ("pin", "angle", "the truth"),
        ("pin", "angle", "the target"),
        ("pin", "angle", "a stop"),  # the other one is so far away that the curves would be flat
    ]
    assert rows[1]["t"] == [0.0, 1.0, 1.0, 2.0]
    assert rows[1]["value"] == [0.2, 0.2, -0.4, -0.4]
    assert (rows[2]["beyond"], rows[2]["value"]) == ("lower", [-0.7])
    alt, notes = joint_curves.described(rows, mechanism)["angle"]
    assert notes == ("Thin and dotted: the targets of controllers.", "Bands: beyond the stops of joints.")
    assert all(note in alt for note in notes)
    svg = vl_convert.vegalite_to_svg(time_charts.joints("angle") | {"datasets": {"joints": rows}})
    assert svg.count('stroke-dasharray="1.5,3"') == 1
    assert svg.count('class="mark-rect role-mark') == 2
    symbol = svg.partition("role-legend-symbol")[2].partition("/>")[0]
    assert 'stroke-width="2" opacity="1"' in symbol


def test_a_target_follows_its_signal() -> None:
    sine = Sine(2.0, 9.0, 0.3, 1.0)
    t, values = target_of(replace(PD, target=sine), 2.0, 800) or pytest.fail("there is a target")
    assert len(t) < 800
    # Half a per cent of the amplitude by the number of points, and a thousandth of the range by leaving some out.
    assert np.interp(T, t, values) == pytest.approx(1 + 2 * np.sin(9 * T + 0.3), abs=0.005 * 2 + 0.001 * 4)
    linear = Samples((0.5, 1.0), (0.2, -0.4), "linear")
    t, values = target_of(replace(PD, target=linear), 2.0, 800) or pytest.fail("there is a target")
    assert np.interp(T, t, values) == pytest.approx(np.interp(T, linear.times, linear.values), abs=1e-15)
    assert target_of(replace(PD, target=Sine(1.0, 1e6)), 2.0, 800) is None
    assert target_of(Controller(0, "effort", effort=1.0), 2.0, 800) is None
    assert target_of(replace(PD, kp=0.0, target_velocity=1.0), 2.0, 800) is None


@given(st.tuples(ANGLES, ANGLES, ANGLES))
def test_the_player_puts_bodies_where_the_joints_put_them(values: tuple[float, float, float]) -> None:
    mechanism, frame = chain(), Frame((0.3, 0.2, -0.1), 1.7, 0.0)
    exact = moved(mechanism, *values)
    entries = driven(mechanism, frame, 2.0)
    assert [entry["body"] for entry in entries] == [1, 2, 0]
    poses: dict[int, tuple[Rotation, Any]] = {WORLD: (Rotation.identity(), np.zeros(3))}
    for entry in entries:
        parent, place = poses[entry["parent"]]
        turn, way = parent * Rotation.from_quat(entry["turn"], scalar_first=True), np.array(entry["axis"])
        value = values[(1, 2, 0)[len(poses) - 1]]
        slide = turn.apply(value / frame.extent * way) if entry["slides"] else 0.0
        own = turn if entry["slides"] else turn * Rotation.from_rotvec(value * way)
        poses[entry["body"]] = own, place + parent.apply(entry["at"]) + slide + own.apply(entry["centre"])
    for body in range(3):
        drawn = poses[body][1] * frame.extent + frame.middle
        assert drawn == pytest.approx(exact.position[body, 0], abs=1e-12)


def test_stops_and_targets_are_in_the_units_of_the_picture() -> None:
    mechanism, frame = chain(), Frame((0.0, 0.0, 0.0), 2.0, 0.0)
    rail, shoulder, elbow = driven(mechanism, frame, 2.0)
    assert rail["stops"] == [-0.25]
    assert shoulder["stops"] == [-1.0, 2.0]
    assert "stops" not in elbow
    assert set(rail["target"]["value"]) == {0.05}
    assert set(elbow["target"]["value"]) == {0.1}
    (places,) = places_at_targets(mechanism, moved(mechanism, 0.7, 0.8, 0.9))
    assert places == pytest.approx(moved(mechanism, 0.1, 0.1, 0.1).position)
    assert places_at_targets(jointed.cart_pole(), moved(jointed.cart_pole(), 0.0, 0.0)) == []


def test_a_body_that_looks_the_same_at_all_angles_has_an_arm() -> None:
    arm = np.array(arm_of(hinge(), 0, [(0.0, 0.0, 0.0)]))
    assert np.linalg.norm(arm) == pytest.approx(0.1)  # its radius of gyration
    assert np.dot(arm, (0.0, 1.0, 0.0)) == 0
    cart = jointed.cart_pole()
    assert arm_of(cart, 0, [(0.0, 0.0, 0.0), (0.0, 0.0, 0.1)]) is None
    assert arm_of(cart, 1, [(0.0, 0.0, -0.35)]) is None


def test_controllers_and_stops_are_described() -> None:
    case = parse(CART_POLE, "f")
    scene = case.scene
    assert isinstance(scene, Mechanism)
    rail, pin = scene.joints
    controllers = (
        Controller(0, kp=20.0, ki=3.0, target=Sine(1.0, 4.0), rate=500.0, delay=2, effort_limit=50.0, no_load_speed=10.0),
        Controller(1, "effort", effort=Samples((0.0, 1.0), (0.5, -0.5), "linear")),
    )
    joints = (replace(rail, stops=Stops(-1.0, 2.0, None, 400.0, 4.0)), replace(pin, stops=Stops(None, 0.5)))
    facts = {
        fact.term: fact.text
        for fact in describe(replace(case, scene=replace(scene, joints=joints, controllers=controllers)), ())
    }
    assert facts["Joints"] == (
        "rail: prismatic, cart on the world, with stops at -1 and 2 m (elastic, 400 N/m and 4 N s/m); "
        "pin: revolute, pole on cart, with a stop at 0.5 rad (rigid, restitution 0)"
    )
    assert facts["Controllers"] == (
        "rail: pd law at 500 Hz, 2 periods late: kp 20, ki 3, target 1 m times a sine of 4 rad/s, at most 50 N, "
        "no-load speed 10 m/s; pin: continuous feed-forward: effort from -0.5 to 0.5 N m, linear between 2 instants"
    )
