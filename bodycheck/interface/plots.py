"""A single chart of a report, which a notebook shows and a script saves."""

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bodycheck.errors import BadInput
from bodycheck.files import writing
from bodycheck.reports import plot_files
from bodycheck.reports.charts import Spec
from bodycheck.suggestion import did_you_mean

#: The bytes of a PNG that contain its width and height, as two integers of four bytes.
SIZE_IN_PNG = slice(16, 24)


@dataclass(frozen=True)
class Plot:
    """A chart. A notebook shows it if it is the last value of a cell.

    Attributes
    ----------
    case
        The case, or the part of the report, that the chart belongs to.
    title
        The title of the chart in the report.
    specification
        The chart with its data, in the language Vega-Lite.
    """

    case: str
    title: str
    specification: Spec = field(repr=False)

    def save(self, path: str | Path) -> None:
        """Write the chart into a file. The ending sets the format: .svg, .png, or .json for the specification.

        Raises `BadInput` for another ending, and `bodycheck.files.writing.NotWritten` if the file cannot be written.
        """
        match Path(path).suffix:
            case ".svg" | ".png" as ending:
                content = plot_files.rendered(self.specification, "svg" if ending == ".svg" else "png")
            case ".json":
                content = json.dumps(self.specification, ensure_ascii=False).encode("utf-8")
            case other:
                raise BadInput(f"{path}: read {other!r} as the ending of the file; allowed: .svg, .png, .json")
        writing.write_named(Path(path), content)

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        """Return the picture for a notebook, with its size on the screen in pixels."""
        content = plot_files.rendered(self.specification, "png")
        width, height = struct.unpack(">II", content[SIZE_IN_PNG])
        return content, {"width": width // plot_files.SCALE, "height": height // plot_files.SCALE}


def chosen(plots: Sequence[Plot], quantity: str, case: str) -> Plot:
    """Return the first plot of a case whose title begins with a quantity; an empty text stands for any case or quantity.

    Raises `BadInput` if there is none.
    """
    if not plots:
        raise BadInput("the report of these results has no plot")
    cases = list(dict.fromkeys(plot.case for plot in plots))
    if case and case not in cases:
        raise BadInput(f"there is no plot of the case {case!r}; there are: {', '.join(cases)}{did_you_mean(case, cases)}")
    candidates = [plot for plot in plots if plot.case == (case or plot.case)]
    wanted = quantity.replace("_", " ").lower()
    matching = next((plot for plot in candidates if plot.title.lower().startswith(wanted)), None)
    if matching is None:
        titles = list(dict.fromkeys(plot.title for plot in candidates))
        raise BadInput(f"there is no plot of {quantity!r}; there are: {', '.join(titles)}{did_you_mean(quantity, titles)}")
    return matching
