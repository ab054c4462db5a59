"""Plans: what is run of cases, engines, integrators and time steps, and what cannot be run."""

import math
from dataclasses import replace

import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.method import Method
from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.errors import BadInput
from bodycheck.running.plan import Task, plan
from tests.support.cases import shortened


def test_the_plan_is_every_case_engine_integrator_and_step_once() -> None:
    records = {name: registry.load(name).engine for name in ("mujoco", "pinocchio")}
    cases = [shortened(load(name), 1.0, 11) for name in ("free-brick", "projectile")]
    everything = plan(cases, records, (), (0.01, 0.02, 0.01))
    integrators = sum(len(offers.offered(record, cases[0].scene)) for record in records.values())
    assert len(everything) == len(set(everything)) == 2 * integrators * 2
    assert {task.method.timestep for task in plan(cases, records, (), ())} == {0.002}
    assert {task.engine for task in plan(cases, records, ("rk4",), ())} == {"pinocchio"}


def test_what_a_case_expects_is_run_too() -> None:
    method = Method.parse("RK4:model=everything", 0.01)
    expectation = Expectation("mujoco", method, (Limit("position_error", None, 1.0),))
    case = replace(load("projectile"), expectations=(expectation,))
    records = {"mujoco": registry.load("mujoco").engine}
    (task,) = [task for task in plan([case], records, (), ()) if task.method.timestep == 0.01]
    assert task == Task(case, "mujoco", method)
    assert not [task for task in plan([case], records, ("Euler",), ()) if task.method.timestep == 0.01]


@pytest.mark.parametrize(
    ("spelling", "words"),
    [("RK9", "has no integrator 'RK9'"), ("RK4:cone=elliptc", "read 'elliptc'; allowed: elliptic or pyramidal")],
)
def test_what_a_case_expects_of_a_misspelled_method_is_bad_input(spelling: str, words: str) -> None:
    expectation = Expectation("mujoco", Method.parse(spelling, 0.01), (Limit("position_error", None, 1.0),))
    case = replace(load("projectile"), expectations=(expectation,))
    with pytest.raises(BadInput, match=f"projectile: expect: integrator: .*{words}"):
        plan([case], {"mujoco": registry.load("mujoco").engine}, (), ())


@pytest.mark.parametrize("timestep", [0.0, -1.0, math.nan, math.inf, 100.0, 1e-12])
def test_time_steps_that_cannot_be_run_are_refused(timestep: float) -> None:
    with pytest.raises(BadInput, match="time step"):
        plan([load("free-brick")], {"mujoco": registry.load("mujoco").engine}, (), (timestep,))
