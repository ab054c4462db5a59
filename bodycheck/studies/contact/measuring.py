"""Make runs and probes in worker processes, and record their figures in a journal, so that an interrupted study is resumed."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.offers import not_modelled
from bodycheck.casefile.content import Case
from bodycheck.console.progress import progress
from bodycheck.figures.columns import FIGURES
from bodycheck.judging.discrepancy import compare
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.journal import Journal, Record
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Run
from bodycheck.results.records import LOST
from bodycheck.results.store import Results
from bodycheck.running import campaign
from bodycheck.running.tasks import Task, Truths
from bodycheck.studies.contact.calls import Call, ProbeCall, Properties
from bodycheck.studies.contact.property import Property
from bodycheck.studies.contact.sheet import SUBJECTS

#: Worker processes that make calls, as `calls.make` does.
Workers = pool.Workers[Call, Properties | Run | Truths]


@dataclass(frozen=True)
class Measured:
    """The figures of a run.

    Attributes
    ----------
    status, reason
        How the run ended, and why it is not ok.
    contact_terms
        What the engine was handed in the place of friction and restitution.
    figures
        The figures of the sheet, and the bounds of the truth in them, by column; empty if the run is not ok.
    """

    status: str
    reason: str = ""
    contact_terms: str = ""
    figures: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Bench:
    """The measurements of a study, which are made where they are asked for, and once.

    Attributes
    ----------
    results
        The runs at the defaults of engines, with their truths.
    engines
        The records of the engines by name.
    log
        The journal.
    workers
        The worker processes.
    quiet
        Whether no progress is shown.
    runs, probes
        The measurements that were made so far.
    truths
        The truths that the results do not have, by the name of the case and by sampling.
    """

    results: Results
    engines: Mapping[str, Engine]
    log: Journal
    workers: Workers
    quiet: bool
    runs: dict[RunKey, Measured] = field(default_factory=dict)
    probes: dict[ProbeCall, Properties | str] = field(default_factory=dict)
    truths: dict[tuple[str, float], Truth | NoTruth] = field(default_factory=dict)

    def recall(self) -> None:
        """Take over the measurements that the journal had when it was opened."""
        for record in self.log.records:
            if record["record"] == "run":
                self.runs[RunKey.of_row(record)] = Measured(**record["measured"])
            else:
                properties = tuple(Property(**one) for one in record["properties"])
                call = ProbeCall(record["engine"], Method.parse(record["integrator"], record["timestep"]), record["probe"])
                self.probes[call] = record["fault"] or properties

    def measure(self, tasks: Sequence[Task]) -> None:
        """Make the runs that have not been made yet."""
        left = [task for task in dict.fromkeys(tasks) if task.key not in self.runs]
        lacking = (not_modelled(self.engines[task.engine], task.case.scene, task.method) for task in left)
        self.compute_truths(task for task, reason in zip(left, lacking, strict=True) if reason is None)
        with progress("trying settings", len(left), self.quiet) as advance:
            for task, answer in self.workers.map(left):
                assert isinstance(task, Task)
                assert isinstance(answer, Run | Crashed | TimedOut)
                self.runs[task.key] = measured = self._compared(task, answer)
                self.log.add(
                    {**_named(task.engine, task.method), "record": "run", "case": task.case.name, "measured": asdict(measured)}
                )
                advance(f"{task.case.name} · {task.engine} {task.method}")

    def probe(self, calls: Sequence[ProbeCall]) -> None:
        """Make the probes that have not been made yet."""
        left = [call for call in dict.fromkeys(calls) if call not in self.probes]
        with progress("probing", len(left), self.quiet) as advance:
            for call, answer in self.workers.map(left):
                assert isinstance(call, ProbeCall)
                assert isinstance(answer, tuple | Crashed | TimedOut)
                fault, properties = ("", answer) if isinstance(answer, tuple) else (answer.reason, ())
                self.probes[call] = fault or properties
                record = {"record": "probe", "probe": call.probe, "properties": [asdict(one) for one in properties]}
                self.log.add({**_named(call.engine, call.method), **record, "fault": fault})
                advance(f"{call.probe} · {call.engine} {call.method}")

    def compute_truths(self, tasks: Iterable[Task]) -> None:
        """Compute the truths for runs that neither the results nor earlier calls have."""
        samplings: dict[Case, dict[float, None]] = defaultdict(dict)
        for task in tasks:
            key = task.case.name, task.method.sampling
            if key not in self.truths and self.results.ways(*key) is None:
                samplings[task.case][task.method.sampling] = None
        needed = [one for case, of_case in samplings.items() for one in campaign.truth_tasks(case, of_case)]
        for one, answer in self.workers.map(needed):
            assert not isinstance(one, Task | ProbeCall)
            assert isinstance(answer, dict | NoTruth | Crashed | TimedOut)
            for sampling in one.samplings:
                truth = answer[sampling] if isinstance(answer, dict) else NoTruth(answer.reason)
                self.truths[one.case.name, sampling] = truth

    def truth(self, case: Case, sampling: float) -> Truth | NoTruth:
        """Return the truth for the runs of a case with a sampling; it is in the results, or has been computed here."""
        if (case.name, sampling) not in self.truths:
            self.truths[case.name, sampling] = self.results.truth(case.name, sampling)
        return self.truths[case.name, sampling]

    def _compared(self, task: Task, answer: Run | Crashed | TimedOut) -> Measured:
        """Return the figures of a run, compared with the truth."""
        outcome = answer.outcome if isinstance(answer, Run) else answer
        if not isinstance(answer, Run) or not isinstance(outcome, Completed):
            return Measured(outcome.status, outcome.reason)
        truth = self.truth(task.case, task.method.sampling)
        if isinstance(truth, NoTruth):
            return Measured("unsupported", truth.reason)
        return Measured(Completed.status, "", outcome.contact_terms, of_sheet(compare(truth, answer).maxima()))


def of_sheet(maxima: Mapping[str, float]) -> dict[str, float]:
    """Return the figures of the sheet, and the bounds of the truth in them, of a run's figures by column."""
    bounds = {FIGURES[name].bounded_by for name in SUBJECTS}
    return {name: value for name, value in maxima.items() if name in SUBJECTS or name in bounds}


def is_lost(record: Record) -> bool:
    """Return whether the process of a recorded measurement died or exceeded a limit, so that it is repeated."""
    if record["record"] == "probe":
        return bool(record["fault"])
    return record["measured"]["status"] in LOST


def _named(engine: str, method: Method) -> dict[str, Any]:
    return {"engine": engine, "integrator": method.name, "timestep": method.timestep}
