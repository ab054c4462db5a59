"""Known issues of engines, each a thread of the engine's authors and users, and the results that show them."""

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import resources

from bodycheck.reports.quantities import QUANTITIES, number
from bodycheck.results.verdicts import SCENES
from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue, Entry, Scene, version_key
from bodycheck.site.cells import default_run, verdict


@dataclass(frozen=True)
class Issue:
    """A known issue.

    Parameters
    ----------
    engine, title, url
        The engine, a short description of the issue, and the address of the thread.
    scene, figure, integrator
        The scene, the column of results and the integrator that show the issue; if `integrator` is empty, the integrator is the
        one that the engine itself chooses.
    robot, cause, status
        The robot model, and the cause or the status of the rows of parity.csv that show the issue.
    audit
        The property of the audit that shows the issue.
    since, until
        The first and the last version that have the issue; empty if no earlier or no later version is known to be without it.
    """

    engine: str
    title: str
    url: str
    scene: str = ""
    figure: str = ""
    integrator: str = ""
    robot: str = ""
    cause: str = ""
    status: str = ""
    audit: str = ""
    since: str = ""
    until: str = ""

    def concerns(self, version: str) -> bool:
        """Return whether a version lies between `since` and `until`, and so has the issue."""
        late = not self.since or version_key(self.since) <= version_key(version)
        return late and (not self.until or version_key(version) <= version_key(self.until))

    @property
    def versions(self) -> str:
        """Return the versions that have the issue, in words; empty for all versions."""
        if self.since and self.until:
            return f"from {self.since} to {self.until}"
        return f"from {self.since}" if self.since else f"until {self.until}" if self.until else ""


@dataclass(frozen=True)
class Evidence:
    """A number that shows an issue, or shows that it is gone.

    Parameters
    ----------
    version
        The version of the engine.
    text
        The number with its unit, or the verdict on a run without a number.
    address
        The address of the raw row.
    """

    version: str
    text: str
    address: str


@cache
def issues() -> tuple[Issue, ...]:
    """Return the known issues in the order of their file."""
    text = (resources.files("bodycheck.site") / "known_issues.toml").read_text("utf-8")
    return tuple(Issue(**one) for one in tomllib.loads(text)["issue"])


def evidence(catalogue: Catalogue, issue: Issue) -> tuple[Evidence, ...]:
    """Return the evidence on an issue from the last version that has the issue, and from the first version after it."""
    by_version: dict[str, Evidence] = {}
    for found in _all(catalogue, issue):
        by_version[found.version] = found
    ordered = sorted(by_version, key=version_key)
    concerned = [version for version in ordered if issue.concerns(version)]
    later = [version for version in ordered if issue.until and version_key(version) > version_key(issue.until)]
    return tuple(by_version[version] for version in (*concerned[-1:], *later[:1]))


def _all(catalogue: Catalogue, issue: Issue) -> Iterator[Evidence]:
    """Yield all evidence on an issue; for each version, the newest evidence comes last."""
    if issue.scene:
        for version in catalogue.versions.get(issue.engine, ()):
            runs = [run for run in catalogue.runs.get((issue.engine, issue.scene), ()) if run.version == version]
            if issue.integrator:
                runs = [run for run in runs if run.get("integrator") == issue.integrator]
            if runs:
                run = default_run([run for run in runs if run.source is runs[-1].source])
                yield _of_run(run, catalogue.scenes[issue.scene], issue.figure)
    elif issue.robot:
        yield from _of_robot(catalogue, issue)
    else:
        for entry in catalogue.entries("audit.csv"):
            if (entry.engine, entry.get("property"), entry.get("value") is None) == (issue.engine, issue.audit, False):
                text = f"{entry.get('integrator')}: {number(entry.get('value'), 3)} {entry.get('unit') or ''}".rstrip()
                yield Evidence(entry.version, text, links.row(entry))


def _of_run(run: Entry, scene: Scene, figure: str) -> Evidence:
    value, quantity = run.get(figure), QUANTITIES[figure]
    text = f"{quantity.title.lower()} {quantity.with_unit(value)}" if value is not None else SCENES[verdict(run, scene)].title
    return Evidence(run.version, f"{text} with {run.get('integrator')}", links.row(run))


def _of_robot(catalogue: Catalogue, issue: Issue) -> Iterator[Evidence]:
    """Yield the evidence of each version on a robot model: the number of rows with the cause or the status of the issue."""
    counts: dict[str, list[Entry]] = {}
    for entry in catalogue.robots.get(issue.robot, ()):
        if entry.engine == issue.engine:
            own = counts.setdefault(entry.version, [])
            if (entry.get("cause") == issue.cause) if issue.cause else (entry.get("status") == issue.status):
                own.append(entry)
    for version, entries in counts.items():
        told = issue.cause or issue.status
        if entries:
            yield Evidence(version, f"{told}: {len(entries)} of its rows", links.row(entries[0]))
        else:
            yield Evidence(version, f"{told}: none of its rows", links.robot(issue.robot))
