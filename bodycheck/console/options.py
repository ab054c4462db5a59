"""The arguments and options that several commands share, with their help."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

#: One of several cases.
CaseName = Annotated[
    str, Parameter(help="Cases: names of shipped cases, case files, folders of them, or patterns. Default: all shipped cases.")
]

Engines = Annotated[
    tuple[str, ...], Parameter(help="An engine to use. May be given several times. Default: all installed engines.")
]

Integrators = Annotated[
    tuple[str, ...],
    Parameter(help="An integrator to use. May be given several times. Default: all integrators of each engine."),
]

Timesteps = Annotated[tuple[float, ...], Parameter(help="A time step in s. May be given several times.")]

Out = Annotated[Path | None, Parameter(help="The folder for the tables, the recorded runs, report.html and report.md.")]

Jobs = Annotated[int | None, Parameter(help="The number of processes. Default: the number of processors.")]

Figures = Annotated[
    tuple[Literal["png", "svg"], ...],
    Parameter(help="Also write every plot of the report into the folder figures/. May be given once for each format."),
]

JUnit = Annotated[Path | None, Parameter(help="A file (.xml) for the expectations as test results that CI systems can read.")]

Json = Annotated[bool, Parameter(help="Print JSON instead of tables.")]
