"""The reference of the Python interface: everything public of the package, by autodoc."""

from typing import Any

import bodycheck

#: The public names by topics.
TOPICS = {
    "Cases": ("load", "Case", "CaseFaults"),
    "The truth": ("truth", "Truth"),
    "Runs": ("simulate", "Run", "compare", "Discrepancy"),
    "Studies": (
        "run",
        "RunResults",
        "tradeoff",
        "TradeoffResults",
        "recommend",
        "RecommendResults",
        "estimate",
        "EstimateResults",
        "extremes",
        "ExtremesResults",
        "ensemble",
        "EnsembleResults",
        "audit",
        "AuditResults",
        "contact",
        "ContactResults",
        "sensors",
        "SensorResults",
        "parity",
        "ParityResults",
        "releases",
        "ReleasesResults",
    ),
    "Scripts": ("export",),
    "Charts": ("Plot",),
    "Errors": ("BadInput", "Failed"),
}

#: What the attributes of public values have, by modules.
PARTS = {
    "reference.trajectory": ("Trajectory",),
    "reference.bounds": ("Bounds",),
    "adapters.method": ("Method",),
    "results.outcome": ("Completed", "Unsupported", "Diverged"),
    "processes.failures": ("Crashed", "TimedOut"),
    "reference.errors": ("NotModelled", "OutOfReach"),
}


def page() -> str:
    """Return a directive of autodoc for each public name, as Markdown."""
    parts = []
    for topic, names in TOPICS.items():
        parts += [f"## {topic}", *(_documented(name, getattr(bodycheck, name)) for name in names)]
    parts.append("## Parts of these")
    for module, names in PARTS.items():
        parts += [_class(f"bodycheck.{module}.{name}") for name in names]
    return "\n\n".join(parts)


def _documented(name: str, public: Any) -> str:
    if not isinstance(public, type):
        return f"```{{eval-rst}}\n.. autofunction:: bodycheck.{name}\n```"
    return _class(f"bodycheck.{name}", "" if issubclass(public, Exception) else "   :inherited-members:\n")


def _class(name: str, options: str = "") -> str:
    return f"```{{eval-rst}}\n.. autoclass:: {name}\n   :members:\n{options}```"
