"""The public comparison of a run with a truth, which is recomputed at the instants of the run if needed."""

from bodycheck.judging import discrepancy
from bodycheck.judging.discrepancy import Discrepancy
from bodycheck.reference.truth import at
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run

#: The functions that return the compared objects.
MADE_BY = {Truth: "truth", Run: "simulate"}


def compare(truth: Truth, run: Run) -> Discrepancy:
    """Return the discrepancy of a completed run from the truth of its case, at the run's own instants.

    If the truth is at other instants, it is first computed at the instants of the run, which may integrate equations of motion.
    `bodycheck.judging.discrepancy.compare` never integrates.

    Parameters
    ----------
    truth
        The truth of the case, at any instants.
    run
        The run.

    Raises
    ------
    TypeError
        If the truth is no `Truth`, or the run no `Run`.
    ValueError
        If the run has no trajectory, or its scene differs from the scene of the truth.
    bodycheck.reference.errors.OutOfReach
        If the truth cannot be computed at the instants of the run.
    """
    for value, kind, name in ((truth, Truth, "truth"), (run, Run, "run")):
        if not isinstance(value, kind):
            raise TypeError(f"read {value!r:.60} as the {name}; allowed: what bodycheck.{MADE_BY[kind]} returns")
    if run.scene is not None and run.scene != truth.scene:
        raise ValueError(
            f"the truth is of another scene than the run, which is of the case {run.case!r}; allowed: the truth of this case"
        )
    if isinstance(run.outcome, Completed):
        truth = at(truth, run.outcome.trajectory.t)
    return discrepancy.compare(truth, run)
