"""The limits of engines on one scene as the time step goes to zero, and the differences between them: those of their models."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from bodycheck.adapters.contract import Engine
from bodycheck.errors import BadInput
from bodycheck.files.temporary import temporary_folder
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.running.refining import Motion
from bodycheck.studies.estimate.distances import differences, in_common
from bodycheck.studies.estimate.method import Refined
from bodycheck.studies.estimate.quantities import OF_ONE_RUN
from bodycheck.studies.parity import study as parity
from bodycheck.studies.parity.wording import brief, engines_of

#: The differences between the limits of pairs of engines, each with its uncertainty, by quantities.
Spread = list[tuple[str, str, dict[str, tuple[float, float]]]]

#: The number of states at which the models of engines are compared with the file.
COMPARED_STATES = 20


@dataclass(frozen=True, eq=False)
class Limit:
    """The run of an engine that is closest to its limit, and the upper ends of the errors of this run, by quantities."""

    motion: Motion
    errors: Mapping[str, float]


def limit_of(duration: float, known: Sequence[Refined]) -> Limit | None:
    """Return the finest run of the method whose finest run has the smallest error; None if no finest run has an estimate.

    duration: the duration of the runs (s). known: the runs of the methods of one engine.
    """
    limits = []
    for refined in known:
        errors: dict[str, float] = {}
        for quantity in refined.levels.quantities:
            reference = refined.assessed(quantity, duration)
            if not isinstance(reference, str) and quantity not in OF_ONE_RUN:
                interval = refined.intervals(quantity, duration, reference)[-1]
                errors |= {} if interval is None else {quantity: interval.high}
        if errors:
            limits.append(Limit(refined.levels.levels[-1].motion, errors))
    return min(limits, key=lambda limit: max(limit.errors.values()), default=None)


def between(scene: AnyScene | None, duration: float, compared: Sequence[str], limits: Mapping[str, Limit]) -> Spread:
    """Return the differences between the limits of engines, at the instants that their finest runs have in common.

    Parameters
    ----------
    scene
        The scene of a case; None for a file.
    duration
        The duration of the runs (s).
    compared
        The quantities.
    limits
        The limits by the names of engines.
    """
    spread: Spread = []
    for (one, here), (other, there) in combinations(limits.items(), 2):
        places = np.searchsorted(here.motion.t, there.motion.t + 1e-9 * duration, side="right") - 1
        same = np.abs(here.motion.t[places] - there.motion.t) <= 1e-9 * duration
        parts = here.motion.part(places[same]), there.motion.part(np.flatnonzero(same))
        apart = differences(scene, *(parts if scene is not None else in_common(*parts))) if same.any() else {}
        both = [name for name in compared if name in apart and name in here.errors and name in there.errors]
        spread.append((one, other, {name: (float(apart[name].max()), here.errors[name] + there.errors[name]) for name in both}))
    return spread


def causes_of(path: Path | None, packages: tuple[Path, ...], records: Mapping[str, Engine]) -> dict[str, str]:
    """Return for each of several engines what its reader makes of a file other than the file says, as `bodycheck parity` does.

    Empty for a case, which has no file, for a single engine, and for a file that only engines read.
    """
    if path is None or len(records) < 2:
        return {}
    with temporary_folder() as folder, parity.asking(records, 1) as how:
        try:
            found = parity.one(records, path, parity.Asking(COMPARED_STATES, packages=packages), folder, how)
        except BadInput:
            return {}
    return {engine: brief(rows) for engine, rows in engines_of(found).items()}
