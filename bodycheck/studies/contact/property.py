"""The properties of contacts that the probes measure."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

#: The names of the properties, in the order in which they are shown.
Name = Literal[
    "restitution",
    "bounce-threshold",
    "impact_energy_error",
    "impact_momentum_error",
    "impact_angular_momentum_error",
    "depth-at-rest",
    "sleeping",
    "creep",
    "viscous-speed",
    "friction-anisotropy",
    "sideways-friction",
]
NAMES: Mapping[str, Name] = {name: name for name in get_args(Name)}


@dataclass(frozen=True)
class Property:
    """A property of the contacts of a method.

    Attributes
    ----------
    name
        The name of the property.
    condition
        The conditions of the measurement, in words.
    value
        The measured value; None if there is none.
    unit
        The unit of the value; empty for a pure number.
    expected
        The value in mechanics with the coefficients that the engine is given.
    note
        Why there is no value, or the numbers from which it follows.
    """

    name: Name
    condition: str
    value: float | None
    unit: str
    expected: float | None
    note: str = ""
