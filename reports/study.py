"""The report of a study, before it is laid out: sentences, tables and charts under headings."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bodycheck.reports.charts import Spec
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.tables import Table


@dataclass(frozen=True)
class Chart:
    """A chart with its data. specification: Vega-Lite, complete. alt: what it shows, for readers who do not see it."""

    title: str
    specification: Spec
    alt: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Part:
    """One heading of the report. name: of its anchor, unique. tables: each with its caption.

    lines: of methods that the reader may switch off; its charts then have a parameter `hidden`, as those of `charts` do.
    """

    name: str
    title: str
    texts: tuple[str, ...]
    charts: tuple[Chart, ...]
    tables: tuple[tuple[str, Table], ...]
    lines: tuple[Line, ...] = ()


@dataclass(frozen=True)
class StudyReport:
    """What a study's report says. header: as that of results. where of a finding names a part. reading: how to read it."""

    title: str
    headline: str
    header: Mapping[str, Any]
    notices: tuple[str, ...]
    findings: tuple[Finding, ...]
    parts: tuple[Part, ...]
    reading: tuple[str, ...] = ()
