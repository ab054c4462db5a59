"""The contents of a study's report before layout: sentences, tables and charts under headings."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bodycheck.reports.charts import Spec
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.tables import Table
from bodycheck.results.header import Header


@dataclass(frozen=True)
class Chart:
    """A chart with its data.

    Parameters
    ----------
    title
        Title above the chart.
    specification
        Complete Vega-Lite specification.
    alt
        Description for readers who cannot see the chart.
    notes
        Sentences below the chart.
    """

    title: str
    specification: Spec
    alt: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Animation:
    """Motions that the player shows side by side.

    Parameters
    ----------
    title
        Title above the animation.
    data
        The data that the player reads; None if there is no animation, in which case a note says why.
    alt
        Description for readers who cannot see the animation.
    notes
        Sentences below the animation.
    """

    title: str
    data: Mapping[str, Any] | None
    alt: str
    notes: tuple[str, ...] = ()


def animation_of(stored: Any) -> Animation:
    """Return an animation that was stored as a record. Raises `TypeError` and `KeyError` for anything else."""
    data = stored["data"]
    if not (data is None or isinstance(data, dict)):
        raise TypeError(f"the data of an animation is {data!r:.60}; allowed: an object or null")
    return Animation(str(stored["title"]), data, str(stored["alt"]), tuple(map(str, stored["notes"])))


@dataclass(frozen=True)
class Part:
    """A part of the report with its own heading.

    Parameters
    ----------
    name
        Name of the anchor, unique in the report.
    title
        The heading.
    texts
        Paragraphs.
    charts
        Charts after the paragraphs.
    tables
        Tables after the charts, each with its caption.
    lines
        Methods that the reader can switch off. The charts then have a parameter `hidden`, the list of the hidden labels.
    animations
        Animations after the tables.
    """

    name: str
    title: str
    texts: tuple[str, ...]
    charts: tuple[Chart, ...]
    tables: tuple[tuple[str, Table], ...]
    lines: tuple[Line, ...] = ()
    animations: tuple[Animation, ...] = ()


@dataclass(frozen=True)
class StudyReport:
    """The contents of a study's report.

    Parameters
    ----------
    title, headline
        The name of the study and its result in one sentence.
    header
        Versions, machine and command, as in the header of results.
    notices
        Sentences about the limits of the report.
    findings
        Findings; `where` of each is empty or the name of a part.
    parts
        The parts of the report, in order.
    reading
        Paragraphs that explain how to read the report.
    """

    title: str
    headline: str
    header: Header
    notices: tuple[str, ...]
    findings: tuple[Finding, ...]
    parts: tuple[Part, ...]
    reading: tuple[str, ...] = ()
