"""The line that stands for a method in charts and legends.

The hue shows the engine and is the same in every chart, dashes and shade show the integrator, and the width the time step.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from bodycheck.reports.quantities import milliseconds
from bodycheck.running.key import RunKey

#: Two shades for each hue: the colours of Okabe and Ito, which colour-blind readers can distinguish, with the palest
#: deepened so that all are readable on white and on black.
HUES = (
    ("#0072b2", "#3d8fc6"),
    ("#d55e00", "#a84a00"),
    ("#009e73", "#00795a"),
    ("#b35c8d", "#cc79a7"),
    ("#8c8500", "#6e6800"),
    ("#6f5bb5", "#8a78cc"),
    ("#777777", "#929292"),
)

#: Engines that always have the first hues, so that these are the same in every report.
FIRST = ("mujoco", "pinocchio")

#: Lengths on and off, in pixels.
DASHES: tuple[tuple[int, ...], ...] = ((1, 0), (7, 3), (2, 2), (9, 3, 2, 3), (4, 4), (12, 4), (6, 2, 2, 2, 2, 2), (1, 4))
#: Pixels, from the largest time step to the smallest.
WIDTHS = (2.0, 1.3, 0.8)

#: Of several sets of results the last has the usual lines. Each earlier set has paler lines that are broader by this many
#: widths, so that they remain visible beneath.
BAND = 1.5

#: The grey (0 to 255) that is mixed into paler lines.
PALE = 200


@dataclass(frozen=True)
class Line:
    """The name and the style of one method in a report.

    Parameters
    ----------
    key
        The method over all cases, with the label of its set of results; its time step is 0 for a line through all time steps.
    label
        Name of the method in this report.
    colour, dash, width
        Style; the dash is lengths on and off, and lengths and width are in pixels.
    """

    key: RunKey
    label: str
    colour: str
    dash: tuple[int, ...]
    width: float

    @property
    def engine(self) -> str:
        """The name of the engine."""
        return self.key.engine

    @property
    def integrator(self) -> str:
        """The integrator with its options."""
        return self.key.method.name

    @property
    def timestep(self) -> float:
        """The time step (s); 0 for a line through all time steps."""
        return self.key.method.timestep

    @property
    def results(self) -> str:
        """The label of the set of results, empty if there is only one set."""
        return self.key.label


def assign(keys: Iterable[RunKey]) -> dict[RunKey, Line]:
    """Return a line for every method, engine by engine and otherwise in the order of first appearance.

    Labels contain the time step only if the methods have several.
    """
    given = list(dict.fromkeys(keys))
    engines = list(dict.fromkeys(key.engine for key in given))
    steps = sorted({key.method.timestep for key in given}, reverse=True)
    labels = list(dict.fromkeys(key.label for key in given))
    others = sorted(set(engines) - set(FIRST))
    hues = {engine: HUES[place % len(HUES)] for place, engine in enumerate((*FIRST, *others))}
    lines = {}
    for engine in engines:
        own = [key for key in given if key.engine == engine]
        integrators = list(dict.fromkeys(key.method.name for key in own))
        for key in sorted(own, key=lambda key: integrators.index(key.method.name)):
            integrator, timestep = key.method.name, key.method.timestep
            place = integrators.index(integrator)
            step = f" {milliseconds(timestep)}" if len(steps) > 1 else ""
            label = f"{engine} {integrator}{step}" + (f" ({key.label})" if key.label else "")
            turns, dash = divmod(place, len(DASHES))
            earlier = len(labels) - 1 - labels.index(key.label)
            colour = paled(hues[engine][(place + turns) % 2], earlier)
            width = WIDTHS[min(steps.index(timestep), len(WIDTHS) - 1)] * (1 + BAND * earlier)
            lines[key] = Line(key, label, colour, DASHES[dash], width)
    return lines


def paled(colour: str, times: int) -> str:
    """Return a colour after mixing it half and half with a light grey so many times."""
    for _ in range(times):
        channels = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
        colour = "#" + "".join(f"{(channel + PALE) // 2:02x}" for channel in channels)
    return colour
