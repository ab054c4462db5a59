"""The error that the settings of an engine's solver cost beside that of the time step: its iterations and its tolerance.

The run with the present time step is repeated with a stricter solver, and the difference is the error of the settings. Smaller
time steps do not show it, since the solver stops as early with them.
"""

from collections.abc import Mapping

import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.running.refining import Ended
from bodycheck.studies.estimate.distances import differences
from bodycheck.studies.estimate.levels import instants_of
from bodycheck.studies.estimate.method import NoTime, Refined, Run, Subject
from bodycheck.studies.estimate.rows import Solver

#: The ratio of the iterations of the stricter solver to those of the file, its tolerance, and what counts for the engine as the
#: number of iterations that a step needed.
MORE, STRICT, NEEDED = 10, 1e-15, "iterations"


def measured(subject: Subject, known: Refined, settings: Mapping[str, float], run: Run) -> Solver | None:
    """Return the error of the settings of a solver; None if it made no iteration, or a run did not complete.

    Parameters
    ----------
    subject, known
        The scene, and the runs of the method of the file.
    settings
        The settings of the file; empty if the engine has none.
    run
        A function that makes a run.
    """
    present = next((one for one in known.levels.levels if one.timestep == known.method.timestep), None)
    needed = 0 if present is None else present.motion.notes.get(NEEDED, 0)
    if present is None or not settings or not needed or known.method.options:
        return None
    iterations = int(settings["iterations"])
    strict = f"{known.method.integrator}:iterations={MORE * iterations},tolerance={STRICT}"
    times = instants_of(present.steps, present.timestep)
    try:
        stricter = run(Method.parse(strict, present.timestep), times, False)
    except NoTime:
        return None
    if isinstance(stricter, Ended):
        return None
    end = float(subject.instants[-1]) if known.chaos is None else known.chaos
    compared = times <= end + present.timestep / 2
    apart = differences(subject.scene, present.motion, stricter)
    errors = {name: float(np.max(values[compared])) for name, values in apart.items() if name in subject.compared}
    return Solver(iterations, settings["tolerance"], needed, end, errors)
