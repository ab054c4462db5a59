"""Output for GitHub workflows: annotations at lines of case files, and the summary of a step."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Literal

from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case
from bodycheck.casefile.toml_positions import positions
from bodycheck.judging import advice
from bodycheck.judging.judgement import Judged, Verdict
from bodycheck.results.unchecked import Unchecked

#: The most bytes of the summary of a step.
LARGEST_SUMMARY = 1 << 20

#: The last line of a summary that was cut.
CUT = "\n*The rest was cut because the summary of a step has a limited size.*\n"


def is_running(environment: Mapping[str, str]) -> bool:
    """Return whether this process runs in a step of a GitHub workflow."""
    return environment.get("GITHUB_ACTIONS") == "true"


def annotations(
    verdicts: Iterable[Verdict], cases: Mapping[str, Case], files: Mapping[str, Path], environment: Mapping[str, str]
) -> Iterator[str]:
    """Yield an annotation for each broken or known discrepancy, and for each run without expectations that failed.

    The annotation of a broken expectation also gives the next steps, each on its own line.

    Parameters
    ----------
    verdicts
        The verdicts.
    cases, files
        The cases, and the files from which they were read, by the name of the case.
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
    """Return the message about an expectation: the result and, if the expectation does not hold, the next steps."""
    if judged.held:
        return judged.text
    name = verdict.run.case if file is None else file
    steps = advice.steps(verdict, judged, name, f"its [[expect]] in {name}")
    return "\n".join([judged.text, *(f"{step.why}: {step.what}" for step in steps)])


def unchecked_annotations(
    unchecked: Iterable[Unchecked], cases: Mapping[str, Case], files: Mapping[str, Path], environment: Mapping[str, str]
) -> Iterator[str]:
    """Yield an annotation for each expectation that could not be checked. For the other arguments, see `annotations`."""
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
    """Return the workflow command for an annotation. Without a file, the annotation appears only in the workflow summary."""
    place = {} if file is None else {"file": file} | ({} if line is None else {"line": str(line)})
    properties = ",".join(f"{name}={_property(value)}" for name, value in {**place, "title": title}.items())
    return f"::{kind} {properties}::{_data(message)}"


def add_summary(environment: Mapping[str, str], text: str) -> None:
    """Append as many whole lines of Markdown to the summary of this step as fit. Raises `OSError` if that fails."""
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
    except ValueError:  # the file is outside the repository
        return file.as_posix()


def _data(text: str) -> str:
    """Return a text with escapes, so that it neither ends a workflow command nor begins another."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
