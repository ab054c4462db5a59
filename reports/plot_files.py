"""The plots of a report as separate files with a title and a legend, for slides and papers."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

from bodycheck.errors import BadInput
from bodycheck.files import writing
from bodycheck.reports.charts import INK, Spec
from bodycheck.reports.study import StudyReport

Format = Literal["png", "svg"]

#: The name of the folder for plots, inside the folder of the report.
FOLDER = "figures"

#: The colour that replaces the colour of the text around a chart, since a file has no such text.
BLACK = "#1a1a1a"

#: The pixels of a PNG for each pixel of the chart, so that the image fills a slide.
SCALE = 3

#: Matches the name of a clipping path in an SVG.
CLIP = re.compile(r"\bclip\d+\b")

#: The most characters of a file name, without its extension.
LONGEST_NAME = 100

#: The height of a row of a legend, in pixels of the chart, and the most rows in a column of a legend.
ROW, MOST_ROWS = 17, 32


def of_study(report: StudyReport) -> Iterator[tuple[str, Spec]]:
    """Yield the plots of a study as names and specifications."""
    for part in report.parts:
        for chart in part.charts:
            yield f"{part.name}-{chart.title}", standing_alone(chart.specification, part.title, chart.title, len(part.lines))


def write(plots: Iterator[tuple[str, Spec]], folder: Path, formats: Sequence[Format]) -> None:
    """Write a file for each plot and format into the sub-folder `FOLDER`. Raises `NotWritten` if a file cannot be written."""
    if not formats:
        return
    taken: set[str] = set()
    for name, chart in plots:
        safe = _file_name(name, taken)
        for kind in formats:
            writing.write(folder / FOLDER / f"{safe}.{kind}", rendered(chart, kind), folder)


def rendered(chart: Spec, kind: Format) -> bytes:
    """Return the content of the file of a plot. Raises `BadInput` if vl-convert, which draws it, is missing.

    chart: a specification from `standing_alone`.
    """
    try:
        import vl_convert  # it is large, and nothing else needs it
    except ModuleNotFoundError as error:
        raise BadInput("a plot as a file needs vl-convert: pip install 'bodycheck[figures]'") from error
    if kind == "svg":
        return _numbered(vl_convert.vegalite_to_svg(chart)).encode("utf-8", "replace")
    opaque = chart | {"config": chart["config"] | {"background": "white"}}
    content: bytes = vl_convert.vegalite_to_png(opaque, scale=SCALE)
    return content


def _file_name(name: str, taken: set[str]) -> str:
    """Return a file name, without extension, that is valid on any system and not in `taken`, and add it to `taken`."""
    safe = re.sub(r"[^a-z0-9_.]+", "-", name.lower()).strip("-.")[:LONGEST_NAME] or "plot"
    candidates = (safe if number == 1 else f"{safe}-{number}" for number in range(1, len(taken) + 2))
    chosen = next(candidate for candidate in candidates if candidate not in taken)
    taken.add(chosen)
    return chosen


def _numbered(svg: str) -> str:
    """Return an SVG with its clipping paths numbered from 0, so that the same plot always gives the same file."""
    found = dict.fromkeys(CLIP.findall(svg))
    numbers = {name: f"clip{number}" for number, name in enumerate(found)}
    return CLIP.sub(lambda match: numbers[match.group()], svg)


def standing_alone(chart: Spec, title: str, subtitle: str, rows: int) -> Spec:
    """Return a chart with a title and a subtitle, and with its whole legend, of `rows` entries, beside the plot."""
    columns = -(-rows // MOST_ROWS) or 1
    legend = {"orient": "right", "columns": columns, "symbolLimit": 0, "symbolOpacity": 1, "labelFontSize": 11}
    heading = {"text": title, "subtitle": subtitle, "anchor": "start", "offset": 12, "fontSize": 15, "subtitleFontSize": 12}
    config = chart["config"] | {"legend": chart["config"]["legend"] | legend}
    padded = {"title": heading, "padding": 12, "height": max(chart["height"], ROW * -(-rows // columns)), "config": config}
    made: Spec = _still(chart | padded)
    return made


def _still(value: Any) -> Any:
    """Return a specification with `BLACK` in place of `INK`, without tooltips and without invisible layers for the pointer."""
    if isinstance(value, dict):
        return {name: _still(inner) for name, inner in value.items() if name != "tooltip"}
    if isinstance(value, list):
        return [_still(inner) for inner in value if not _is_unseen(inner)]
    return BLACK if value == INK else value


def _is_unseen(layer: Any) -> bool:
    return isinstance(layer, dict) and layer.get("encoding", {}).get("opacity", {}).get("value") == 0
