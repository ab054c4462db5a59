"""The measured quantities as reports name them, and numbers as reports print them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context


@dataclass(frozen=True)
class Quantity:
    """A column of results. name: the column's. unit: "" for a pure number. meaning: one sentence for readers."""

    name: str
    title: str
    unit: str
    meaning: str

    @property
    def label(self) -> str:
        """The title with its unit, as an axis or a table's head wants it."""
        return f"{self.title}, {self.unit or 'relative'}"

    def with_unit(self, value: float) -> str:
        """A value with its unit, to four digits."""
        return f"{number(value)} {self.unit}".rstrip()


QUANTITIES = {
    quantity.name: quantity
    for quantity in (
        Quantity("position_error", "Position error", "m", "Distance of the centre of mass from the truth's."),
        Quantity("velocity_error", "Velocity error", "m/s", "Distance of its velocity from the truth's."),
        Quantity("attitude_error", "Attitude error", "rad", "Angle of the one rotation that takes the truth's attitude to it."),
        Quantity("angular_velocity_error", "Angular velocity error", "rad/s", "Distance of the body's rates from the truth's."),
        Quantity("energy_drift", "Energy drift", "", "Change of the total energy, relative to the size it begins with."),
        Quantity("rotational_energy_drift", "Rotational energy drift", "", "The same of the energy of rotation alone."),
        Quantity(
            "angular_momentum_drift",
            "Angular momentum drift",
            "",
            "Change of the angular momentum about the centre of mass in the inertial frame, a vector, relative likewise.",
        ),
        Quantity("energy_error", "Energy error", "", "Distance of the total energy from the truth's, relative."),
        Quantity("rotational_energy_error", "Rotational energy error", "", "The same of the energy of rotation alone."),
        Quantity("angular_momentum_error", "Angular momentum error", "", "Distance of the vector from the truth's, relative."),
        Quantity("stop_time_error", "Stop time error", "s", "By how much it comes to rest too early or too late."),
        Quantity("stop_position_error", "Stop position error", "m", "Distance of where it comes to rest from where it should."),
        Quantity("stop_yaw_error", "Stop yaw error", "rad", "By how much it has turned too far or too little until then."),
        Quantity("creep", "Creep", "m/s", "Mean speed along the plane after the stop."),
        Quantity("penetration", "Penetration", "m", "Depth of the lowest point of the body in the plane."),
        Quantity("tilt", "Tilt", "rad", "Angle between K and the vertical."),
        Quantity("mean_load", "Mean load", "weights", "What the plane bears on the average until the stop."),
        Quantity("peak_load", "Peak load", "weights", "The most that it bears in a step."),
        Quantity("time_in_contact", "In contact", "of the steps", "Part of the steps in which it bears anything."),
    )
}

TABLED = tuple(name for name in QUANTITIES if name != "angular_velocity_error")
"""The columns of a case's table; the results file has the rest."""

PLOTTED = (
    "attitude_error",
    "position_error",
    *("energy_drift", "energy_error"),
    *("angular_momentum_drift", "angular_momentum_error"),
    *("penetration", "tilt"),
)
"""What is drawn over time, where it was measured."""


def number(value: float | None, digits: int = 4) -> str:
    """A number to so many significant digits, its exponent without padding; a dash for what is not there."""
    if value is None or math.isnan(value):
        return "–"
    mantissa, e, exponent = f"{value:.{digits}g}".partition("e")
    return f"{mantissa}e{int(exponent)}" if e else mantissa


def bound(value: float, digits: int = 4) -> str:
    """A number that others do not exceed, rounded up, so that what is printed still bounds them (to a millionth of it)."""
    return number(float(Context(prec=digits, rounding=ROUND_CEILING).create_decimal(f"{value:.7g}")), digits)


def milliseconds(seconds: float, digits: int = 12) -> str:
    """A time step in ms with its unit, all digits that were given unless fewer are asked for."""
    return f"{seconds * 1e3:.{digits}g} ms"


def listing(names: Sequence[str], most: int | None = None, noun: str = "") -> str:
    """Names as a sentence lists them: the first `most` of them, then how many others (of that noun) there are."""
    if most is not None and len(names) > most + 1:
        names = (*names[:most], f"{count(len(names) - most, f'more {noun}')}")
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))


def count(amount: int, noun: str) -> str:
    """An amount of something: 1 run, 2 runs."""
    return f"{amount} {noun}" if amount == 1 else f"{amount} {noun}s"
