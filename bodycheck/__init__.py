"""bodycheck checks physics engines against exact rigid-body mechanics.

>>> import bodycheck
>>> case = bodycheck.load("free-brick")
>>> run = bodycheck.simulate(case, engine="mujoco", integrator="RK4", timestep=0.002)
>>> bodycheck.compare(bodycheck.truth(case), run).maxima()
>>> bodycheck.recommend(case, error=1e-4)
"""

import importlib
import os
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bodycheck.casefile.case import Case, CaseFaults
    from bodycheck.casefile.robots.loading import load
    from bodycheck.errors import BadInput, Failed
    from bodycheck.interface.exporting import export
    from bodycheck.interface.plots import Plot
    from bodycheck.interface.runs import RunResults, run
    from bodycheck.judging.comparison import compare
    from bodycheck.judging.discrepancy import Discrepancy
    from bodycheck.reference.truths import Truth
    from bodycheck.results.outcome import Run
    from bodycheck.running.simulation import simulate
    from bodycheck.running.truths import truth
    from bodycheck.studies.audit.interface import AuditResults, audit
    from bodycheck.studies.contact.interface import ContactResults, contact
    from bodycheck.studies.ensemble.interface import EnsembleResults, ensemble
    from bodycheck.studies.estimate.interface import EstimateResults, estimate
    from bodycheck.studies.extremes.interface import ExtremesResults, extremes
    from bodycheck.studies.parity.interface import ParityResults, parity
    from bodycheck.studies.recommend.interface import RecommendResults, recommend
    from bodycheck.studies.releases.interface import ReleasesResults, releases
    from bodycheck.studies.sensors.interface import SensorResults, sensors
    from bodycheck.studies.tradeoff.interface import TradeoffResults, tradeoff

    __version__: str

__all__ = [
    "AuditResults",
    "BadInput",
    "Case",
    "CaseFaults",
    "ContactResults",
    "Discrepancy",
    "EnsembleResults",
    "EstimateResults",
    "ExtremesResults",
    "Failed",
    "ParityResults",
    "Plot",
    "RecommendResults",
    "ReleasesResults",
    "Run",
    "RunResults",
    "SensorResults",
    "TradeoffResults",
    "Truth",
    "__version__",
    "audit",
    "compare",
    "contact",
    "ensemble",
    "estimate",
    "export",
    "extremes",
    "load",
    "parity",
    "recommend",
    "releases",
    "run",
    "sensors",
    "simulate",
    "tradeoff",
    "truth",
]

# The module of each public name, imported when the name is first used: `bodycheck --help` must not wait for SciPy.
HOMES = {
    "BadInput": "errors",
    "Failed": "errors",
    "Case": "casefile.case",
    "CaseFaults": "casefile.case",
    "load": "casefile.robots.loading",
    "Discrepancy": "judging.discrepancy",
    "compare": "judging.comparison",
    "Run": "results.outcome",
    "simulate": "running.simulation",
    "Truth": "reference.truths",
    "truth": "running.truths",
    "run": "interface.runs",
    "RunResults": "interface.runs",
    "tradeoff": "studies.tradeoff.interface",
    "TradeoffResults": "studies.tradeoff.interface",
    "recommend": "studies.recommend.interface",
    "RecommendResults": "studies.recommend.interface",
    "estimate": "studies.estimate.interface",
    "EstimateResults": "studies.estimate.interface",
    "extremes": "studies.extremes.interface",
    "ExtremesResults": "studies.extremes.interface",
    "audit": "studies.audit.interface",
    "AuditResults": "studies.audit.interface",
    "contact": "studies.contact.interface",
    "ContactResults": "studies.contact.interface",
    "sensors": "studies.sensors.interface",
    "SensorResults": "studies.sensors.interface",
    "ensemble": "studies.ensemble.interface",
    "EnsembleResults": "studies.ensemble.interface",
    "parity": "studies.parity.interface",
    "ParityResults": "studies.parity.interface",
    "releases": "studies.releases.interface",
    "ReleasesResults": "studies.releases.interface",
    "export": "interface.exporting",
    "Plot": "interface.plots",
}


def _refuse_to_shadow() -> None:
    """Raise `ImportError` if Python imports a clone only because it was started there, and another bodycheck is installed.

    Results would state the version of the installed bodycheck, and their numbers would come from the clone.
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
    if name == "__version__":
        return importlib.import_module("importlib.metadata").version("bodycheck")
    if name in HOMES:
        return getattr(importlib.import_module(f"bodycheck.{HOMES[name]}"), name)
    studies = importlib.import_module("bodycheck.studies.registry")
    if name in studies.STUDIES and studies.is_plain(name):
        return importlib.import_module("bodycheck.studies.plain").function(name)
    raise AttributeError(f"module 'bodycheck' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
