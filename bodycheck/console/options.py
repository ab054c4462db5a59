"""The arguments and options that several commands share, with their help texts."""

from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from bodycheck.console.arguments import Robots
from bodycheck.errors import BadInput

#: One of several cases.
CaseName = Annotated[
    str,
    Parameter(
        help="Cases: names of shipped cases, case files, files of robots (URDF or MJCF), folders of them, or patterns. "
        "Default: all shipped cases."
    ),
]

Engines = Annotated[
    tuple[str, ...], Parameter(help="An engine to use. May be given several times. Default: all installed engines.")
]

Integrators = Annotated[
    tuple[str, ...],
    Parameter(
        help="A method to use, or one of the aliases default (what users of the engine's quick start get) and recommended "
        "(what its documentation recommends), which have their own time steps. May be given several times. If none is named: "
        "all methods that each engine offers."
    ),
]

Timesteps = Annotated[tuple[float, ...], Parameter(help="A time step in s. May be given several times.")]

Batches = Annotated[
    tuple[str, ...],
    Parameter(
        help="Numbers of scenes, such as 1,100,10000: also run that many copies of each case, turned about the vertical, in "
        "one batch with the engines that step many scenes at once. Without --timestep, at the step of each method that is "
        "nearest to 2 ms."
    ),
]

Out = Annotated[Path | None, Parameter(help="The folder for the tables, the recorded runs, report.html and report.md.")]

Jobs = Annotated[int | None, Parameter(help="The number of processes. Default: the number of processors.")]


def _check_drawing(_: type, formats: tuple[str, ...]) -> None:
    """Raise `BadInput` if plots are asked for and nothing can draw them, before anything runs."""
    if formats and find_spec("vl_convert") is None:
        raise BadInput("--figures needs vl-convert: pip install 'bodycheck[figures]'")


Figures = Annotated[
    tuple[Literal["png", "svg"], ...],
    Parameter(
        help="Also write every plot of the report into the folder figures/. May be given once for each format. Needs the "
        "extra figures.",
        validator=_check_drawing,
    ),
]

JUnit = Annotated[Path | None, Parameter(help="A file (.xml) for the expectations as test results that CI systems can read.")]

AllowMissing = Annotated[
    bool,
    Parameter(negative="", help="Do not count expectations of engines that are not installed as failed. Summaries say so."),
]

Again = Annotated[bool, Parameter(negative="", help="Take nothing from the cache; what is kept there is replaced.")]

Json = Annotated[bool, Parameter(help="Print JSON instead of tables.")]

Quiet = Annotated[
    bool, Parameter(help="Print only what failed, errors, and the path of the report: no progress, no tables, no summary.")
]


@dataclass(frozen=True)
class View:
    """The printed columns of tables, and the order of their rows.

    Attributes
    ----------
    columns
        Names of columns, separated by commas; empty for all columns that fit on the terminal.
    sort
        The name of the column by which rows are sorted; empty for the order of the command.
    wide
        Whether all columns are printed, whatever the width of the terminal.
    """

    columns: Annotated[str, Parameter(help="Print these columns only, separated by commas.")] = ""
    sort: Annotated[
        str, Parameter(help="Sort the rows of tables by this column, so that the largest value or the last name is at the end.")
    ] = ""
    wide: Annotated[bool, Parameter(help="Print all columns, also those that a narrow terminal has no room for.")] = False

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(filter(None, (name.strip() for name in self.columns.split(","))))


#: The reading of robots' files as two options of a command, whose help is in the docstring of the class.
OfRobots = Annotated[Robots, Parameter(name="*")]

#: A view as three options of a command.
Viewed = Annotated[View, Parameter(name="*")]

#: The view of a command whose options are not given.
AS_USUAL = View()
