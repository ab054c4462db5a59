"""The arguments and options that several commands share, with their help."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

#: Of each of several cases.
CaseName = Annotated[str, Parameter(help="Names of shipped cases, or paths of case files; all shipped cases if none is given.")]

Engines = Annotated[
    tuple[str, ...], Parameter(help="An engine to use; may be given several times. All that are installed by default.")
]

Integrators = Annotated[
    tuple[str, ...], Parameter(help="An integrator to use; may be given several times. By default all of each engine.")
]

Timesteps = Annotated[tuple[float, ...], Parameter(help="A time step in s; may be given several times.")]

Out = Annotated[Path | None, Parameter(help="The folder for the tables, what they are made of, report.html and report.md.")]

Jobs = Annotated[int | None, Parameter(help="How many processes. By default as many as there are processors.")]

Figures = Annotated[
    tuple[Literal["png", "svg"], ...],
    Parameter(help="Also write every plot of the report into its folder figures/; may be given once for each."),
]

JUnit = Annotated[Path | None, Parameter(help="A file (.xml) for the expectations as tests, as CI systems read them.")]

Json = Annotated[bool, Parameter(help="Print as JSON instead of tables.")]
