"""bodycheck holds physics engines against rigid-body mechanics.

>>> import bodycheck
>>> case = bodycheck.load("free-brick")
>>> run = bodycheck.simulate(case, engine="mujoco", integrator="RK4", timestep=0.002)
>>> bodycheck.compare(bodycheck.truth(case), run).maxima()
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bodycheck.casefile.case import Case, CaseFaults, load
    from bodycheck.judging.comparison import compare
    from bodycheck.judging.discrepancy import Discrepancy
    from bodycheck.reference.truth import Truth
    from bodycheck.running.outcome import Run
    from bodycheck.running.simulation import simulate
    from bodycheck.running.truths import truth

__all__ = ["Case", "CaseFaults", "Discrepancy", "Run", "Truth", "compare", "load", "simulate", "truth"]

# Imported when first used: `bodycheck --help` must not wait for SciPy.
HOMES = {
    "Case": "casefile.case",
    "CaseFaults": "casefile.case",
    "load": "casefile.case",
    "Discrepancy": "judging.discrepancy",
    "compare": "judging.comparison",
    "Run": "running.outcome",
    "simulate": "running.simulation",
    "Truth": "reference.truth",
    "truth": "running.truths",
}


def __getattr__(name: str) -> Any:
    if name not in HOMES:
        raise AttributeError(f"module 'bodycheck' has no attribute {name!r}")
    return getattr(importlib.import_module(f"bodycheck.{HOMES[name]}"), name)
