"""bodycheck holds physics engines against rigid-body mechanics.

>>> import bodycheck
>>> case = bodycheck.load("free-brick")
>>> run = bodycheck.simulate(case, engine="mujoco", integrator="RK4", timestep=0.002)
>>> bodycheck.compare(bodycheck.truth(case), run).maxima()
"""

import importlib
import os
import sys
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


def _refuse_to_shadow() -> None:
    """Raise `ImportError` if Python found a clone only because it was started in it, and another bodycheck is installed.

    The versions of results would be those of the one, and the numbers those of the other.
    """
    clone = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
    meant = map(os.path.realpath, filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep)))
    try:
        started = os.path.realpath(os.getcwd())
    except OSError:  # the working directory is gone
        return
    if sys.flags.safe_path or clone != started or clone in meant:
        return
    others = {os.path.realpath(folder) for folder in sys.path if os.path.isfile(os.path.join(folder, "bodycheck/__init__.py"))}
    if others - {clone}:
        raise ImportError(
            f"bodycheck is installed in {min(others - {clone})}, but Python was started in the clone {clone}, "
            "which comes first; start it in another folder or with -P, or install the clone (pip install -e .)"
        )


_refuse_to_shadow()


def __getattr__(name: str) -> Any:
    if name not in HOMES:
        raise AttributeError(f"module 'bodycheck' has no attribute {name!r}")
    return getattr(importlib.import_module(f"bodycheck.{HOMES[name]}"), name)
