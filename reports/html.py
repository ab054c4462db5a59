"""Pages of reports: a page is one HTML file without other files, and its content policy forbids it to load any."""

import json
import re
import zlib
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import jinja2
from markupsafe import Markup, escape

from bodycheck.reports import charts, player
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import count, milliseconds
from bodycheck.reports.study import StudyReport
from bodycheck.reports.tables import Entry, pieces
from bodycheck.results import verdicts
from bodycheck.results.header import Header

#: The most cases of a report, or parts of a study, that are all open at first. If there are more, all are folded at first.
MOST_OPEN = 4

#: The end of the licence in the script of the charts. The page contains it as it is, and what follows compressed.
LICENCE_END = "*/\n"

#: The most notices that are open at first.
FEW_NOTICES = 2

#: Matches a number with its unit in escaped text, except numbers inside names and character references.
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
        The text of the link.
    under
        Whether the section belongs to the group whose link comes before.
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
    """Return the text of a page: the common frame of all reports with the content of a template.

    Parameters
    ----------
    template
        Name of the template in the folder `templates`.
    header
        Header of the results: versions, machine and command.
    notices
        Sentences about the limits of the report.
    specifications
        Charts by their names in the template.
    index
        The links beside the page.
    values
        Further variables of the template.
    """
    templates = resources.files("bodycheck.reports") / "templates"
    licence, library = _library()
    return (
        _environment()
        .get_template(template)
        .render(
            header=header,
            notices=notices,
            specifications=deflated(json_text(specifications)),
            style=verbatim(shared_style() + (templates / "report.css").read_text("utf-8"), "style"),
            licence=verbatim(licence, "script"),
            library=library,
            index=index,
            folding=verbatim((templates / "folds.js").read_text("utf-8"), "script"),
            sorting=verbatim((templates / "tables.js").read_text("utf-8"), "script"),
            script=verbatim((templates / "report.js").read_text("utf-8"), "script"),
            **values,
        )
    )


def environment(room: str) -> jinja2.Environment:
    """Return an environment for the templates in the folder `templates` of the package `room`, such as "bodycheck.reports".

    Values are escaped, and a missing value is an error. The templates have the filter `json`, `verdicts` and `count`.
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
def _library() -> tuple[str, str]:
    """Return the licence of the script of the charts, and the compressed script."""
    licence, end, code = (
        (resources.files("bodycheck.reports") / "templates" / "vega.js").read_text("utf-8").partition(LICENCE_END)
    )
    return licence + end, deflated(code)


def deflated(text: str) -> str:
    """Return a text as base64 of its compressed bytes, without the header that says so (raw DEFLATE)."""
    press = zlib.compressobj(9, wbits=-zlib.MAX_WBITS)
    return b64encode(press.compress(text.encode("utf-8")) + press.flush()).decode("ascii")


@cache
def _environment() -> jinja2.Environment:
    pages = environment("bodycheck.reports")
    pages.filters |= {"milliseconds": milliseconds, "unbroken": unbroken, "dashes": _dashes, "breakable": _breakable}
    pages.filters["pieces"] = pieces
    pages.tests["sorted_apart"] = _is_sorted_apart
    pages.globals |= {"zooming": charts.ZOOMING, "most_open": MOST_OPEN, "few_notices": FEW_NOTICES}
    return pages


def shared_style() -> str:
    """Return the style of all pages: colours for light and dark screens, text and tables."""
    templates = resources.files("bodycheck.reports") / "templates"
    return "".join((templates / name).read_text("utf-8") for name in ("colours.css", "common.css"))


def unbroken(text: str) -> Markup:
    """Return a text with markup that keeps numbers and their units on one line; 2.1e-9 rad could break after its sign."""
    return Markup(MEASURE.sub(r'<span class="keep">\g<0></span>', str(escape(text))))


def _breakable(name: str) -> Markup:
    """Return the name of an integrator, such as rk4-naive, that may break after its punctuation marks in a narrow column."""
    return Markup(re.sub(r"[-_:,=]", r"\g<0><wbr>", str(escape(name))))


def _is_sorted_apart(entry: Entry) -> bool:
    """Return whether a column is sorted by the number of an entry because its text is no number."""
    try:
        float(entry.text)
    except ValueError:
        return entry.value is not None
    return False


def _dashes(line: Line) -> str:
    return " ".join(map(str, line.dash))


def json_text(value: Any) -> Markup:
    """Return a value as JSON that is safe inside a script element: it cannot end the element or begin a comment."""
    text = json.dumps(value, separators=(",", ":"), allow_nan=False)  # ASCII only, so that it has no unescaped line separators
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))


def verbatim(text: str, element: str) -> Markup:
    """Return a style or script of bodycheck without escaping. Raises `ValueError` if it would end its element."""
    if f"</{element}" in text.lower() or "<!--" in text:
        raise ValueError(f"the text would end the {element} element that it stands in")
    return Markup(text)
