"""The properties of contacts in words: the heads of their columns, and which law the contacts of a method follow."""

from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.reports.quantities import number
from bodycheck.studies.contact.property import Name
from bodycheck.studies.contact.rows import PropertyRow

#: A depth (m), a speed (m/s) and a relative difference below these count as none.
LEAST_DEPTH, LEAST_SPEED, LEAST_PART = 1e-7, 1e-6, 0.01

#: A depth that grows by more than this factor with a mass that is a hundredfold is that of a spring.
SPRING = 10.0


@dataclass(frozen=True)
class PropertyColumn:
    """A column of the table of properties: its head, and the property and the condition that it shows."""

    title: str
    name: Name
    condition: str = ""

    @property
    def key(self) -> tuple[str, str]:
        """The property and the condition."""
        return self.name, self.condition


#: The columns of the table of properties.
COLUMNS = (
    PropertyColumn("Keeps at 0.1 m/s", "restitution", "0.1 m/s"),
    PropertyColumn("at 1 m/s", "restitution", "1 m/s"),
    PropertyColumn("at 1 m/s, quarter step", "restitution", "1 m/s, a quarter of the step"),
    PropertyColumn("Bounces above, m/s", "bounce-threshold"),
    PropertyColumn("Energy of an impact", "impact_energy_error"),
    PropertyColumn("Depth of 1 kg, m", "depth-at-rest", "1 kg"),
    PropertyColumn("of 100 kg, m", "depth-at-rest", "100 kg"),
    PropertyColumn("Asleep below, m/s", "sleeping"),
    PropertyColumn("Creep, m/s", "creep"),
    PropertyColumn("Viscous below, m/s", "viscous-speed"),
    PropertyColumn("Anisotropy", "friction-anisotropy", "edges along the axes of the world"),
)


def law(rows: Sequence[PropertyRow]) -> str:
    """Return which law the contacts of a method follow, as far as its properties show it, in one sentence."""
    values = {(row.property, row.condition): row.value for row in rows}
    parts = (_normal(values), _rebound(values), _friction(values), _sleep(values))
    sentence = "; ".join(part for part in parts if part)
    return f"{sentence}." if sentence else "the probes have no value."


#: The values of a method, by property and condition.
Values = dict[tuple[str, str], float | None]


def _normal(values: Values) -> str:
    """Return what bears a body at rest."""
    light, heavy = (values.get(("depth-at-rest", mass)) for mass in ("1 kg", "100 kg"))
    if light is None or heavy is None:
        return ""
    if max(abs(light), abs(heavy)) < LEAST_DEPTH:
        return "bodies at rest lie on the plane"
    where = f"a ball of 1 kg lies {number(abs(light), 3)} m {'deep' if light > 0 else 'above the plane'}"
    if light > 0 and heavy > SPRING * light:
        return f"{where}, and one of 100 kg {number(heavy / light, 3)} times as deep: the plane is a spring"
    if light > 0 and abs(heavy / light - 1) < LEAST_PART:
        return f"{where}, whatever its mass"
    return f"{where}, and one of 100 kg {number(abs(heavy), 3)} m{'' if (heavy > 0) == (light > 0) else ' deep'}"


def _rebound(values: Values) -> str:
    """Return what becomes of the restitution of 0.5."""
    kept = [round(value, 3) for (name, _), value in values.items() if name == "restitution" and value is not None]
    if not kept:
        return ""
    least, most = min(kept), max(kept)
    size = number(least, 2) if most - least < LEAST_PART else f"{number(least, 2)} to {number(most, 2)}"
    slowest = values.get(("bounce-threshold", ""))
    below = f", and nothing bounces below {number(slowest, 2)} m/s" if slowest else ""
    return f"a restitution of 0.5 is {size}{below}"


def _friction(values: Values) -> str:
    """Return the law of friction."""
    speed, creep = values.get(("viscous-speed", "")), values.get(("creep", ""))
    unequal = values.get(("friction-anisotropy", "edges along the axes of the world"))
    parts = []
    if speed is not None:
        parts.append(f"is viscous below {number(speed, 2)} m/s" if speed > LEAST_SPEED else "brakes as Coulomb's law")
    if creep is not None and creep > LEAST_SPEED:
        parts.append(f"lets a box that it should hold creep at {number(creep, 2)} m/s")
    if unequal is not None and abs(unequal) > LEAST_PART:
        parts.append(f"differs by {number(100 * unequal, 2)} % between directions")
    return f"friction {' and '.join(parts)}" if parts else ""


def _sleep(values: Values) -> str:
    slowest = values.get(("sleeping", ""))
    return f"a ball that rolls below {number(slowest, 2)} m/s falls asleep" if slowest else ""
