"""The type of probes: functions that make flights and say which properties of a method they show."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:  # reports read findings, and make no flights
    from bodycheck.studies.audit.flights import Pilot

#: The properties that an audit looks for, in the order in which they are printed.
Property = Literal[
    "single-precision",
    "linear-damping",
    "angular-damping",
    "quadratic-damping",
    "speed-limit",
    "spin-limit",
    "turn-limit",
    "no-gyroscopic-torque",
    "substeps",
    "gravity-after-position",
    "sleeping",
    "frame",
    "order",
    "quaternion-norm",
    "nondeterminism",
    "time-base",
    "silent-reset",
    "energy-per-turn",
    "scale-dependence",
    "origin-dependence",
    "representation",
]


@dataclass(frozen=True)
class Finding:
    """The finding of a probe about one property of a method.

    Parameters
    ----------
    property
        The property.
    probe
        The name of the probe, and what it saw in words if the value alone does not say it.
    verdict
        "found", "none" if the method is as mechanics has it, or "not-probed" if the flights cannot tell.
    value
        The size of what was found, such as a coefficient or a limit; None if it has no size.
    unit
        Its unit; empty for a pure number.
    expected
        The value of an engine that computes mechanics alone, as it is printed.
    """

    property: Property
    probe: str
    verdict: Literal["found", "none", "not-probed"]
    value: float | None = None
    unit: str = ""
    expected: str = ""


#: A probe: it makes flights by a pilot, and returns a finding for each property that it looks for.
Probe = Callable[["Pilot"], tuple[Finding, ...]]


def not_probed(name: str, reason: str, *properties: Property) -> tuple[Finding, ...]:
    """Return the findings that a probe cannot tell whether a method has some properties, with the reason."""
    return tuple(Finding(which, f"{name}: {reason}", "not-probed") for which in properties)
