"""The pytest plug-in: case files are tests, an item for each engine x method of which a case expects something.

Everyone who has bodycheck installed loads this module with every run of pytest. Nothing but pytest is imported here before a
case file is collected.

Engines run in a process of their own, which is kept for the session: a crash is a failed test, and only the first one waits for
the imports.
"""

import keyword
import os
import shlex
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from bodycheck.adapters.contract import Method
    from bodycheck.casefile.case import Case
    from bodycheck.judging.judgement import Judged, Verdict
    from bodycheck.running.campaign import TruthTask
    from bodycheck.running.plan import Task

    Perform = Callable[[Task | TruthTask], Any]

SUFFIX = ".case.toml"
OPTION = "--bodycheck-engine"
MARKER = "bodycheck"
#: Name of the property that tells of a known discrepancy.
KNOWN = "known"

#: Runs and truths that are kept, so that the items of a case share them.
KEPT = 32

OWN_MARKERS = pytest.StashKey[set[str]]()
TAKEN_MARKERS = pytest.StashKey[set[str]]()
PERFORM = pytest.StashKey["Perform"]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.getgroup("bodycheck").addoption(
        OPTION,
        action="append",
        default=[],
        metavar="ENGINE",
        help="of the tests in case files, run only those of this engine; may be given several times",
    )


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    # Looked at before plug-ins add theirs: what is here is the user's own.
    config.stash[OWN_MARKERS] = _markers(config)
    config.addinivalue_line("markers", f"{MARKER}: a test in a case file of bodycheck")
    if engines := config.getoption(OPTION):
        from bodycheck.adapters import registry

        for engine in engines:
            try:
                registry.load(engine)
            except registry.EngineMissing as error:
                raise pytest.UsageError(f"{OPTION}: {error}") from error


def pytest_sessionstart(session: pytest.Session) -> None:
    own: set[str] = session.config.stash[OWN_MARKERS]
    session.config.stash[TAKEN_MARKERS] = _markers(session.config) - own


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    return CaseFile.from_parent(parent, path=file_path) if file_path.name.endswith(SUFFIX) else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    engines = config.getoption(OPTION)
    others = [item for item in items if engines and isinstance(item, CaseItem) and item.engine not in engines]
    if others:
        config.hook.pytest_deselected(items=others)
        items[:] = [item for item in items if item not in others]


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    # As a marker, and before pytest looks at markers: then what is skipped is told with its place in the case file.
    if isinstance(item, CaseItem) and (missing := _missing(item.engine)) is not None:
        item.add_marker(pytest.mark.skip(reason=missing))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    told = [
        (report.nodeid, text)
        for report in terminalreporter.getreports("passed")
        for name, text in report.user_properties
        if name == KNOWN and report.nodeid.partition("::")[0].endswith(SUFFIX)
    ]
    if told:
        terminalreporter.section("discrepancies that the case files call known")
        for nodeid, text in told:
            terminalreporter.line(f"{nodeid}: {text}")


class CaseFile(pytest.File):
    """A case file."""

    def collect(self) -> "Iterator[CaseItem]":
        from bodycheck.casefile.case import CaseFaults, load
        from bodycheck.casefile.toml_positions import positions

        shown = _shown(self.path, self.config)
        try:
            case = load(self.path)
        except CaseFaults as error:
            faults = "\n".join(str(replace(fault, file=shown)) for fault in error.faults)
            raise self.CollectError(faults) from error
        places = positions(case.text, [("expect", index) for index in range(len(case.expectations))])
        lines = [places["expect", index].line for index in range(len(case.expectations))]
        marks = [tag for tag in case.tags if _may_be_marker(tag, self.config.stash[TAKEN_MARKERS])]
        for mark in marks:
            self.config.addinivalue_line("markers", f"{mark}: a tag of case files")
        methods: dict[tuple[str, Method], int] = {}
        for expectation, line in zip(case.expectations, lines, strict=True):
            methods.setdefault((expectation.engine, expectation.method), line)
        for (engine, method), line in methods.items():
            name = f"{engine}-{method.name}-{method.timestep!r}"
            item = CaseItem.from_parent(self, name=name, case=case, engine=engine, method=method, line=line, lines=lines)
            for mark in (MARKER, *marks):
                item.add_marker(mark)
            item.extra_keyword_matches |= {case.name, *case.tags}
            yield item


