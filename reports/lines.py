"""The line that represents a method in charts and legends.

The hue shows the adapter of the engine and is the same in every report. Dashes and shade show the integrator and the release of
the engine, and the width shows the time step.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from zlib import crc32

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.reports.quantities import milliseconds
from bodycheck.results.key import RunKey

#: The two shades of the hue of each engine, by the name of its adapter. Among them are the colours of Okabe and Ito, the palest
#: of which are darker here. The other colours are as far as possible in OKLab from all shades of other hues, also for readers
#: without green cones. All have a contrast of at least 3 to white and to the dark background.
HUES: Mapping[str, tuple[str, str]] = {
    "mujoco": ("#0072b2", "#3d8fc6"),
    "pinocchio": ("#d55e00", "#a84a00"),
    "drake": ("#009e73", "#00795a"),
    "dart": ("#8c8500", "#6e6800"),
    "pybullet": ("#4b8efe", "#005cdd"),
    "exudyn": ("#777777", "#929292"),
    "simbody": ("#b35c8d", "#cc79a7"),
    "rapier": ("#c37c76", "#94524d"),
    "sapien": ("#4da537", "#227702"),
    "mjx": ("#9e71fe", "#7f33ea"),
    "mjx32": ("#d14bee", "#a913c5"),
    "mujoco_warp": ("#ff4044", "#cd0221"),
    "newton": ("#42a0af", "#02707e"),
    "brax": ("#6f5bb5", "#8a78cc"),
}

#: The hues of all other engines. The name of an adapter determines its hue.
FURTHER_HUES = (
    ("#f34881", "#c60d5d"),
    ("#f233b4", "#be048a"),
    ("#c568cb", "#993f9f"),
    ("#a781b8", "#7b578b"),
)

#: The dash patterns of lines: lengths on and off, in pixels.
DASHES: tuple[tuple[int, ...], ...] = ((1, 0), (7, 3), (2, 2), (9, 3, 2, 3), (4, 4), (12, 4), (6, 2, 2, 2, 2, 2), (1, 4))
#: The widths of lines in pixels, from the largest time step to the smallest.
WIDTHS = (2.0, 1.3, 0.8)

#: With several sets of results, the last set has the usual lines. Each earlier set has paler lines that are broader by this
#: many widths, so that they remain visible beneath the others.
BAND = 1.5

#: The grey (0 to 255) that is mixed into paler lines.
PALE = 200


@dataclass(frozen=True)
class Line:
    """The name and the style of one method in a report.

    Parameters
    ----------
    key
        The method over all cases, with the label of its set of results. Its time step is 0 for a line through all time steps.
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
    """Return a line for every method, grouped by engine and then in the order of first appearance.

    Labels contain the time step only if the methods have several time steps.
    """
    given = list(dict.fromkeys(keys))
    steps = sorted({key.method.timestep for key in given}, reverse=True)
    labels = list(dict.fromkeys(key.label for key in given))
    lines = {}
    for key, (adapter, place) in _places(given).items():
        timestep = key.method.timestep
        step = f" {milliseconds(timestep)}" if len(steps) > 1 else ""
        label = f"{key.engine} {key.method.name}{step}" + (f" ({key.label})" if key.label else "")
        turns, dash = divmod(place, len(DASHES))
        earlier = len(labels) - 1 - labels.index(key.label)
        colour = paled(hue(adapter)[(place + turns) % 2], earlier)
        width = WIDTHS[min(steps.index(timestep), len(WIDTHS) - 1)] * (1 + BAND * earlier)
        lines[key] = Line(key, label, colour, DASHES[dash], width)
    return lines


def hue(adapter: str) -> tuple[str, str]:
    """Return the two shades of the lines of all engines with an adapter. They depend only on the name of the adapter."""
    return HUES.get(adapter) or FURTHER_HUES[crc32(adapter.encode("utf-8")) % len(FURTHER_HUES)]


def _places(given: Sequence[RunKey]) -> dict[RunKey, tuple[str, int]]:
    """Return the adapter of each method, and the position of the method among the methods of all releases with the adapter."""
    by_engine: dict[str, dict[str, list[RunKey]]] = {}
    for key in given:
        by_engine.setdefault(key.engine, {}).setdefault(key.method.name, []).append(key)
    taken: dict[str, int] = {}
    places: dict[RunKey, tuple[str, int]] = {}
    for engine, methods in by_engine.items():
        adapter = adapter_of(engine)
        for own in methods.values():
            place = taken.get(adapter, 0)
            taken[adapter] = place + 1
            places |= dict.fromkeys(own, (adapter, place))
    return places


def paled(colour: str, times: int) -> str:
    """Return a colour after mixing it in equal parts with a light grey, repeated `times` times."""
    for _ in range(times):
        channels = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
        colour = "#" + "".join(f"{(channel + PALE) // 2:02x}" for channel in channels)
    return colour
