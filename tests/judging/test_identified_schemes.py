"""Schemes of little engines that share no code with the reference are named, in double and in single precision."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bodycheck import Case, load, truth
from bodycheck.adapters.contract import Method
from bodycheck.judging.schemes.identification import Identification, identify
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.reference.scene import State
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run
from bodycheck.running.instants import sampling_steps
from tests.support.cases import shortened
from tests.support.little_engines import (
    Step,
    fly,
    half_steps,
    implicit_euler,
    linear_euler,
    momentum_euler,
    pose_difference,
    runge_kutta,
)

COMPLEX = load("osrf-boxes-complex")
SPIN = COMPLEX.scene.initial.angular_velocity
CASE = shortened(replace(COMPLEX, scene=replace(COMPLEX.scene, initial=State(angular_velocity=SPIN), gravity=0.0)), 1.0, 26)

LINEAR, WORLD = " with linear quaternions", " of quaternion and world rates"
HALF, THIRD = [[], [0.5]], 1 / 3

ENGINES: dict[str, Step] = {
    "explicit Euler" + WORLD: runge_kutta([[]], [1.0]),
    "Heun 2" + WORLD: runge_kutta([[], [1.0]], [0.5, 0.5]),
    "explicit midpoint" + WORLD: runge_kutta(HALF, [0.0, 1.0]),
    "Kutta 3" + WORLD: runge_kutta([*HALF, [-1.0, 2.0]], [1 / 6, 4 / 6, 1 / 6]),
    "Bogacki-Shampine 3" + WORLD: runge_kutta([*HALF, [0.0, 0.75]], [2 / 9, THIRD, 4 / 9]),
    "Runge-Kutta 4" + WORLD: runge_kutta([*HALF, [0.0, 0.5], [0.0, 0.0, 1.0]], [1 / 6, THIRD, THIRD, 1 / 6]),
    "implicit Euler" + WORLD: implicit_euler,
    "semi-implicit Euler" + LINEAR: linear_euler,
    "semi-implicit Euler of the momentum": momentum_euler,
    "semi-implicit Euler" + LINEAR + " and rates of the turn": pose_difference,
    "2 substeps of semi-implicit Euler" + LINEAR: half_steps(linear_euler, 2),
    "4 substeps of semi-implicit Euler of the momentum": half_steps(momentum_euler, 4),
}

#: Those of order 1: in single precision the others differ by less than rounding may make of it.
SINGLE = [name for name in ENGINES if "Euler" in name and "substeps" not in name]


@cache
def truth_of(case: Case) -> Truth:
    return truth(case)


def flown(step: Step, timestep: float, precision: type[np.floating]) -> Array:
    strides = np.diff(sampling_steps(CASE.instants, timestep), prepend=0)
    return fly(step, np.array(CASE.scene.body.moments), np.array(SPIN), timestep, strides, precision)


def found(rows: Array, timestep: float, roundoff: float) -> Identification:
    steps, still = sampling_steps(CASE.instants, timestep), np.zeros((len(rows), 3))
    trajectory = Trajectory(steps * timestep, still, rows[:, :4], still, rows[:, 4:])
    run = Run(CASE.name, "little", "1.0", Method.parse("own", timestep), Completed(trajectory, int(steps[-1]), 1.0))
    identification = identify(CASE, run, truth_of(CASE), roundoff)
    assert identification is not None
    return identification


@pytest.mark.parametrize("name", ENGINES)
def test_a_scheme_that_is_written_out_is_named(name: str) -> None:
    identification = found(flown(ENGINES[name], 0.01, np.float64), 0.01, ROUNDOFF["float64"])
    assert identification.scheme == identification.nearest == name
    # A rounding of the rates in one of the hundred steps turns the body in all later ones: at most 100^2 / 2 roundings.
    # Processors round differently. The next scheme is more than 1e-8 rad away.
    assert identification.residual < 100**2 / 2 * ROUNDOFF["float64"]


@pytest.mark.parametrize("name", SINGLE)
def test_so_it_is_in_single_precision_by_the_rounding_of_that(name: str) -> None:
    rows = flown(ENGINES[name], 0.02, np.float32)
    identification = found(rows, 0.02, ROUNDOFF["float32"])
    assert identification.scheme == name
    assert 1e-8 < identification.residual < 1e-4
    # The rounding of double precision does not explain it: then it is only near.
    double = found(rows, 0.02, ROUNDOFF["float64"])
    assert (double.scheme, double.nearest) == ("", name)


def test_a_scheme_of_higher_order_in_single_precision_is_near() -> None:
    """The bound of rounding, which takes all errors to be in one direction, does not tell it from others; its residual does."""
    name = "Heun 2" + WORLD
    identification = found(flown(ENGINES[name], 0.01, np.float32), 0.01, ROUNDOFF["float32"])
    assert (identification.scheme, identification.nearest) == ("", name)
    assert identification.cannot_tell
    assert identification.residual < 1e-5


def test_schemes_that_differ_by_a_tiny_amount_are_told_apart() -> None:
    """A turn that is larger by 1e-9 of itself is that of no scheme, but near one."""

    def inexact(q: Array, w: Array, moments: Array, h: np.floating) -> tuple[Array, Array]:
        after, w = linear_euler(q, w, moments, h)
        return after + 1e-9 * (after - q), w

    identification = found(flown(inexact, 0.01, np.float64), 0.01, ROUNDOFF["float64"])
    assert identification.scheme == ""
    assert identification.nearest == "semi-implicit Euler" + LINEAR
    assert 1e-9 < identification.residual < 1e-7
