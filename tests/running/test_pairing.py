"""Runs meet their truths while both are in memory, in any order, and are forgotten where there is no room for them."""

from dataclasses import dataclass
from itertools import permutations
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.method import Method
from bodycheck.casefile.case import parse
from bodycheck.judging import judgement
from bodycheck.processes.failures import Crashed
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.outcome import Completed, Outcome, Run
from bodycheck.results.store import Results
from bodycheck.running import campaign, pairing
from bodycheck.running.pairing import Arrivals
from bodycheck.running.plan import plan
from tests.support.cases import shortened
from tests.support.processes import calls_here

KEY = ("spin", 0.1)


@dataclass
class Exact:
    """What is asked of a truth here."""

    trajectory: Trajectory


def states() -> Trajectory:
    return Trajectory(np.arange(3.0), np.zeros((3, 3)), np.zeros((3, 4)), np.zeros((3, 3)), np.zeros((3, 3)))


def run_of(integrator: str, outcome: Outcome) -> Run:
    return Run(KEY[0], "mujoco", "1", Method.parse(integrator, KEY[1]), outcome)


RUNS = {
    "Euler": run_of("Euler", Completed(states(), 2, 0.1)),
    "RK4": run_of("RK4", Completed(states(), 2, 0.1)),
    "implicit": run_of("implicit", Crashed("")),
}


def met(order: tuple[str, ...], exact: Exact | None) -> tuple[set[str], Arrivals]:
    """The methods of the runs that meet the truth if they arrive in an order, and what brought them together."""
    found: list[str] = []
    made = Arrivals(lambda truth, run: found.append(run.method.name), [KEY] * len(RUNS), [KEY])
    for name in order:
        if name == "truth":
            made.add_truth(KEY, cast("Truth | None", exact))
        else:
            made.add_run(RUNS[name])
    assert len(found) == len(set(found))
    return set(found), made


@pytest.mark.parametrize("order", [*permutations(("truth", *RUNS))])
def test_every_completed_run_meets_its_truth_once_and_nothing_is_kept(order: tuple[str, ...]) -> None:
    found, made = met(order, Exact(states()))
    assert found == {"Euler", "RK4"}
    assert (made._truths, made._runs, made._bytes) == ({}, {}, 0)
    found, made = met(order, None)
    assert not found
    assert (made._truths, made._runs, made._bytes) == ({}, {}, 0)


def test_what_there_is_no_room_for_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pairing, "MOST_BYTES", pairing._size(states()))
    assert met(("Euler", "RK4", "truth", "implicit"), Exact(states()))[0] == {"Euler"}
    monkeypatch.setattr(pairing, "MOST_BYTES", 0)
    assert met(("truth", "Euler", "RK4", "implicit"), Exact(states()))[0] == set()


def test_verdicts_are_those_from_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of runs that were compared while they were made no file is read, unless an order is expected."""
    expectation = '[[expect]]\nengine = "mujoco"\nintegrator = "{}"\ntimestep = 0.02\n{}\n'
    broken = expectation.format("Euler", "attitude_error = 1e-12") + expectation.format("RK4", "order = 4.0")
    case = parse(shortened(load("free-brick"), 1.0, 11).text.partition("[[expect]]")[0] + broken, "f")
    records = {"mujoco": registry.load("mujoco").engine}
    compared = judgement.Compared()
    tasks = plan([case], records, ("Euler", "RK4"), ())
    head = campaign.header(["test"], records, {})
    with calls_here(), campaign.results(tasks, tmp_path, head, meet=compared.meet) as results:
        assert len(compared.summaries) == len(tasks)
        read: list[float] = []
        truth = Results.truth

        def counted(self: Results, name: str, timestep: float) -> Truth | NoTruth:
            read.append(timestep)
            return truth(self, name, timestep)

        monkeypatch.setattr(Results, "truth", counted)
        early = judgement.judge(results, compared=compared)
        assert read == [0.02], "the truth of the run whose order is expected"
        assert judgement.records(early) == judgement.records(judgement.judge(results))
        assert any("the truth's own error is at most" in verdict.reason for verdict in early)
