"""The pytest plug-in: it collects case files as tests, with one item for each engine and method with expectations.

Every run of pytest loads this module if bodycheck is installed, so before it collects a case file it imports only pytest and
the functions that escape texts.

Each engine runs in one separate process per session, and so does the reference. If a process crashes, the test fails and the
session continues. Only the first test of each process waits for the imports.
"""

import keyword
import os
import shlex
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from bodycheck.casefile.finding import is_case_file
from bodycheck.runner_log import harmless, printable

if TYPE_CHECKING:
    from bodycheck.adapters.contract import Method
    from bodycheck.casefile.case import Case
    from bodycheck.judging.judgement import Judged, Verdict
    from bodycheck.running.plan import Task
    from bodycheck.running.tasks import TruthTask

    Perform = Callable[[Task | TruthTask], Any]

OPTION = "--bodycheck-engine"
ALLOW_OPTION = "--bodycheck-allow-missing"
MARKER = "bodycheck"
#: The setting that names files of robot models; see `bodycheck.studies.parity.collecting`.
MODELS = "bodycheck_models"
#: Names of the user properties of a test that describe a known discrepancy, and the reason why nothing was checked.
KNOWN_PROPERTY = "known"
UNCHECKED_PROPERTY = "not checked"
#: Name of the user property of a test with an engine of which the test has a result.
ENGINE_PROPERTY = "engine"
#: Sections of the summary of a session, by the name of the property and the outcome of the tests that they list.
SUMMARIES = {
    (KNOWN_PROPERTY, "passed"): "known discrepancies according to the case files",
    (UNCHECKED_PROPERTY, "skipped"): "expectations that were not checked",
}

#: Number of runs and truths that are cached, so that the items of a case share them.
MAX_CACHED_RESULTS = 32

