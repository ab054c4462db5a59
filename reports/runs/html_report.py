"""The report of runs as one HTML file."""

from collections.abc import Sequence

from markupsafe import Markup

from bodycheck.reports import player
from bodycheck.reports.charts import Spec, without_legend
from bodycheck.reports.html import MADE, Link, json_text, page, verbatim
from bodycheck.reports.lines import Line
from bodycheck.reports.runs.charts import joint_curves
from bodycheck.reports.runs.charts.legends import MOST_ENTRIES
from bodycheck.reports.runs.charts.packing import packed
from bodycheck.reports.runs.charts.time_charts import FRAMES, joints, momentum, over_time, readings
from bodycheck.reports.runs.contents import Contents, Section

#: The most cases of which each has a link in the index; more are found by a field (folds.js).
MOST_LISTED = 12


def render(contents: Contents) -> str:
    """Return the text of report.html for runs."""
    return page(
        "runs.html.jinja",
        contents.header,
        contents.notices,
        specifications(contents),
        index(contents),
        contents=contents,
        stills={section.name: Markup(section.still) for section in contents.sections},  # numbers alone
        sections={section.name: section for section in contents.sections},
        joint_titles=joint_curves.TITLES,
        most_entries=MOST_ENTRIES,
        legends={section.name: _legend(section, contents.lines) for section in contents.sections},
        datasets={section.name: json_text(packed(section.curves.datasets)) for section in contents.sections},
        played={section.name: json_text(section.playback.data) for section in contents.sections if section.playback},
        player_style=verbatim(player.style(), "style"),
        player=verbatim(player.script(section.playback.data for section in contents.sections if section.playback), "script"),
    )


def index(contents: Contents) -> list[Link]:
    """Return the links of the index, in the order of the page."""
    failed = {failure.case for failure in contents.failures}
    first = (
        ("findings", "Answers", contents.answers or contents.broken),
        ("motion", "Motion", contents.leading),
        ("failures", "Failed runs", contents.failures),
        ("matrix", "Scenes and motions", contents.matrices),
    )
    listed = contents.sections if len(contents.sections) <= MOST_LISTED else ()
    cases = (Link(f"case-{section.name}", section.name, True, section.name in failed) for section in listed)
    kinds = (
        Link(f"matrix-{matrix.kind.name}", f"{matrix.kind.title} ({len(matrix.rows)})", True) for matrix in contents.matrices
    )
    further = [Link("further", "Where errors come from")] if contents.findings else []
    trades = [Link("trades", "Error over cost")] if len(contents.trades) > 1 else []
    return [
        *(Link(target, text) for target, text, there in first if there),
        *kinds,
        *trades,
        *further,
        *([Link(f"case-{contents.sections[0].name}", "Cases")] if contents.sections else []),
        *cases,
        Link("reading", "How to read this"),
        MADE,
    ]


def specifications(contents: Contents) -> dict[str, Spec]:
    """Return the charts of a report by name. A chart over time is stored once and drawn with the datasets of every case."""
    errors = {quantity.name: without_legend(over_time(quantity, contents.lines)) for quantity in contents.plotted}
    origins = {
        f"{section.name}-origins-{number}": chart.specification
        for section in contents.sections
        if section.origins is not None
        for number, chart in enumerate(section.origins.charts, start=1)
    }
    steps = {
        f"{section.name}-steps-{number}": without_legend(chart.specification)
        for section in contents.sections
        for number, chart in enumerate(section.steps.charts, start=1)
    }
    moved = {kind for section in contents.sections for kind in section.curves.joints}
    coordinates = {f"joints_{kind}": joints(kind) for kind in sorted(moved)}
    sensed = {number for section in contents.sections for number in section.curves.sensors}
    coordinates |= {f"readings_{number}": readings(number) for number in sorted(sensed)}
    trades = {f"trade-{name}": chart.specification for name, chart in contents.trades.items()}
    return trades | errors | {f"momentum_{frame}": momentum(frame) for frame in FRAMES} | coordinates | origins | steps


def _legend(section: Section, lines: Sequence[Line]) -> tuple[str, int]:
    """Return the positions, among the lines of the report, of the methods that the charts of a case draw.

    Those that are shown first come first. The number is how many they are.
    """
    drawn = {row["method"] for row in section.curves.datasets["series"]}
    first = {line.label for line in section.first if line.label in drawn}
    positions = [position for position, line in enumerate(lines) if line.label in drawn]
    positions.sort(key=lambda position: lines[position].label not in first)
    return " ".join(map(str, positions)), len(first)
