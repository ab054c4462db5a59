"""Show charts and commands in the notebooks of the gallery.

A chart becomes SVG within the page. What is black in it gets the colour of the text around it, so that it can be read in light
and dark, and it has a text for those who do not see it.
"""

import re
import shlex
import subprocess
import sys
from dataclasses import dataclass, field
from hashlib import sha256
from html import escape
from pathlib import Path

from bodycheck.interface.plots import Plot
from bodycheck.reports import plot_files
from bodycheck.reports.charts import Spec

#: Black in a chart that stands alone, as an attribute.
INK = re.compile(rf'"(?:{plot_files.BLACK}|black|#000|#000000)"')

#: What describes the parts of a chart to a screen reader, which is told the whole instead.
PARTS = re.compile(r' (?:role|aria-[a-z]+)="[^"]*"')

#: The font of charts. Places in them were computed for letters as wide as those of Arial, which system fonts often are not.
SYSTEM_FONT, FONT = 'font-family="system-ui, sans-serif"', 'font-family="Arial, Liberation Sans, Helvetica, sans-serif"'

#: The columns of a legend.
COLUMNS = 2

#: The points of a line, and digits of them that nobody sees.
POINTS, UNSEEN = re.compile(r' d="[^"]*"'), re.compile(r"(\.\d\d)\d+")


@dataclass(frozen=True)
class Chart:
    """A chart, which a notebook shows where it is the last value of a cell.

    Attributes
    ----------
    chart
        A plot of results, a specification in Vega-Lite, or the path of an SVG that a command wrote.
    alt
        What the chart shows, in a sentence.
    """

    chart: Plot | Spec | Path = field(repr=False)
    alt: str

    def svg(self) -> str:
        """Return the chart as an element of a page."""
        if isinstance(self.chart, Path):
            drawn = self.chart.read_text("utf-8")
        else:
            specification = self.chart.specification if isinstance(self.chart, Plot) else self.chart
            drawn = plot_files.rendered(narrow(specification), "svg").decode("utf-8")
        drawn = PARTS.sub("", INK.sub('"currentColor"', drawn)).replace(SYSTEM_FONT, FONT)
        drawn = POINTS.sub(lambda line: UNSEEN.sub(r"\1", line.group()), drawn)
        own = sha256(drawn.encode("utf-8")).hexdigest()[:8]  # names in an SVG are names in the whole page
        drawn = re.sub(r"\bclip(\d+)\b", rf"clip-{own}-\1", drawn)
        label = f'role="img" aria-label="{escape(self.alt)}" style="max-width: 100%; height: auto"'
        return drawn.replace("<svg ", f"<svg {label} ", 1)

    def _repr_html_(self) -> str:
        return f'<figure class="chart">{self.svg()}</figure>'


def narrow(specification: Spec) -> Spec:
    """Return a chart with its legend above it, since a column of text has no room beside a chart."""
    config = specification["config"]
    return specification | {"config": config | {"legend": config.get("legend", {}) | {"orient": "top", "columns": COLUMNS}}}


def terminal(line: str, folder: Path, fails: bool = False) -> None:
    """Run a command line of bodycheck in a folder, and print it with what it prints.

    Parameters
    ----------
    line
        The command line, which begins with the word bodycheck.
    folder
        The folder.
    fails
        Whether the command ends with exit code 1, as it does where it finds something.
    """
    program, *words = shlex.split(line)
    if program != "bodycheck":
        raise ValueError(f"not a command of bodycheck: {line}")
    command = [sys.executable, "-m", "bodycheck", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != int(fails):
        raise RuntimeError(f"{line}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    print(f"$ {line}\n{done.stdout}", end="")
