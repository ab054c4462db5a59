"""How a method is drawn: the hue tells the engine, the same in every chart; dash and shade the integrator, width the step."""

from collections.abc import Iterable
from dataclasses import dataclass

from bodycheck.reports.quantities import milliseconds

Key = tuple[str, str, float]
"""engine, integrator, time step (s)"""

HUES = (
    ("#0072b2", "#3d8fc6"),
    ("#d55e00", "#a84a00"),
    ("#009e73", "#00795a"),
    ("#b35c8d", "#cc79a7"),
    ("#8c8500", "#6e6800"),
    ("#6f5bb5", "#8a78cc"),
    ("#777777", "#929292"),
)
"""Okabe and Ito's colours, which colour-blind readers tell apart, the palest deepened: all readable on white and on black."""

FIRST = ("mujoco", "pinocchio")
"""Engines whose hue is the same in every report, whatever other engines it has."""

DASHES: tuple[tuple[int, ...], ...] = ((1, 0), (7, 3), (2, 2), (9, 3, 2, 3), (4, 4), (12, 4), (6, 2, 2, 2, 2, 2), (1, 4))
WIDTHS = (2.0, 1.3, 0.8)


@dataclass(frozen=True)
class Line:
    """One method: what it is called in this report and how it is drawn. dash: lengths on and off, in pixels.

    timestep: in s, 0 for a line through all time steps.
    """

    engine: str
    integrator: str
    timestep: float
    label: str
    colour: str
    dash: tuple[int, ...]
    width: float


def assign(keys: Iterable[Key]) -> dict[Key, Line]:
    """A line for every method, engine by engine, otherwise in the order of first appearance.

    A label has the time step in it only where the report has several.
    """
    given = list(dict.fromkeys(keys))
    engines = list(dict.fromkeys(engine for engine, _, _ in given))
    steps = sorted({timestep for _, _, timestep in given}, reverse=True)
    others = sorted(set(engines) - set(FIRST))
    hues = {engine: HUES[place % len(HUES)] for place, engine in enumerate((*FIRST, *others))}
    lines = {}
    for engine in engines:
        own = [key for key in given if key[0] == engine]
        integrators = list(dict.fromkeys(integrator for _, integrator, _ in own))
        for key in sorted(own, key=lambda key: integrators.index(key[1])):
            _, integrator, timestep = key
            place = integrators.index(integrator)
            label = f"{engine} {integrator}" + (f" {milliseconds(timestep)}" if len(steps) > 1 else "")
            turns, dash = divmod(place, len(DASHES))
            colour = hues[engine][(place + turns) % 2]
            width = WIDTHS[min(steps.index(timestep), len(WIDTHS) - 1)]
            lines[key] = Line(engine, integrator, timestep, label, colour, DASHES[dash], width)
    return lines