OWN_MARKERS = pytest.StashKey[set[str]]()
FOREIGN_MARKERS = pytest.StashKey[set[str]]()
PERFORM_KEY = pytest.StashKey["Perform"]()
#: The case files without expectations that were collected in this process, or in the worker processes of xdist.
BARE_FILES = pytest.StashKey[dict[str, None]]()
#: The key under which a worker process of xdist passes these files to the main process.
BARE_OUTPUT = "bodycheck_bare_files"
#: Whether tests of engines were collected in this process, or in the worker processes of xdist, and its key there.
COLLECTED, COLLECTED_OUTPUT = pytest.StashKey[bool](), "bodycheck_collected"
#: The reports of these tests: for each engine of a test, whether the test passed.
ROWS = pytest.StashKey[list[dict[str, Any]]]()
#: A sentence for each engine that is named and has no result.
LOST = pytest.StashKey[tuple[str, ...]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.getgroup("bodycheck").addoption(
        ALLOW_OPTION,
        action="store_true",
        help="Skip the tests in case files whose engines are not installed. By default they fail.",
    )
    parser.getgroup("bodycheck").addoption(
        OPTION,
        action="append",
        default=[],
        metavar="ENGINE",
        help="Run only tests of this engine in case files. May be given several times.",
    )
    parser.addini(MODELS, "Patterns of files of robots, relative to the root folder, that are compared with engines.", "args")


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    # This hook runs before plug-ins register their markers, so all markers are those of the user.
    config.stash[OWN_MARKERS] = _markers(config)
    config.stash[BARE_FILES] = {}
    config.stash[COLLECTED], config.stash[ROWS], config.stash[LOST] = False, [], ()
    config.addinivalue_line("markers", f"{MARKER}: a test in a case file of bodycheck")
    if engines := config.getoption(OPTION):
        from bodycheck.running.engines import faults

        config.pluginmanager.register(_Reports(config.stash[ROWS]))
        for fault in faults(engines).values():
            raise pytest.UsageError(f"{OPTION}: {fault.reason}")


def pytest_sessionstart(session: pytest.Session) -> None:
    markers: set[str] = session.config.stash[OWN_MARKERS]
    session.config.stash[FOREIGN_MARKERS] = _markers(session.config) - markers


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    kind: type[pytest.File] = CaseFile
    if patterns := parent.config.getini(MODELS):
        from bodycheck.studies.parity import collecting

        kind = collecting.ModelFile if collecting.is_named(file_path, parent.config.rootpath, patterns) else CaseFile
    if kind is CaseFile and not is_case_file(file_path):
        return None
    file = kind.from_parent(parent, path=file_path)
    # pytest prints the path of a file; the runner of a CI system must find no command in it.
    nodeid = harmless(file.nodeid)
    return file if nodeid == file.nodeid else kind.from_parent(parent, path=file_path, nodeid=nodeid)


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    engines = config.getoption(OPTION)
    config.stash[COLLECTED] = any(getattr(item, "of_engines", False) for item in items)
    others = [item for item in items if engines and isinstance(item, CaseItem) and item.engine not in engines]
    if others:
        config.hook.pytest_deselected(items=others)
        items[:] = [item for item in items if item not in others]


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    # The marker is added before pytest evaluates markers, so that skipped tests are reported with their line in the file.
    if isinstance(item, CaseItem):
        from bodycheck.casefile.case import is_shipped
        from bodycheck.results.unchecked import SHIPPED
        from bodycheck.running.engines import faults

        for fault in faults([item.engine]).values():
            if fault.broken:  # the case has expectations of the engine
                pytest.fail(fault.reason, pytrace=False)
            allowed = ALLOW_OPTION if item.config.getoption(ALLOW_OPTION) else SHIPPED if is_shipped(item.path) else ""
            if allowed:
                item.user_properties.append((UNCHECKED_PROPERTY, f"{fault.reason} ({allowed})"))
                item.add_marker(pytest.mark.skip(reason=f"not checked ({allowed}): {fault.reason}"))
            item.missing = fault.reason


def pytest_sessionfinish(session: pytest.Session) -> None:
    if (output := getattr(session.config, "workeroutput", None)) is not None:  # this is a worker process of xdist
        bare: dict[str, None] = session.config.stash[BARE_FILES]
        output[BARE_OUTPUT] = list(bare)
        output[COLLECTED_OUTPUT] = session.config.stash[COLLECTED]
    elif engines := session.config.getoption(OPTION):
        _decide(session, tuple(engines))


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    files: list[str] = getattr(node, "workeroutput", {}).get(BARE_OUTPUT, [])
    bare: dict[str, None] = node.config.stash[BARE_FILES]
    bare.update(dict.fromkeys(files))
    if getattr(node, "workeroutput", {}).get(COLLECTED_OUTPUT, False):
        node.config.stash[COLLECTED] = True


class _Reports:
    """The plug-in of one session that keeps what its reports say of engines."""

    def __init__(self, rows: list[dict[str, Any]]) -> None:
        self.rows = rows

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        engines = [value for name, value in report.user_properties if name == ENGINE_PROPERTY]
        if report.when == "call":
            status = "ok" if report.passed else "failed"
            self.rows += [{"engine": engine, "status": status, "reason": report.nodeid} for engine in engines]


def _decide(session: pytest.Session, engines: tuple[str, ...]) -> None:
    """Make a session fail in which tests of engines were collected, but none of a named engine was made."""
    if not session.config.stash[COLLECTED] or session.config.getoption("collectonly"):
        return
    from bodycheck.running.named import Named, decide

    rows: list[dict[str, Any]] = session.config.stash[ROWS]
    decision = decide(Named(engine=engines), rows)
    session.config.stash[LOST] = decision.lost
    if decision.lost and session.exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: Any) -> None:
    for (name, outcome), title in SUMMARIES.items():
        sentences = [
            f"{report.nodeid}: {text}"
            for report in terminalreporter.getreports(outcome)
            # A module that is skipped as a whole has only the report of its collection, which has no properties.
            for property, text in getattr(report, "user_properties", ())
            if property == name and is_case_file(report.nodeid.partition("::")[0])
        ]
        _tell(terminalreporter, title, sentences)
    bare: dict[str, None] = terminalreporter.config.stash[BARE_FILES]
    _tell(terminalreporter, "case files collected without expectations", bare)
    lost: tuple[str, ...] = terminalreporter.config.stash[LOST]
    _tell(terminalreporter, f"engines without a result ({OPTION})", lost)


def _tell(terminalreporter: Any, title: str, lines: Collection[str]) -> None:
    """Add a section to the summary of a session, unless it has no lines."""
    if lines:
        terminalreporter.section(title)
        for line in lines:
            terminalreporter.line(line)


