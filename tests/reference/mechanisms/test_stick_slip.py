"""Dry friction in joints: against closed forms, and against the equations of a cart with a pendulum, written by hand."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.mechanisms.recursion import follow
from bodycheck.reference.trajectory import Array
from tests.support.jointed import body

pytest.importorskip("heyoka")

#: Some hundred roundings of the 80-bit type.
CLOSE = 1e-17 if np.finfo(np.longdouble).nmant > 52 else 1e-13

BLOCK = body("block", 2.0, (0.1, 0.1, 0.1))
RAIL = Joint("rail", "prismatic", WORLD, 0, axis=(1.0, 0.0, 0.0), friction=3.0, start=(0.0,), start_velocity=(0.0,))

G, CART, BOB, LENGTH, FRICTION = 9.75, 2.0, 1.0, 0.5, 4.0
CART_AND_PENDULUM = Mechanism(
    (replace(BLOCK, name="cart"), body("bob", BOB, (0.0, 0.0, 0.0), (0.0, 0.0, -LENGTH))),
    (
        replace(RAIL, friction=FRICTION),
        Joint("pin", "revolute", 0, 1, axis=(0.0, 1.0, 0.0), start=(0.25,), start_velocity=(2.5,)),
    ),
    gravity=G,
)


def slider(**values: float | tuple[float, ...]) -> Mechanism:
    return Mechanism((BLOCK,), (replace(RAIL, **values),), gravity=9.81)


def test_a_slider_stops_when_and_where_the_closed_form_says() -> None:
    times = np.array([0.0, 0.5, 1.0, 2.0, 3.0])
    found = follow(slider(start_velocity=(-3.0,)), times)
    # v = 3 - 1.5 t until t = 2, where it has moved by 3.
    np.testing.assert_allclose(found.position[:, 0].astype(float), [0.0, -1.3125, -2.25, -3.0, -3.0], atol=1e-18)
    np.testing.assert_allclose(found.velocity[:, 0].astype(float), [-3.0, -2.25, -1.5, 0.0, 0.0], atol=1e-18)
    (stop,) = found.changes
    assert (stop.joint, stop.mode) == (0, 0)
    assert abs(stop.time - 2) < CLOSE


def test_instants_may_be_in_any_order_repeated_or_none() -> None:
    mechanism, times = slider(start_velocity=(-3.0,)), np.array([3.0, 0.0, 0.5, 0.5])
    found = follow(mechanism, times).position[:, 0].astype(float)
    np.testing.assert_allclose(found, [-3.0, 0.0, -1.3125, -1.3125], atol=1e-18)
    assert follow(mechanism, times[:0]).bodies.position.shape == (1, 0, 3)


@pytest.mark.parametrize(("effort", "moved"), [(2.9, 0.0), (3.0, 0.0), (-3.5, -0.5)])
def test_a_constant_effort_moves_a_slider_where_it_exceeds_the_friction(effort: float, moved: float) -> None:
    found = follow(slider(effort=effort), np.array([2.0]))
    assert abs(found.position[0, 0] - moved) < CLOSE


def test_an_oscillator_loses_the_same_length_in_each_half_turn_until_it_sticks() -> None:
    # omega = 2, and the middle is displaced by F / k = 3/8: turns at 2, -5/4, 1/2 and -1/4, where 8 * 1/4 < 3.
    turns, times = [2.0, -1.25, 0.5, 0.25], np.arange(5) * np.pi / 2
    found = follow(slider(start=(2.0,), stiffness=8.0), times)
    np.testing.assert_allclose(found.position[:, 0].astype(float), [*turns, 0.25], rtol=0, atol=1e-15)
    exact = [np.longdouble(k) * 2 * np.arcsin(np.longdouble(1)) / 2 for k in (1, 2, 3)]
    assert max(abs(change.time - time) for change, time in zip(found.changes, exact, strict=True)) < CLOSE
    assert [change.mode for change in found.changes] == [1, -1, 0]


def by_hand(times: Array) -> tuple[Array, list[tuple[float, int]]]:
    """Coordinates x and angle of the cart with a pendulum in doubles, and the changes of the cart, phase by phase."""
    state, t, mode, changes = np.array([0.0, 0.25, 0.0, 2.5]), 0.0, 0, [(0.0, 0)]
    rows = np.empty((len(times), 2))

    def strain(y: Array) -> float:
        # The horizontal force of a pendulum on a point at rest.
        return -float(BOB * np.sin(y[1]) * (G * np.cos(y[1]) + LENGTH * y[3] ** 2))

    def rates(_: float, y: Array) -> Array:
        c, s = np.cos(y[1]), np.sin(y[1])
        if mode == 0:
            return np.array([0.0, y[3], 0.0, -G / LENGTH * s])
        # The bob is at (x - l sin a, -l cos a).
        matrix = np.array([[CART + BOB, -BOB * LENGTH * c], [-BOB * LENGTH * c, BOB * LENGTH**2]])
        force = [-BOB * LENGTH * s * y[3] ** 2 - mode * FRICTION, -BOB * G * LENGTH * s]
        return np.array([y[2], y[3], *np.linalg.solve(matrix, force)])

    def margin(_: float, y: Array) -> float:
        return mode * float(y[2]) if mode else FRICTION - abs(strain(y))

    margin.terminal, margin.direction = True, -1  # type: ignore[attr-defined]
    while t < times[-1]:
        wanted = times[times >= t]
        phase = solve_ivp(rates, (t, times[-1]), state, "DOP853", wanted, events=margin, rtol=1e-13, atol=1e-13)
        rows[len(times) - len(wanted) :][: len(phase.t)] = phase.y[:2].T
        if phase.status == 0:
            break
        t, state = phase.t_events[0][0], phase.y_events[0][0]
        state[2] = 0.0
        push = strain(state)
        mode = int(np.sign(push)) if mode == 0 or abs(push) > FRICTION else 0
        changes.append((t, mode))
        if mode:
            # Past the double root at the beginning of a phase.
            after = solve_ivp(rates, (t, t + 1e-4), state, "DOP853", rtol=1e-13, atol=1e-13)
            t, state = after.t[-1], after.y[:, -1]
    return rows, changes


def test_a_cart_sticks_and_slips_as_its_pendulum_pulls() -> None:
    times = np.linspace(0.0, 2.0, 9)
    rows, changes = by_hand(times)
    found = follow(CART_AND_PENDULUM, times)
    assert len(changes) > 4, "the cart sticks and slips several times"
    assert [(change.joint, change.mode) for change in found.changes] == [(0, mode) for _, mode in changes[1:]]
    # The solution by hand has tolerances of 1e-13 in each step, and its times of changes those of the root finder.
    np.testing.assert_allclose([float(change.time) for change in found.changes], [t for t, _ in changes[1:]], atol=1e-9)
    np.testing.assert_allclose(found.position.astype(float), rows, atol=1e-10)


def test_a_wider_type_changes_the_last_digits_alone() -> None:
    import heyoka as hy

    times = np.array([2.0])
    found, wider = (follow(CART_AND_PENDULUM, times, dtype) for dtype in (np.longdouble, hy.real128))
    head = found.position.astype(float)
    apart = (wider.position - head).astype(float) - (found.position - head).astype(float)
    # Some changes, each with an error of its time of some roundings.
    assert np.abs(apart).max() < 10 * CLOSE


def test_joints_at_rest_release_each_other() -> None:
    # A block on a block: the upper one is pushed by its own joint, and the lower one is carried by the friction between them
    # only where it exceeds that of the rail: 3 N hold the lower one against 2 N of the upper.
    upper = replace(RAIL, name="upper", parent=0, child=1, friction=2.0, effort=2.5)
    mechanism = Mechanism((BLOCK, replace(BLOCK, name="top")), (RAIL, upper))
    found = follow(mechanism, np.array([2.0]))
    assert np.abs(found.position[0] - [0.0, 0.5]).max() < CLOSE
    # With a rail of 0.2 N the lower one goes back: 2 a = -0.5 + 0.2, and the upper one has 2 (a + b) = 0.5.
    looser = replace(mechanism, joints=(replace(RAIL, friction=0.2), upper))
    found = follow(looser, np.array([2.0]))
    friction = np.longdouble(0.2)
    lower = (friction - np.longdouble(0.5)) / 2
    assert np.abs(found.position[0] - [2 * lower, 2 * (np.longdouble(0.25) - lower)]).max() < CLOSE


def test_of_many_joints_at_rest_those_slip_that_must() -> None:
    # Blocks on one another. Each is pushed against the one below by its effort, of which friction leaves 1/2 N to the fourth,
    # and that below slips by what pushes it back, 1/2 N less than its friction.
    joints = tuple(replace(RAIL, name=f"rail-{k}", parent=k - 1, child=k, effort=3.5 if k == 4 else 0.0) for k in range(10))
    mechanism = Mechanism(tuple(replace(BLOCK, name=f"block-{k}") for k in range(10)), joints)
    found = follow(mechanism, np.array([2.0]))
    # The six blocks above the joint have 12 kg together.
    assert np.abs(found.position[0] - np.where(np.arange(10) == 4, np.longdouble(1) / 12, 0)).max() < CLOSE


def test_a_dry_chain_comes_to_rest() -> None:
    rod = body("rod", 12.0, (1.0, 1.0, 0.0), (0.0, 0.0, -0.5))
    pin = Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), friction=25.0, start=(1.5,), start_velocity=(0.0,))
    links = range(3)
    joints = tuple(
        replace(pin, name=f"pin-{k}", parent=k - 1, child=k, position=(0.0, 0.0, -1.0 if k else 0.0), start=(1.5 - k,))
        for k in links
    )
    mechanism = Mechanism(tuple(replace(rod, name=f"rod-{k}") for k in links), joints, gravity=9.81)
    found = follow(mechanism, np.array([20.0, 25.0]))
    assert (found.velocity == 0).all()
    assert (found.position[0] == found.position[1]).all()
    # Friction holds each joint: what gravity asks of it is at most 25 N m.
    down = np.sin(found.position[0].cumsum().astype(float))
    below = np.array([2.5, 1.5, 0.5]) * down * 12 * 9.81
    assert (np.abs(below[::-1].cumsum()) <= 25).all()
