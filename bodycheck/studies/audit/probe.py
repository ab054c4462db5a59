"""The type of probes: functions that make flights and return findings about properties of a method."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from bodycheck.adapters.method import Kind

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
    "friction-anisotropy",
    "sideways-friction",
    "impact_energy_error",
    "impact_momentum_error",
    "impact_angular_momentum_error",
    "hidden-state",
    "order-of-bodies",
    "long-time-base",
    "long-quaternion-norm",
]

#: The kind of scene by which a property shows. A property that is not listed shows in free flight.
KIND_OF: Mapping[Property, Kind] = {
    "friction-anisotropy": "plane",
    "sideways-friction": "plane",
    "impact_energy_error": "plane",
    "impact_momentum_error": "plane",
    "impact_angular_momentum_error": "plane",
    "hidden-state": "plane",
    "order-of-bodies": "mechanism",
}

#: The properties that only the probe of very many steps looks for.
OF_LONG_RUNS: tuple[Property, ...] = ("long-time-base", "long-quaternion-norm")


@dataclass(frozen=True)
class Finding:
    """The finding of a probe about one property of a method.

    Parameters
    ----------
    property
        The property.
    probe
        The name of the probe, and a description of its observation if the value alone does not suffice.
    verdict
        "found"; "none" if the method behaves as mechanics requires; or "not-probed" if the flights cannot decide.
    value
        The size of the property that was found, such as a coefficient or a limit; None if it has no size.
    unit
        The unit of the value; empty for a pure number.
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
    """Return a finding "not-probed" for each of some properties, with the name of the probe and the reason."""
    return tuple(Finding(which, f"{name}: {reason}", "not-probed") for which in properties)
