"""Which scheme an engine is in the coordinates of joints: MuJoCo's and Pinocchio's, on a hinge, a slider and a ball."""

from functools import cache

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.judging.schemes.identified import Identification
from bodycheck.judging.schemes.jointed_identification import identify_jointed
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.mechanisms.recursion import follow
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run
from tests.support.jointed import ball_and_hinge, body, trajectory

pytest.importorskip("pinocchio")

STEP = 0.01

DAMPED, SPRUNG = "semi-implicit Euler with implicit damping", "semi-implicit Euler with implicit damping and springs"
PLAIN, LINEAR = "semi-implicit Euler", "linearly implicit Euler"
MUNTHE_KAAS, AVERAGED = "Runge-Kutta-Munthe-Kaas 4", "averaged Runge-Kutta 4"


def slider(stiffness: float = 0.0) -> Mechanism:
    """A body that falls along an oblique rail, on a spring or on none."""
    rail = Joint("rail", "prismatic", WORLD, 0, axis=(1.0, 2.0, 2.0), stiffness=stiffness, start=(0.1,), start_velocity=(0.5,))
    return Mechanism((body("cart", 0.8, (0.1, 0.1, 0.1)),), (rail,), gravity=9.81)


MECHANISMS = {"ball and hinge": ball_and_hinge(), "spring": slider(30.0), "fall": slider()}


@cache
def truth_of(name: str) -> Truth:
    """The motion by the recursion alone, whose error is far below that of any run here."""
    instants = STEP * np.arange(0, 101, 2)
    bound = np.full(len(instants), 1e-13)
    motion = follow(MECHANISMS[name], instants, np.float64).bodies
    return Truth(MECHANISMS[name], motion, Bounds(*(bound for _ in NAMES)), "", "", "")


def found(name: str, engine: str, spelling: str) -> Identification:
    truth, method, adapter = truth_of(name), Method.parse(spelling, STEP), registry.load(engine)
    instants: Array = truth.trajectory.t
    strides = np.diff(np.rint(instants / STEP).astype(np.int64), prepend=0)
    seen = trajectory(instants, adapter.prepare([MECHANISMS[name]], method).advance(strides))
    run = Run(name, engine, "", method, Completed(seen, int(strides.sum()), 1.0))
    identification = identify_jointed(MECHANISMS[name], run, truth, ROUNDOFF["float64"])
    assert identification is not None
    return identification


@pytest.mark.parametrize(
    ("engine", "spelling", "scheme"),
    [
        ("mujoco", "Euler", DAMPED),
        ("mujoco", "Euler:eulerdamp=disable", PLAIN),
        ("mujoco", "RK4", MUNTHE_KAAS),
        ("mujoco", "implicit", LINEAR),
        ("mujoco", "implicitfast", DAMPED),
        ("mujoco", "discrete", SPRUNG),
        ("pinocchio", "semi-implicit-euler", PLAIN),
        ("pinocchio", "rk4", MUNTHE_KAAS),
        ("pinocchio", "rk4-naive", AVERAGED),
    ],
)
def test_the_scheme_is_named_on_a_ball_with_a_sprung_and_damped_hinge(engine: str, spelling: str, scheme: str) -> None:
    assert found("ball and hinge", engine, spelling).scheme == scheme


@pytest.mark.parametrize(("spelling", "scheme"), [("Euler", PLAIN), ("discrete", SPRUNG), ("RK4", MUNTHE_KAAS)])
def test_the_scheme_is_named_on_a_slider_with_a_spring(spelling: str, scheme: str) -> None:
    assert found("spring", "mujoco", spelling).scheme == scheme


def test_no_scheme_is_named_where_many_are_exact() -> None:
    """A body that falls along a rail moves as all Runge-Kutta schemes say."""
    identification = found("fall", "mujoco", "RK4")
    assert not identification.scheme
    assert identification.cannot_tell
