"""How a method is drawn: the hue tells the engine, the same in every chart; dash and shade the integrator, width the step."""

from collections.abc import Iterable
from dataclasses import dataclass

from bodycheck.reports.quantities import milliseconds

#: engine, integrator, time step (s), label of the set of results; the last is empty where there is one set only
Key = tuple[str, str, float, str]

#: Okabe and Ito's colours, which colour-blind readers tell apart, the palest deepened: all readable on white and on black.
HUES = (
    ("#0072b2", "#3d8fc6"),
    ("#d55e00", "#a84a00"),
    ("#009e73", "#00795a"),
    ("#b35c8d", "#cc79a7"),
    ("#8c8500", "#6e6800"),
    ("#6f5bb5", "#8a78cc"),
    ("#777777", "#929292"),
)

#: Engines whose hue is the same in every report, whatever other engines it has.
FIRST = ("mujoco", "pinocchio")

DASHES: tuple[tuple[int, ...], ...] = ((1, 0), (7, 3), (2, 2), (9, 3, 2, 3), (4, 4), (12, 4), (6, 2, 2, 2, 2, 2), (1, 4))
WIDTHS = (2.0, 1.3, 0.8)

#: Of several sets of results the last is drawn as one alone would be, each before it paler and as a broader band beneath.
#:
#: BAND: by so many of its widths a line is broader. PALE: the grey that is mixed in, of 255.
BAND, PALE = 1.5, 200


@dataclass(frozen=True)
class Line:
    """One method: what it is called in this report and how it is drawn. dash: lengths on and off, in pixels.

    timestep: in s, 0 for a line through all time steps. results: the label of the set that it is of.
    """

    engine: str
    integrator: str
    timestep: float
    label: str
    colour: str
    dash: tuple[int, ...]
    width: float
    results: str = ""


def assign(keys: Iterable[Key]) -> dict[Key, Line]:
    """A line for every method, engine by engine, otherwise in the order of first appearance.

    A label has the time step in it only where the report has several.
    """
    given = list(dict.fromkeys(keys))
    engines = list(dict.fromkeys(engine for engine, *_ in given))
    steps = sorted({timestep for _, _, timestep, _ in given}, reverse=True)
    labels = list(dict.fromkeys(label for *_, label in given))
    others = sorted(set(engines) - set(FIRST))
    hues = {engine: HUES[place % len(HUES)] for place, engine in enumerate((*FIRST, *others))}
    lines = {}
    for engine in engines:
        own = [key for key in given if key[0] == engine]
        integrators = list(dict.fromkeys(integrator for _, integrator, _, _ in own))
        for key in sorted(own, key=lambda key: integrators.index(key[1])):
            _, integrator, timestep, results = key
            place = integrators.index(integrator)
            step = f" {milliseconds(timestep)}" if len(steps) > 1 else ""
            label = f"{engine} {integrator}{step}" + (f" ({results})" if results else "")
            turns, dash = divmod(place, len(DASHES))
            earlier = len(labels) - 1 - labels.index(results)
            colour = paled(hues[engine][(place + turns) % 2], earlier)
            width = WIDTHS[min(steps.index(timestep), len(WIDTHS) - 1)] * (1 + BAND * earlier)
            lines[key] = Line(engine, integrator, timestep, label, colour, DASHES[dash], width, results)
    return lines


def paled(colour: str, times: int) -> str:
    """A colour, mixed half and half with a light grey so many times."""
    for _ in range(times):
        channels = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
        colour = "#" + "".join(f"{(channel + PALE) // 2:02x}" for channel in channels)
    return colour
