"""Runs of driven joints in engines: a hinge whose motion is known, an arm with one driven joint, and falls onto stops."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Adapter, Method
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.control import Controller, Sine, Stops
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array
from tests.support.driven_hinge import CONTINUOUS, PD, SAMPLED, SAMPLED_RATE, hinge
from tests.support.jointed import body, trajectory

#: The time (s) for which the motion of the hinge is known, and which the arm moves.
DURATION = 0.1


def joints_after(
    adapter: Adapter, mechanism: Mechanism, spelling: str, timestep: float, times: Sequence[float]
) -> tuple[Array, Array]:
    """Return the coordinates and velocities (n, joints) of a run at n times (s), each a number of steps."""
    method, ends = Method.parse(spelling, timestep), np.round(np.array(times) / timestep).astype(np.int64)
    assert offers.not_modelled(adapter.engine, mechanism, method) is None
    states = offers.prepare(adapter, [mechanism], method).advance(np.diff(ends, prepend=0))
    motion = kinematics.joints(mechanism, trajectory(np.array(times), states))
    return motion.position, motion.velocity


def sampled_error(adapter: Adapter, spelling: str, timestep: float) -> float:
    """Return the error (rad) of the hinge at 500 Hz; that of the rate (rad/s), which is ten times as large, is scaled."""
    position, velocity = joints_after(adapter, hinge(replace(PD, rate=500.0)), spelling, timestep, [0.0, DURATION])
    return max(abs(float(position[1, 0]) - SAMPLED), abs(float(velocity[1, 0]) - SAMPLED_RATE) / 10)


def continuous_error(adapter: Adapter, spelling: str, timestep: float) -> float:
    """Return the error (rad) of the hinge under the continuous law."""
    return abs(float(joints_after(adapter, hinge(PD), spelling, timestep, [0.0, DURATION])[0][1, 0]) - CONTINUOUS)


def arm(rate: float | None) -> Mechanism:
    """Return an arm of a driven and a passive joint about skew axes, which starts turned and moving, without gravity.

    The driven joint is the second in the file, and its child is the body on the world.
    """
    links = (body("lower", 0.7, (0.01, 0.02, 0.01), (0.15, 0.0, 0.05)), body("upper", 1.0, (0.01, 0.02, 0.03), (0.2, 0.0, 0.0)))
    return Mechanism(
        links,
        (
            Joint("elbow", "revolute", 1, 0, (0.4, 0.0, 0.0), axis=(1.0, 2.0, 0.0), start=(0.3,), start_velocity=(0.5,)),
            Joint("shoulder", "revolute", WORLD, 1, axis=(0.6, 0.8, 0.0), start=(0.4,), start_velocity=(-0.7,), effort=0.3),
        ),
        controllers=(Controller(1, kp=30.0, kd=1.0, target=Sine(0.5, 4.0), effort=Sine(0.3, 7.0, 1.0), rate=rate),),
    )


def arm_errors(adapter: Adapter, spelling: str, rate: float | None, steps: Sequence[float]) -> Array:
    """Return the largest errors (n,) of the coordinates (rad) of the arm at the end of runs with n time steps (s)."""
    mechanism = arm(rate)
    truth = kinematics.joints(mechanism, mechanism_truth(mechanism, np.array([0.0, DURATION]), vouched=False).trajectory)
    runs = (joints_after(adapter, mechanism, spelling, step, [0.0, DURATION])[0][1] for step in steps)
    return np.array([np.abs(run - truth.position[1]).max() for run in runs])


def slide(stops: Stops, axis: Vector = (0.0, 0.6, 0.8), driven: bool = True) -> Mechanism:
    """Return a body of 2 kg that slides down along an axis onto its lower stop; if driven, upwards, but too weakly to stay."""
    joint = Joint("rail", "prismatic", WORLD, 0, axis=axis, start=(0.1,), start_velocity=(0.0,), stops=stops)
    controllers = (Controller(0, law="effort", effort=4.0, rate=100.0),) if driven else ()
    return Mechanism((body("block", 2.0, (0.01, 0.02, 0.03)),), (joint,), gravity=9.81, controllers=controllers)


def landing(adapter: Adapter, spelling: str, timestep: float, mechanism: Stops | Mechanism) -> tuple[float, float, float]:
    """Return how far (m) a body is beyond its lower stop at most and at the end, and its last speed (m/s), after 0.5 s.

    mechanism: as `slide` returns it, or its stops.
    """
    falling = slide(mechanism) if isinstance(mechanism, Stops) else mechanism
    stops = falling.joints[0].stops
    assert stops is not None
    assert stops.lower is not None
    times = np.arange(0.0, 0.5, 0.005)
    position, velocity = joints_after(adapter, falling, spelling, timestep, times.tolist())
    beyond = stops.lower - position[:, 0]
    return float(beyond.max()), float(beyond[-1]), float(velocity[-1, 0])


def turned_against_a_stop(adapter: Adapter, spelling: str, timestep: float, stops: Stops) -> tuple[Array, Array]:
    """Return angles and rates (n,) of the hinge every 10 ms for 0.2 s, from 2 rad/s under a constant effort of 0.05 N m."""
    stopped = hinge(Controller(0, law="effort", effort=0.05, rate=100.0), stops=stops, rate=2.0)
    position, velocity = joints_after(adapter, stopped, spelling, timestep, np.arange(0.0, 0.205, 0.01).tolist())
    return position[:, 0], velocity[:, 0]
