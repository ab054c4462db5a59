"""The contents of a study's report, before they are laid out: sentences, tables and charts under headings."""

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
        Description for readers who do not see the chart.
    notes
        Sentences below the chart.
    """

    title: str
    specification: Spec
    alt: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Animation:
    """Motions that the player shows beside each other.

    Parameters
    ----------
    title
        Title above the animation.
    data
        What the player reads; None if there is no animation, in which case a note says why.
    alt
        Description for readers who do not see it.
    notes
        Sentences below the animation.
    """

    title: str
    data: Mapping[str, Any] | None
    alt: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Part:
    """A part of the report under a heading of its own.

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
        Methods that the reader can switch off. The charts then have a parameter `hidden`, a list of the labels switched off.
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
        Sentences that limit what the report says.
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
