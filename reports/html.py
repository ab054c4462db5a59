"""Pages of reports: one HTML file that holds everything it needs, and whose content policy forbids it to load anything else."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import jinja2
from markupsafe import Markup, escape

from bodycheck.reports import charts, library, player
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import count, milliseconds
from bodycheck.reports.study import StudyReport
from bodycheck.reports.tables import pieces
from bodycheck.results import verdicts
from bodycheck.results.header import Header

#: Cases of a report, or parts of a study, up to which all are open at first. Of more, each is opened by the reader.
MOST_OPEN = 4

#: A number with its unit in escaped text, except numbers inside names and character references.
MEASURE = re.compile(
    r"(?<![\w.&#-])-?\d[\d.]*(?:e-?\d+)?(?: (?:rad/s|rad|m/s²|m/s|ms|m|µs|s|kg m²/s|kg m²|kg|%)(?!\w))?(?![\w;-])"
)


@dataclass(frozen=True)
class Link:
    """A link of the index.

    Parameters
    ----------
    target
        The anchor of the section.
    text
        What the link is called.
    under
        Whether the section is one of the group whose link comes before.
    failed
        Whether a run of the section failed.
    """

    target: str
    text: str
    under: bool = False
    failed: bool = False


#: The link to the end of every page.
MADE = Link("made", "How this report was made")


def render_study(report: StudyReport) -> str:
    """Return the text of report.html for a study."""
    drawn = {
        f"{part.name}-{place}": charts.without_legend(chart.specification) if part.lines else chart.specification
        for part in report.parts
        for place, chart in enumerate(part.charts, start=1)
    }
    played = [shown.data for part in report.parts for shown in part.animations]
    animated = any(data is not None for data in played)
    return page(
        "study.html.jinja",
        report.header,
        report.notices,
        drawn,
        _index(report),
        report=report,
        player_style=verbatim(player.style() if animated else "", "style"),
        player=verbatim(player.script(played) if animated else "", "script"),
    )


def _index(report: StudyReport) -> list[Link]:
    findings = [Link("findings", "Findings")] if report.findings else []
    reading = [Link("reading", "How to read this")] if report.reading else []
    return [*findings, *(Link(f"part-{part.name}", part.title) for part in report.parts), *reading, MADE]


def page(
    template: str,
    header: Header,
    notices: Sequence[str],
    specifications: Mapping[str, charts.Spec],
    index: Sequence[Link],
    **values: Any,
) -> str:
    """Return the text of a page: the frame that all reports share, filled by a template.

    Parameters
    ----------
    template
        Name of the template in the folder `templates`.
    header
        Header of the results: versions, machine and command.
    notices
        Sentences that limit what the report says.
    specifications
        Charts by the names that the template gives them.
    index
        The links beside the page.
    values
        Further variables of the template.
    """
    templates = resources.files("bodycheck.reports") / "templates"
    return (
        _environment()
        .get_template(template)
        .render(
            header=header,
            notices=notices,
            specifications=json_text(specifications),
            style=verbatim(colours() + (templates / "report.css").read_text("utf-8"), "style"),
            library=verbatim(library.script(), "script"),
            index=index,
            folding=verbatim((templates / "folds.js").read_text("utf-8"), "script"),
            sorting=verbatim((templates / "tables.js").read_text("utf-8"), "script"),
            script=verbatim((templates / "report.js").read_text("utf-8"), "script"),
            **values,
        )
    )


def environment(room: str) -> jinja2.Environment:
    """Return an environment of the templates in the folder `templates` of a room, such as "bodycheck.reports".

    Values are escaped, and those that are missing are errors. The templates have the filter `json` and the `verdicts`.
    """
    templates = resources.files(room) / "templates"
    templated = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        loader=jinja2.FunctionLoader(lambda name: (templates / name).read_text("utf-8")),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templated.filters["json"] = json_text
    templated.globals |= {"verdicts": verdicts, "count": count}
    return templated


@cache
def _environment() -> jinja2.Environment:
    pages = environment("bodycheck.reports")
    pages.filters |= {"milliseconds": milliseconds, "unbroken": _unbroken, "dashes": _dashes, "breakable": _breakable}
    pages.filters["pieces"] = pieces
    pages.globals |= {"zooming": charts.ZOOMING, "most_open": MOST_OPEN}
    return pages


def colours() -> str:
    """Return the style with the colours and shades of all pages, in light and dark."""
    return (resources.files("bodycheck.reports") / "templates" / "colours.css").read_text("utf-8")


def _unbroken(text: str) -> Markup:
    """Return a text whose numbers stay on one line with their units; otherwise 2.1e-9 rad could break after its sign."""
    return Markup(MEASURE.sub(r'<span class="keep">\g<0></span>', str(escape(text))))


def _breakable(name: str) -> Markup:
    """Return the name of an integrator that a narrow column may break after its marks: rk4-naive, runge_kutta4."""
    return Markup(re.sub(r"[-_:,=]", r"\g<0><wbr>", str(escape(name))))


def _dashes(line: Line) -> str:
    return " ".join(map(str, line.dash))


def json_text(value: Any) -> Markup:
    """Return JSON that is safe inside a script element: nothing in it can end the element or begin a comment."""
    text = json.dumps(value, separators=(",", ":"), allow_nan=False)  # ASCII only, so that it has no bare line separators
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))


def verbatim(text: str, element: str) -> Markup:
    """Return a style or script of bodycheck, unescaped. Raises `ValueError` if it would end the element that it stands in."""
    if f"</{element}" in text.lower() or "<!--" in text:
        raise ValueError(f"the text would end the {element} element that it stands in")
    return Markup(text)
