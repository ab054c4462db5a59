"""Driven joints in MuJoCo and Pinocchio, by efforts and by MuJoCo's own limits."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.control import Controller, Sine, Stops
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism, Mimic
from bodycheck.reference.trajectory import Array
from bodycheck.running.states import trajectory_of
from tests.support.driven_hinge import CONTINUOUS, PD, SAMPLED, SAMPLED_RATE, hinge
from tests.support.jointed import body

#: The engines, each with a scheme of the fourth order.
FOURTH = [("mujoco", "RK4"), ("pinocchio", "rk4")]


def joints(mechanism: Mechanism, engine: str, spelling: str, timestep: float, steps: list[int]) -> tuple[Array, Array]:
    """Return the coordinates and velocities (n, joints) of a run after n numbers of steps."""
    adapter, method = registry.load(engine), Method.parse(spelling, timestep)
    assert offers.not_modelled(adapter.engine, mechanism, method) is None
    states = offers.prepare(adapter, [mechanism], method).advance(np.repeat([0, 1], [1, steps[-1]]))
    times = np.arange(steps[-1] + 1) * timestep
    motion = kinematics.joints(mechanism, trajectory_of(times, states[0].swapaxes(0, 1)))
    return motion.position[steps], motion.velocity[steps]


def arm(rate: float | None, *more: Controller) -> Mechanism:
    """Return a two-link arm in gravity whose joints follow sines."""
    controllers = (
        Controller(0, kp=30.0, kd=3.0, target=Sine(0.5, 4.0), rate=rate),
        Controller(1, kp=20.0, kd=2.0, target=0.4, effort=Sine(0.3, 7.0, 1.0), rate=rate),
    )
    links = (body("upper", 1.0, (0.01, 0.02, 0.01), (0.2, 0.0, 0.0)), body("lower", 0.7, (0.01, 0.01, 0.01), (0.15, 0.0, 0.0)))
    return Mechanism(
        links,
        (
            Joint("shoulder", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.1,), start_velocity=(0.0,)),
            Joint("elbow", "revolute", 0, 1, (0.4, 0.0, 0.0), axis=(0.0, 1.0, 0.0), start=(0.3,), start_velocity=(0.5,)),
        ),
        gravity=9.81,
        controllers=more or controllers,
    )


@pytest.mark.parametrize(("engine", "spelling"), FOURTH)
@pytest.mark.parametrize("timestep", [0.002, 0.001, 0.0004])
def test_a_sampled_law_on_one_joint_is_exact(engine: str, spelling: str, timestep: float) -> None:
    position, velocity = joints(hinge(replace(PD, rate=500.0)), engine, spelling, timestep, [0, round(0.1 / timestep)])
    assert position[1, 0] == pytest.approx(SAMPLED, abs=1e-12)
    assert velocity[1, 0] == pytest.approx(SAMPLED_RATE, abs=1e-11)  # the rate is of the order of 10 rad/s


@pytest.mark.parametrize(("engine", "spelling"), FOURTH)
def test_a_continuous_law_is_evaluated_at_the_stages(engine: str, spelling: str) -> None:
    errors = [
        abs(joints(hinge(PD), engine, spelling, h, [0, round(0.1 / h)])[0][1, 0] - CONTINUOUS) for h in (0.002, 0.001, 0.0005)
    ]
    assert errors[0] < 1e-6
    assert all(15 < ratio < 19 for ratio in np.divide(errors[:-1], errors[1:]))


@pytest.mark.parametrize(("engine", "spelling"), FOURTH)
@pytest.mark.parametrize("rate", [100.0, None])
def test_an_arm_is_driven_with_the_order_of_the_scheme(engine: str, spelling: str, rate: float | None) -> None:
    runs = [joints(arm(rate), engine, spelling, h, [0, round(0.1 / h)])[0][1] for h in (0.0025, 0.00125, 0.000625)]
    ratio = np.abs(runs[0] - runs[1]).max() / np.abs(runs[1] - runs[2]).max()
    assert 13 < ratio < 21


@pytest.mark.parametrize(("engine", "spelling"), FOURTH)
def test_the_integral_of_a_continuous_law_keeps_the_order(engine: str, spelling: str) -> None:
    integral = arm(None, Controller(0, kp=30.0, kd=3.0, ki=200.0, target=Sine(0.5, 4.0)))
    runs = [joints(integral, engine, spelling, h, [0, round(0.1 / h)])[0][1] for h in (0.0025, 0.00125, 0.000625)]
    ratio = np.abs(runs[0] - runs[1]).max() / np.abs(runs[1] - runs[2]).max()
    assert 13 < ratio < 21


def test_two_engines_agree_on_an_arm_with_all_that_a_law_has() -> None:
    laws = (
        Controller(0, kp=40.0, kd=1.0, ki=5.0, target=Sine(0.5, 9.0), rate=250.0, delay=1, effort_limit=8.0, no_load_speed=6.0),
        Controller(1, kp=20.0, kd=0.3, target=0.9, effort_limit=2.0),
    )
    one, other = (joints(arm(None, *laws), engine, spelling, 0.001, [0, 100, 500])[0] for engine, spelling in FOURTH)
    assert one == pytest.approx(other, abs=1e-10)  # of equal schemes; 400 steps


def test_a_joint_that_follows_another_is_driven_through_it() -> None:
    # The follower turns twice as far, so that its effort acts with twice its size on the leader.
    joint = Joint("first", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.0,), start_velocity=(0.0,))
    second = replace(joint, name="second", child=1, mimic=Mimic(0, 2.0, 0.1), start=(0.1,))
    bodies = body("one", 1.0, (0.01, 0.01, 0.01)), body("two", 1.0, (0.01, 0.01, 0.01))
    pair = Mechanism(bodies, (joint, second), controllers=(Controller(1, kp=20.0, kd=0.4, target=1.1, rate=500.0),))
    same = hinge(Controller(0, kp=80.0 / 5, kd=1.6 / 5, target=0.5, rate=500.0))
    position, _ = joints(pair, "pinocchio", "rk4", 0.001, [0, 100])
    assert position[1, 0] == pytest.approx(joints(same, "pinocchio", "rk4", 0.001, [0, 100])[0][1, 0], abs=1e-12)
    assert position[1, 1] == pytest.approx(2 * position[1, 0] + 0.1, abs=1e-12)


@pytest.mark.parametrize(("engine", "spelling"), FOURTH)
def test_the_constant_effort_of_a_joint_is_added(engine: str, spelling: str) -> None:
    loaded = hinge(replace(PD, rate=500.0, effort=-0.2))
    loaded = replace(loaded, joints=(replace(loaded.joints[0], effort=0.2),))
    assert joints(loaded, engine, spelling, 0.001, [0, 100])[0][1, 0] == pytest.approx(SAMPLED, abs=1e-12)


def test_elastic_stops_of_mujoco_are_those_of_the_case() -> None:
    stopped = hinge(Controller(0, law="effort", effort=0.05), stops=Stops(-1.0, 0.1, None, 40.0, 0.3), rate=2.0)
    own, _ = joints(stopped, "mujoco", "RK4", 1e-4, [0, 600, 1200, 2000])
    given, _ = joints(stopped, "mujoco", "RK4:limits=effort", 1e-4, [0, 600, 1200, 2000])
    # The limit has an additional inertia of a ten-thousandth, and acts from the step after the contact on.
    assert own == pytest.approx(given, abs=1e-4)
    assert given[1, 0] > 0.1
    tree = arm(None, Controller(1, law="effort", effort=1.0))
    bent = replace(tree, joints=(tree.joints[0], replace(tree.joints[1], stops=Stops(None, 0.35, None, 100.0, 0.5))))
    own, _ = joints(bent, "mujoco", "RK4", 1e-4, [0, 1000, 2000])
    given, _ = joints(bent, "mujoco", "RK4:limits=effort", 1e-4, [0, 1000, 2000])
    assert own == pytest.approx(given, abs=2e-4)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.8, 1.0])
def test_rigid_stops_of_mujoco_tend_to_the_restitution_that_a_spring_can_have(restitution: float) -> None:
    # A critically damped spring gives back exp(-2), and MuJoCo's limit no less; the rest is of the resolution of the contact.
    bouncing = hinge(stops=Stops(-1.0, 0.1, restitution), rate=2.0)
    position, velocity = joints(bouncing, "mujoco", "RK4", 1e-4, [0, 1000])
    assert velocity[1, 0] == pytest.approx(-2 * max(restitution, math.exp(-2)), rel=0.2)
    assert position[1, 0] < 0.1


def test_what_an_engine_does_not_model_is_refused_with_the_reason() -> None:
    mujoco, pinocchio = registry.load("mujoco").engine, registry.load("pinocchio").engine
    elastic, rigid = hinge(PD, stops=Stops(-1.0, 1.1, None, 40.0)), hinge(PD, stops=Stops(-1.0, 1.1))
    plain, effort = Method.parse("rk4", 0.001), Method.parse("rk4:limits=effort", 0.001)
    assert offers.not_modelled(pinocchio, elastic, plain) == "does not model elastic stops"
    assert offers.not_modelled(pinocchio, elastic, effort) is None
    assert "rigid stops by efforts" in str(offers.not_modelled(pinocchio, rigid, effort))
    assert "without limits" in str(offers.not_modelled(mujoco, hinge(PD), effort))


def test_defaults_are_never_spelled() -> None:
    assert Method.parse("RK4:control=effort,limits=engine", 0.001) == Method.parse("RK4", 0.001)
    assert Method.parse("RK4:limits=effort", 0.001).name == "RK4:limits=effort"
    assert offers.knows(registry.load("mujoco").engine, "RK4:limits=effort")
    assert not offers.knows(registry.load("mujoco").engine, "RK4:limits=other")