class CaseItem(pytest.Item):
    """What a case expects of one engine and method. line: of the first such expectation. lines: of all in the case."""

    def __init__(self, *, case: "Case", engine: str, method: "Method", line: int, lines: list[int], **more: Any) -> None:
        super().__init__(**more)
        self.case, self.engine, self.method, self.line, self.lines = case, engine, method, line, lines

    def runtest(self) -> None:
        from bodycheck.adapters import offers, registry

        offers.check(registry.load(self.engine).engine, self.method)
        verdict = _verdict(self.case, self.engine, self.method, _perform(self.config))
        figures = [(name, value) for name, value in verdict.row().items() if name not in ("passed", "reason")]
        known = [(KNOWN, judged.text) for judged in verdict.judged if judged.expectation.known and judged.held]
        self.user_properties += [(name, _printable(str(value))) for name, value in figures + known]
        if not verdict.passed:
            raise Broken(verdict)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        from bodycheck.errors import BadInput

        match excinfo.value:
            case Broken(verdict=verdict):
                return self._explained(verdict)
            case BadInput() as error:
                return f"{_shown(self.path, self.config)}:{self.line}: integrator: {error}"
        return super().repr_failure(excinfo)

    def reportinfo(self) -> tuple[Path, int, str]:
        method = f"{self.engine} {self.method.name}, time step {self.method.timestep:g} s"
        return self.path, self.line - 1, f"{self.case.name}: {method}"

    def _explained(self, verdict: "Verdict") -> str:
        """A verdict in words that need no manual."""
        run, shown = verdict.run, _shown(self.path, self.config)
        broken = [judged for judged in verdict.judged if not judged.held]
        method = f"integrator {run.method.name}, time step {run.method.timestep:g} s"
        command = ("bodycheck", "run", shown, "--engine", run.engine, "--integrator", run.method.name)
        lines = [
            # The first line is what pytest's summary shows.
            "; ".join(f"{b.name} is {b.measured}, expected {b.expected}" for judged in broken for b in judged.breaches),
            "",
            f"{self.case.name}, simulated by {run.engine} {run.version} ({method}) and held against mechanics:",
        ]
        for judged in broken:
            lines += ["", *_told(judged, f"{shown}:{self.lines[self.case.expectations.index(judged.expectation)]}")]
        lines += ["", f"All figures and curves: {shlex.join(command)} --timestep {run.method.timestep!r} --out results"]
        return "\n".join(map(_printable, lines))


class Broken(Exception):
    """A verdict that says that something expected does not hold."""

    def __init__(self, verdict: "Verdict") -> None:
        super().__init__(verdict.reason)
        self.verdict = verdict


def _told(judged: "Judged", place: str) -> Iterator[str]:
    from bodycheck.figures.columns import EXPECTED

    expectation = judged.expectation
    for breach in judged.breaches:
        yield f"{place}: {breach.name}, {EXPECTED[breach.name].told}"
        yield f"    expected  {breach.expected}"
        yield f"    measured  {breach.measured}"
        yield from (f"              {note}" for note in breach.notes)
        if expectation.known:
            yield f"    known     {expectation.known}, tolerated until {expectation.until}"


def _verdict(case: "Case", engine: str, method: "Method", perform: "Perform") -> "Verdict":
    """The verdict on a run that is made now, with the truth and the finer runs that it takes."""
    from bodycheck.adapters import registry
    from bodycheck.casefile.expectation import REFINEMENTS
    from bodycheck.judging.judgement import verdict
    from bodycheck.reference.truth import NoTruth, Truth
    from bodycheck.running.campaign import TruthTask
    from bodycheck.running.outcome import Run
    from bodycheck.running.plan import Task

    def run(method: "Method") -> Run:
        made = perform(Task(case, engine, method))
        return made if isinstance(made, Run) else Run(case.name, engine, registry.load(engine).engine.version, method, made)

    truth = perform(TruthTask(case, method.timestep))
    concerned = [e for e in case.expectations if e.concerns(engine, method)]
    finer = REFINEMENTS if any(expectation.needs_order for expectation in concerned) else ()
    return verdict(
        case,
        truth if isinstance(truth, Truth) else NoTruth(f"the reference: {truth.reason}"),
        run(method),
        [run(method.at(method.timestep / by)) for by in finer],
    )


def _perform(config: pytest.Config) -> "Perform":
    """What makes runs and truths in the process that is kept for the session."""
    if PERFORM not in config.stash:
        from bodycheck.running import campaign, pool

        stack = ExitStack()
        config.add_cleanup(stack.close)
        call = stack.enter_context(pool.caller(campaign.perform, campaign.TIME_LIMIT))
        kept: Perform = lru_cache(KEPT)(call)
        config.stash[PERFORM] = kept
    return config.stash[PERFORM]


def _missing(engine: str) -> str | None:
    """Why an engine cannot be used here; None where it can."""
    from bodycheck.adapters import registry

    try:
        registry.load(engine)
    except registry.EngineMissing as error:
        return str(error)
    return None


def _may_be_marker(tag: str, taken: set[str]) -> bool:
    """Whether a tag of a case file may be a marker.

    Tags come from strangers, and some markers do things, such as skip and xfail. taken: those that pytest and its plug-ins
    have registered; the user's own are not among them.
    """
    return tag.isidentifier() and not keyword.iskeyword(tag) and not tag.startswith("_") and tag not in taken


def _markers(config: pytest.Config) -> set[str]:
    """The names of all markers that are registered so far."""
    return {line.partition(":")[0].partition("(")[0].strip() for line in config.getini("markers")}


def _shown(path: Path, config: pytest.Config) -> str:
    """A path as the user would write it."""
    try:
        return os.path.relpath(path, config.invocation_params.dir)
    except ValueError:  # on another drive
        return str(path)


def _printable(text: str) -> str:
    """What an engine may have said, with no character that commands a terminal or breaks a file."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode("ascii") for c in text)