class CaseFile(pytest.File):
    """The collector of one case file."""

    def collect(self) -> "Iterator[CaseItem]":
        from bodycheck.casefile.case import CaseFaults, load
        from bodycheck.casefile.toml_positions import positions

        shown = _user_path(self.path, self.config)
        try:
            case = load(self.path)
        except CaseFaults as error:
            faults = printable("\n".join(str(replace(fault, file=shown)) for fault in error.faults))
            raise self.CollectError(faults) from error
        if not case.expectations:
            self.config.stash[BARE_FILES][self.nodeid] = None
        places = positions(case.text, [("expect", index) for index in range(len(case.expectations))])
        lines = [places["expect", index].line for index in range(len(case.expectations))]
        marks = [tag for tag in case.tags if _may_be_marker(tag, self.config.stash[FOREIGN_MARKERS])]
        for mark in marks:
            self.config.addinivalue_line("markers", f"{mark}: a tag of case files")
        methods: dict[tuple[str, Method], int] = {}
        for expectation, line in zip(case.expectations, lines, strict=True):
            methods.setdefault((expectation.engine, expectation.method), line)
        for (engine, method), line in methods.items():
            name = harmless(f"{engine}-{method.name}-{method.timestep!r}")
            item = CaseItem.from_parent(self, name=name, case=case, engine=engine, method=method, line=line, lines=lines)
            for mark in (MARKER, *marks):
                item.add_marker(mark)
            item.extra_keyword_matches |= {case.name, *case.tags}
            yield item


class CaseItem(pytest.Item):
    """A test of what a case expects of one engine and method.

    `line` is the line of the first such expectation in the file, and `lines` are the lines of all expectations of the case.
    `missing` says why the engine is not available. It is empty if the engine is available, and before the test is set up.
    `of_engines` distinguishes tests of engines from all others.
    """

    of_engines = True

    def __init__(self, *, case: "Case", engine: str, method: "Method", line: int, lines: list[int], **more: Any) -> None:
        super().__init__(**more)
        self.case, self.engine, self.method, self.line, self.lines = case, engine, method, line, lines
        self.missing = ""

    def runtest(self) -> None:
        if self.missing:
            pytest.fail(f"not checked: {self.missing}; install it, or accept this with {ALLOW_OPTION}", pytrace=False)
        from bodycheck.adapters import offers
        from bodycheck.running import engines

        offers.check(engines.record(self.engine), self.method)
        verdict = _verdict(self.case, self.engine, self.method, _perform(self.config))
        figures = [(name, value) for name, value in verdict.row().items() if name not in ("passed", "reason")]
        known = [(KNOWN_PROPERTY, judged.text) for judged in verdict.judged if judged.expectation.known and judged.held]
        self.user_properties += [(name, printable(str(value))) for name, value in figures + known]
        if not verdict.passed:
            raise Broken(verdict)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        from bodycheck.errors import BadInput

        match excinfo.value:
            case Broken(verdict=verdict):
                return self._explained(verdict)
            case BadInput() as error:
                return printable(f"{_user_path(self.path, self.config)}:{self.line}: integrator: {error}")
        return super().repr_failure(excinfo)

    def reportinfo(self) -> tuple[Path, int, str]:
        method = f"{self.engine} {self.method.name}, time step {self.method.timestep:g} s"
        return Path(harmless(str(self.path))), self.line - 1, harmless(f"{self.case.name}: {method}")

    def _explained(self, verdict: "Verdict") -> str:
        """Return the message of a failed test: expected and measured values, the lines, and how to see all figures."""
        from bodycheck.adapters.engine_name import in_words
        from bodycheck.judging.advice import steps

        run, shown = verdict.run, _user_path(self.path, self.config)
        broken = [judged for judged in verdict.judged if not judged.held]
        method = f"integrator {run.method.name}, time step {run.method.timestep:g} s"
        command = ("bodycheck", "run", shown, "--engine", run.engine, "--integrator", run.method.name)
        lines = [
            # pytest's summary shows the first line.
            "; ".join(f"{b.name} is {b.measured}, expected {b.expected}" for judged in broken for b in judged.breaches),
            "",
            f"{self.case.name}, simulated by {in_words(run.engine, run.version)} ({method}) and compared with mechanics:",
        ]
        for judged in broken:
            where = f"{shown}:{self.lines[self.case.expectations.index(judged.expectation)]}"
            lines += ["", *_breach_lines(judged, where)]
            if judged.expectation.version:
                lines.append(f"    versions  {judged.expectation.version} when it was written, {run.version} now")
            for step in steps(verdict, judged, shown, where):
                lines += [f"    {step.why}:", f"        {step.what}"]
        lines += ["", f"All figures and curves: {shlex.join(command)} --timestep {run.method.timestep!r} --out results"]
        return printable("\n".join(lines))


