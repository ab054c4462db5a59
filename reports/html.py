"""Reports as one HTML file: everything it needs is in it, and its content policy forbids it to load anything."""

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import resources
from typing import Any

import jinja2
import vl_convert
from markupsafe import Markup, escape

from bodycheck.reports import charts
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import count, milliseconds
from bodycheck.reports.runs.contents import Contents, Section
from bodycheck.reports.study import StudyReport

#: A number and its unit in escaped text; not the numbers inside names and character references.
MEASURE = re.compile(
    r"(?<![\w.&#-])-?\d[\d.]*(?:e-?\d+)?(?: (?:rad/s|rad|m/s²|m/s|ms|m|µs|s|kg m²/s|kg m²|kg|%)(?!\w))?(?![\w;-])"
)

#: The files of `templates/player` without `.js`, each after those that it uses.
PLAYER = (
    "vectors", "tracks", "solids", "view", "elements", "motion", "body", "polhode",
    "ground", "controls", "legend", "readings", "panels", "player", "start",
)  # fmt: skip


def render(contents: Contents) -> str:
    """The text of report.html for runs."""
    return _page(
        "report.html.jinja",
        contents.header,
        contents.notices,
        specifications(contents),
        contents=contents,
        legends={section.name: _legend(section, contents.lines) for section in contents.sections},
        datasets={section.name: _json(section.curves.datasets) for section in contents.sections},
        played={section.name: _json(section.playback.data) for section in contents.sections if section.playback},
    )


def render_study(report: StudyReport) -> str:
    """The text of report.html for a study."""
    drawn = {
        f"{part.name}-{place}": charts.without_legend(chart.specification) if part.lines else chart.specification
        for part in report.parts
        for place, chart in enumerate(part.charts, start=1)
    }
    return _page("study.html.jinja", report.header, report.notices, drawn, report=report)


def specifications(contents: Contents) -> dict[str, charts.Spec]:
    """The charts of a report by name: each is stored once, and most are drawn with every case's datasets."""
    errors = {quantity.name: charts.without_legend(charts.over_time(quantity, contents.lines)) for quantity in contents.plotted}
    origins = {
        f"{section.name}-origins-{place}": chart.specification
        for section in contents.sections
        if section.origins is not None
        for place, chart in enumerate(section.origins.charts, start=1)
    }
    return errors | {f"momentum_{frame}": charts.momentum(frame) for frame in charts.FRAMES} | origins


def _page(
    template: str, header: Mapping[str, Any], notices: Sequence[str], specifications: Mapping[str, charts.Spec], **values: Any
) -> str:
    """A page: the frame that all share, filled by its template. specifications: of its charts, by name."""
    templates = resources.files("bodycheck.reports") / "templates"
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        loader=jinja2.FunctionLoader(lambda name: (templates / name).read_text("utf-8")),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"milliseconds": milliseconds, "unbroken": _unbroken, "dashes": _dashes, "breakable": _breakable}
    environment.globals |= {"count": count, "zooming": charts.ZOOMING}
    return environment.get_template(template).render(
        header=header,
        notices=notices,
        specifications=_json(specifications),
        style=_verbatim((templates / "report.css").read_text("utf-8"), "style"),
        player_style=_verbatim((templates / "player.css").read_text("utf-8"), "style"),
        player=_verbatim(player(), "script"),
        library=_verbatim(_library(), "script"),
        sorting=_verbatim((templates / "tables.js").read_text("utf-8"), "script"),
        script=_verbatim((templates / "report.js").read_text("utf-8"), "script"),
        **values,
    )


def player() -> str:
    """Return the script that plays motions: its files in one scope, without indentation, blank lines and lines of comment."""
    folder = resources.files("bodycheck.reports") / "templates" / "player"
    lines = [line.strip() for name in PLAYER for line in (folder / f"{name}.js").read_text("utf-8").splitlines()]
    code = "\n".join(line for line in lines if line and not line.startswith("//"))
    return f'"use strict";\n(() => {{\n{code}\n}})();'


@cache
def _library() -> str:
    """Vega, Vega-Lite and Vega-Embed, which leave one name to the page's own script; it takes a second to make."""
    return str(vl_convert.javascript_bundle("window.vegaEmbed = vegaEmbed;"))


def _legend(section: Section, lines: Sequence[Line]) -> str:
    """The places, among all lines, of the methods that the charts of a case draw."""
    drawn = {row["method"] for row in section.curves.datasets["series"]}
    return " ".join(str(place) for place, line in enumerate(lines) if line.label in drawn)


def _unbroken(text: str) -> Markup:
    """Text whose numbers stay on one line with their units: 2.1e-9 rad must not break after the sign."""
    return Markup(MEASURE.sub(r'<span class="keep">\g<0></span>', str(escape(text))))


def _breakable(name: str) -> Markup:
    """The name of an integrator, which a narrow column may break after its marks: rk4-naive, Euler:cone=elliptic."""
    return Markup(re.sub(r"[-:,=]", r"\g<0><wbr>", str(escape(name))))


def _dashes(line: Line) -> str:
    return " ".join(map(str, line.dash))


def _json(value: Any) -> Markup:
    """JSON that is safe inside a script element: nothing in it can end the element or begin a comment."""
    text = json.dumps(value, separators=(",", ":"), allow_nan=False)  # ASCII only, so that no line separator is bare
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))


def _verbatim(text: str, element: str) -> Markup:
    """A style or script of our own, put in as it is. Raises `ValueError` where that would end or change the element."""
    if f"</{element}" in text.lower() or "<!--" in text:
        raise ValueError(f"cannot stand inside a {element} element as it is")
    return Markup(text)
