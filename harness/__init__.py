"""bodycheck holds physics engines against rigid-body mechanics.

>>> import bodycheck
>>> case = bodycheck.load("free-brick")
>>> run = bodycheck.simulate(case, engine="mujoco", integrator="RK4", timestep=0.002)
>>> bodycheck.compare(bodycheck.truth(case), run).maxima()
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bodycheck.case import Case, CaseFaults, load
    from bodycheck.discrepancy import Discrepancy, compare
    from bodycheck.outcome import Run
    from bodycheck.reference.truth import Truth
    from bodycheck.simulation import simulate
    from bodycheck.truths import truth

__all__ = ["Case", "CaseFaults", "Discrepancy", "Run", "Truth", "compare", "load", "simulate", "truth"]

# Imported when first used: `bodycheck --help` must not wait for SciPy.
HOMES = {
    "Case": "case",
    "CaseFaults": "case",
    "load": "case",
    "Discrepancy": "discrepancy",
    "compare": "discrepancy",
    "Run": "outcome",
    "simulate": "simulation",
    "Truth": "reference.truth",
    "truth": "truths",
}


def __getattr__(name: str) -> Any:
    if name not in HOMES:
        raise AttributeError(f"module 'bodycheck' has no attribute {name!r}")
    return getattr(importlib.import_module(f"bodycheck.{HOMES[name]}"), name)