class Broken(Exception):
    """Raised for a verdict that an expectation does not hold."""

    def __init__(self, verdict: "Verdict") -> None:
        super().__init__(verdict.reason)
        self.verdict = verdict


def _breach_lines(judged: "Judged", where: str) -> Iterator[str]:
    from bodycheck.figures.columns import EXPECTED

    expectation = judged.expectation
    for breach in judged.breaches:
        meaning = EXPECTED[breach.name].told if breach.name in EXPECTED else "largest error of the sensor"
        yield f"{where}: {breach.name}, {meaning}"
        yield f"    expected  {breach.expected}"
        yield f"    measured  {breach.measured}"
        yield from (f"              {note}" for note in breach.notes)
        if expectation.known:
            yield f"    known     {expectation.known}, tolerated until {expectation.until}"


def _verdict(case: "Case", engine: str, method: "Method", perform: "Perform") -> "Verdict":
    """Make a run, its truth and, if an order is expected, runs with smaller time steps; return the verdict on the run."""
    from bodycheck.casefile.expectation import REFINEMENTS
    from bodycheck.judging.judgement import verdict
    from bodycheck.results.outcome import Run
    from bodycheck.running import engines
    from bodycheck.running.campaign import no_truth, truth_tasks
    from bodycheck.running.plan import Task

    def run(method: "Method") -> Run:
        answer = perform(Task(case, engine, method))
        return answer if isinstance(answer, Run) else Run(case.name, engine, engines.record(engine).version, method, answer)

    # All tests of a case need the same truths, which are computed once.
    samplings = [expectation.method.sampling for expectation in case.expectations]
    truths = perform(next(task for task in truth_tasks(case, samplings) if method.sampling in task.samplings))
    truth = truths[method.sampling] if isinstance(truths, dict) else no_truth(truths)
    concerned = [e for e in case.expectations if e.concerns(engine, method)]
    finer = REFINEMENTS if any(expectation.needs_order for expectation in concerned) else ()
    return verdict(
        case,
        truth,
        run(method),
        [run(method.at(method.timestep / by)) for by in finer],
    )


def _perform(config: pytest.Config) -> "Perform":
    """Return the function that makes runs and truths in the processes of the session."""
    if PERFORM_KEY not in config.stash:
        from bodycheck.processes import pool
        from bodycheck.running import campaign, engines
        from bodycheck.running.tasks import group, perform

        stack = ExitStack()
        config.add_cleanup(stack.close)
        workers = pool.Workers(perform, 1, campaign.TIME_LIMIT_S, group=group, home=engines.home, kept=1)
        kept: Perform = lru_cache(MAX_CACHED_RESULTS)(stack.enter_context(workers).call)
        config.stash[PERFORM_KEY] = kept
    return config.stash[PERFORM_KEY]


def _may_be_marker(tag: str, taken: set[str]) -> bool:
    """Return whether a tag of a case file may become a marker.

    Case files may come from strangers, and some markers, such as skip and xfail, change the outcome of a test. A tag is
    therefore not allowed if its name is in `taken`, the markers that pytest and its plug-ins have registered. The user's own
    markers are allowed.
    """
    return tag.isidentifier() and not keyword.iskeyword(tag) and not tag.startswith("_") and tag not in taken


def _markers(config: pytest.Config) -> set[str]:
    """Return the names of all markers that are registered so far."""
    return {line.partition(":")[0].partition("(")[0].strip() for line in config.getini("markers")}


def _user_path(path: Path, config: pytest.Config) -> str:
    """Return a path relative to the folder in which pytest was started."""
    try:
        return os.path.relpath(path, config.invocation_params.dir)
    except ValueError:  # on another drive
        return str(path)
