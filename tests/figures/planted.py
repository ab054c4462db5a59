"""bodycheck with a new figure and a new axis, each planted in one place. Run: python planted.py tables | COMMAND ...

`tables` prints the tables of docs/cases.md, and any other command is one of bodycheck. Figures and axes are planted before any
other module of bodycheck is imported, as if their entries stood in the source code.
"""

import runpy
import sys
from dataclasses import replace

import numpy as np

from bodycheck.casefile import axes
from bodycheck.casefile.values import Values
from bodycheck.figures import motion
from bodycheck.figures.definition import Figure
from tests.support import ROOT

motion.ERRORS += (
    Figure(
        name="height_error",
        title="Height error",
        meaning="difference of the height of the centre of mass from that of mechanics",
        unit="m",
        largest=True,
        compute=lambda compared: np.abs(compared.trajectory.position[:, 2] - compared.truth.trajectory.position[:, 2]),
        scale=lambda scales: scales.length,
        plotted=True,
    ),
)

axes.AXES["lift"] = axes.Axis(
    name="lift",
    title="Lift of the start",
    meaning="height by which the start is lifted",
    unit="m",
    values=Values,
    change=lambda case, value: replace(
        case, scene=replace(case.scene, initial=replace(case.scene.initial, position=(0.0, 0.0, value)))
    ),
    missing=lambda scene: "a body that lies on a plane" if scene.plane is not None else None,
)

if __name__ == "__main__":
    if sys.argv[1:] == ["tables"]:
        for table in runpy.run_path(str(ROOT / "docs" / "tables.py"))["tables"]().values():
            print(table)
    else:
        from bodycheck.commands.command_line import main

        main()
