"""The plots of a report as files, each complete in itself: with its title and its legend, for a slide or a paper."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

import vl_convert

from bodycheck.reports import charts
from bodycheck.reports.charts import INK, Spec
from bodycheck.reports.runs.contents import Contents
from bodycheck.reports.study import StudyReport

Format = Literal["png", "svg"]

FOLDER = "figures"

#: In the place of the colour of the text around a chart, which a file has not.
BLACK = "#1a1a1a"

#: Pixels of a PNG for each of a chart's, so that it fills a slide.
SCALE = 3

CLIP = re.compile(r"\bclip\d+\b")

#: Characters.
LONGEST_NAME = 100

#: Height of a row of a legend, in the chart's pixels, and how many a column has.
ROW, MOST_ROWS = 17, 32


def of_runs(contents: Contents) -> Iterator[tuple[str, Spec]]:
    """The plots of a report of runs, with names that no two share."""
    for section in contents.sections:
        methods = {row["method"] for row in section.curves.datasets["series"]}
        lines = [line for line in contents.lines if line.label in methods]
        plots = {
            quantity.name: (quantity.title, charts.over_time(quantity, lines))
            for quantity in contents.plotted
            if quantity.name in section.curves.drawn
        }
        if section.curves.momentum:
            for frame, where in (("body", "in the body"), ("inertial", "in the inertial frame")):
                plots[f"momentum_{frame}"] = (f"Angular momentum of the truth, {where}", charts.momentum(frame))
        for name, (told, chart) in plots.items():
            floor = "; grey: the truth's own error" if name == "attitude_error" else ""
            complete = chart | {"datasets": section.curves.datasets}
            rows = 1 if name.startswith("momentum") else len(lines)
            yield f"{section.name}-{name}", _standing_alone(complete, section.title, told + floor, rows)
        for drawn in section.origins.charts if section.origins else ():
            yield f"{section.name}-{drawn.title}", _standing_alone(drawn.specification, section.title, drawn.title, 1)


def of_study(report: StudyReport) -> Iterator[tuple[str, Spec]]:
    """Likewise for a study."""
    for part in report.parts:
        for chart in part.charts:
            yield f"{part.name}-{chart.title}", _standing_alone(chart.specification, part.title, chart.title, len(part.lines))


def write(plots: Iterator[tuple[str, Spec]], folder: Path, formats: Sequence[Format]) -> None:
    """A file a plot and format in the folder `FOLDER` of a folder. Raises `OSError` where one cannot be written."""
    if not formats:
        return
    (folder / FOLDER).mkdir(exist_ok=True)
    taken: set[str] = set()
    for name, chart in plots:
        safe = _file_name(name, taken)
        for kind in formats:
            path = folder / FOLDER / f"{safe}.{kind}"
            if kind == "svg":
                path.write_text(_numbered(vl_convert.vegalite_to_svg(chart)), encoding="utf-8")
            else:
                opaque = chart | {"config": chart["config"] | {"background": "white"}}
                path.write_bytes(vl_convert.vegalite_to_png(opaque, scale=SCALE))


def _file_name(name: str, taken: set[str]) -> str:
    """A name for a file that says what is in it, on any system, and that is not taken; it is then."""
    safe = re.sub(r"[^a-z0-9_.]+", "-", name.lower()).strip("-.")[:LONGEST_NAME] or "plot"
    candidates = (safe if number == 1 else f"{safe}-{number}" for number in range(1, len(taken) + 2))
    chosen = next(candidate for candidate in candidates if candidate not in taken)
    taken.add(chosen)
    return chosen


def _numbered(svg: str) -> str:
    """An SVG whose clipping paths are numbered from 0 on, whatever was drawn before: the same plot is the same file."""
    found = dict.fromkeys(CLIP.findall(svg))
    numbers = {name: f"clip{number}" for number, name in enumerate(found)}
    return CLIP.sub(lambda match: numbers[match.group()], svg)


def _standing_alone(chart: Spec, title: str, subtitle: str, rows: int) -> Spec:
    """A chart with a title, and with its legend of so many rows, all of them, at its side."""
    columns = -(-rows // MOST_ROWS) or 1
    legend = {"orient": "right", "columns": columns, "symbolLimit": 0, "symbolOpacity": 1, "labelFontSize": 11}
    heading = {"text": title, "subtitle": subtitle, "anchor": "start", "offset": 12, "fontSize": 15, "subtitleFontSize": 12}
    config = chart["config"] | {"legend": chart["config"]["legend"] | legend}
    padded = {"title": heading, "padding": 12, "height": max(chart["height"], ROW * -(-rows // columns)), "config": config}
    made: Spec = _still(chart | padded)
    return made


def _still(value: Any) -> Any:
    """A specification with `BLACK` in the place of `INK`, and without the layers that are seen only near a pointer."""
    if isinstance(value, dict):
        return {name: _still(inner) for name, inner in value.items() if name != "tooltip"}
    if isinstance(value, list):
        return [_still(inner) for inner in value if not _is_unseen(inner)]
    return BLACK if value == INK else value


def _is_unseen(layer: Any) -> bool:
    return isinstance(layer, dict) and layer.get("encoding", {}).get("opacity", {}).get("value") == 0
