"""bodycheck with a new figure and a new axis, each planted in one place. Run: python planted.py < COMMANDS

Standard input is a JSON list of commands, each a list of words. `tables` prints the tables of docs/tables.py, and any other
command is one of bodycheck. Printed is a JSON list of the exit code and the output of each. The figure and the axis are planted
before any other module of bodycheck is imported, as if their entries stood in the source code.
"""

import io
import json
import runpy
import sys
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace

import numpy as np

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
        compute=lambda compared: np.abs(compared.trajectory.position[..., 2] - compared.truth.trajectory.position[..., 2]),
        scale=lambda scales: scales.length,
        plotted=True,
    ),
)

# What reads case files knows the figures from its import on.
from bodycheck.casefile import axes  # noqa: E402
from bodycheck.casefile.values import Values  # noqa: E402

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


def made(command: list[str]) -> tuple[int, str]:
    """The exit code of a command and what it prints."""
    printed = io.StringIO()
    with redirect_stdout(printed), redirect_stderr(printed):
        if command == ["tables"]:
            for tables in runpy.run_path(str(ROOT / "docs" / "tables.py"))["tables"]().values():
                print(*tables.values(), sep="\n")
            return 0, printed.getvalue()
        from tests.support.commands import bodycheck

        done = bodycheck(*command)
        return done.returncode, done.stdout + done.stderr


if __name__ == "__main__":
    from tests.support.processes import calls_here

    with calls_here():
        print(json.dumps([made(command) for command in json.load(sys.stdin)]))
