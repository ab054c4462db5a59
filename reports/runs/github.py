"""Output for workflows of GitHub: annotations at lines of case files, and the summary of a step."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Literal

from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case
from bodycheck.casefile.toml_positions import positions
from bodycheck.judging import advice
from bodycheck.judging.judgement import Judged, Verdict
from bodycheck.results.unchecked import Unchecked

#: Most bytes of the summary of one step.
LARGEST_SUMMARY = 1 << 20

#: Last line of a summary that does not fit.
CUT = "\n*The rest was cut because the summary of a step has a limited size.*\n"


def is_running(environment: Mapping[str, str]) -> bool:
    """Return whether this process is a step of a workflow."""
    return environment.get("GITHUB_ACTIONS") == "true"


def annotations(
    verdicts: Iterable[Verdict], cases: Mapping[str, Case], files: Mapping[str, Path], environment: Mapping[str, str]
) -> Iterator[str]:
    """Yield an annotation for each broken or known discrepancy, and for each run without expectations that failed.

    That of a broken expectation says what to do next, a step on each line.

    Parameters
    ----------
    verdicts
        The verdicts.
    cases, files
        Cases, and the files that they were read from, by the name of the case.
    environment
        Environment variables of the process.
    """
    root = Path(environment.get("GITHUB_WORKSPACE", "."))
    for verdict in verdicts:
        case, method = cases[verdict.run.case], verdict.run.method
        title = f"{verdict.run.engine} {method.name}, {method.timestep:g} s, on {case.name}"
        file = _seen_from(root, files[case.name]) if case.name in files else None
        if not verdict.judged and verdict.passed is False:
            yield annotation("error", verdict.reason, title, file)
        for judged in verdict.judged:
            if judged.text:
                path = ("expect", case.expectations.index(judged.expectation))
                line = positions(case.text, [path])[path].line
                yield annotation("notice" if judged.held else "error", _message(verdict, judged, file), title, file, line)


def _message(verdict: Verdict, judged: Judged, file: str | None) -> str:
    """Return what is said of an expectation: what was found and, if it does not hold, the steps that help."""
    if judged.held:
        return judged.text
    name = verdict.run.case if file is None else file
    steps = advice.steps(verdict, judged, name, f"its [[expect]] in {name}")
    return "\n".join([judged.text, *(f"{step.why}: {step.what}" for step in steps)])


def unchecked_annotations(
    unchecked: Iterable[Unchecked], cases: Mapping[str, Case], files: Mapping[str, Path], environment: Mapping[str, str]
) -> Iterator[str]:
    """Yield an annotation for each expectation that could not be checked; the arguments are those of `annotations`."""
    root = Path(environment.get("GITHUB_WORKSPACE", "."))
    for one in unchecked:
        case = cases[one.case]
        method = Method.parse(one.integrator, one.timestep)
        title = f"{one.engine} {one.integrator}, {one.timestep:g} s, on {case.name}"
        place = next(place for place, expected in enumerate(case.expectations) if expected.concerns(one.engine, method))
        line = positions(case.text, [("expect", place)])["expect", place].line
        file = _seen_from(root, files[case.name]) if case.name in files else None
        yield annotation("error" if one.failed else "notice", one.text, title, file, line)


def annotation(
    kind: Literal["error", "notice"], message: str, title: str, file: str | None = None, line: int | None = None
) -> str:
    """Return the command that makes an annotation. Without a file it appears only in the summary of the workflow."""
    place = {} if file is None else {"file": file} | ({} if line is None else {"line": str(line)})
    properties = ",".join(f"{name}={_property(value)}" for name, value in {**place, "title": title}.items())
    return f"::{kind} {properties}::{_data(message)}"


def add_summary(environment: Mapping[str, str], text: str) -> None:
    """Append Markdown to the summary of this step, with as many whole lines as fit. Raises `OSError`."""
    if not (name := environment.get("GITHUB_STEP_SUMMARY")):
        return
    path = Path(name)
    room = LARGEST_SUMMARY - (path.stat().st_size if path.exists() else 0)
    content = text.encode("utf-8", "replace")
    if len(content) > room:
        whole = content[: max(0, room - len(CUT))].rpartition(b"\n")[0]
        content = whole + CUT.encode() if whole else b""
    with path.open("ab") as stream:
        stream.write(content)


def _seen_from(root: Path, file: Path) -> str:
    try:
        return file.resolve().relative_to(root.resolve()).as_posix()
    except ValueError:  # the file is outside of the repository
        return file.as_posix()


def _data(text: str) -> str:
    """Return a text that neither ends a command nor begins one."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
