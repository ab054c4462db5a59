"""How much worse the figures of a baseline may get before `bodycheck diff` fails."""

from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.errors import BadInput
from bodycheck.judging.baselines.baseline import FIGURES, Change, Difference
from bodycheck.suggestion import did_you_mean


@dataclass(frozen=True)
class Tolerance:
    """How much worse a figure may get. figure: its column; fraction: the growth of its error, relative to what it was."""

    figure: str
    fraction: float


def parse(texts: Sequence[str]) -> tuple[Tolerance, ...]:
    """Return the tolerances in texts such as `attitude_error:10%`. Raises `BadInput` for any other text, or a figure twice."""
    found = tuple(map(_parsed, texts))
    names = [one.figure for one in found]
    if repeated := [name for name in names if names.count(name) > 1]:
        raise BadInput(f"--fail-on {repeated[0]}: is given twice")
    return found


def failing(found: Difference, tolerances: Sequence[Tolerance]) -> tuple[Change, ...]:
    """Return the changes for the worse that are not tolerated, the worst first.

    Without tolerances these are all. With them, a figure must be named and its error have grown by more than the fraction;
    a worse status and a missing run are never tolerated.

    Raises `BadInput` if nothing fails and a named figure could not be compared in any run, since nothing was checked then.
    """
    if not tolerances:
        return found.worse
    allowed = {one.figure: one.fraction for one in tolerances}
    broken = tuple(
        change
        for change in found.worse
        if change.allowance is None or change.factor - 1 > allowed.get(change.what, float("inf"))
    )
    for name in () if broken else allowed:
        if name in found.redefined:
            raise BadInput(f"--fail-on {name}: its definition has changed since the older baseline; save a new one")
        if name not in found.compared:
            raise BadInput(f"--fail-on {name}: no run of both baselines has it; allowed: {', '.join(found.compared) or 'none'}")
    return broken


def text(broken: Sequence[Change], tolerances: Sequence[Tolerance]) -> str:
    """Return in one line whether any change exceeds the tolerances, and the worst that does."""
    asked = ", ".join(f"{one.figure}:{100 * one.fraction:g}%" for one in tolerances)
    if not broken:
        return f"nothing is worse by more than {asked}"
    changes = "1 change is" if len(broken) == 1 else f"{len(broken)} changes are"
    return f"{changes} not within {asked}; {broken[0].text}"


def _parsed(text: str) -> Tolerance:
    name, _, percent = text.partition(":")
    if name not in FIGURES:
        raise BadInput(f"--fail-on {text}: no figure {name!r}{did_you_mean(name, FIGURES)}; allowed: {', '.join(FIGURES)}")
    try:
        fraction = float(percent.removesuffix("%")) / 100 if percent.endswith("%") else -1.0
    except ValueError:
        fraction = -1.0
    if not 0 <= fraction < float("inf"):
        raise BadInput(f"--fail-on {text}: allowed: the figure and a percentage of at least 0, for example {name}:10%")
    return Tolerance(name, fraction)
