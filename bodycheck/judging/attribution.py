"""Where a discrepancy of contact comes from: the form of the model, the contact's own softness or error, the time step.

The engine's contacts stand for a friction law, say that of four corners whose loads balance the tipping of the body, which
need not be the one that the case asks for.
Both have exact truths: their difference is *model form*. What an engine tends to as its step goes to zero need not be the
truth of its own law: that difference is *constraint*. What is left at a step, and vanishes with it, is *time step*. The three
add up.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

from bodycheck.judging.judgement import LABEL, Verdict
from bodycheck.reference.contact_observables import measured_stop
from bodycheck.reference.planar import Stop, yaw
from bodycheck.reference.scene import Plane, Scene
from bodycheck.running import csv_tables
from bodycheck.running.key import RunKey
from bodycheck.running.outcome import Completed, Run
from bodycheck.running.store import Results
from bodycheck.running.truths import stop_under

#: s, m from the start, rad from the start.
QUANTITIES = ("stop_time", "stop_distance", "stop_yaw")


@dataclass(frozen=True)
class Attribution:
    """The signed parts of one quantity's discrepancy, engine minus truth, in the quantity's unit.

    total = model_form + constraint + time_step. model_form is None where the engine's contacts make no law of the reference;
    the constraint then contains it. The last two are None for a method that was run with one step only.
    """

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    quantity: str
    total: float
    model_form: float | None
    constraint: float | None
    time_step: float | None


COLUMNS = tuple(field.name for field in fields(Attribution))


def attribute(results: Results, verdicts: Iterable[Verdict]) -> list[Attribution]:
    """The parts of every completed run on a plane whose truth stops.

    The stops under the laws of friction are read from the results. Those of earlier versions, and interrupted ones, lack
    these records: their stops are computed here, once for each case and law.

    The limit of a vanishing step is Richardson's, for a discrepancy of first order, from a method's two smallest steps.
    """
    stops = dict(results.stops)
    methods: dict[RunKey, dict[float, Run]] = defaultdict(dict)
    for run in (verdict.run for verdict in verdicts if isinstance(verdict.outcome, Completed)):
        if results.cases[run.case].scene.plane is not None:
            methods[run.key.over_steps][run.method.timestep] = run
    found: list[Attribution] = []
    for key, by_step in methods.items():
        case = key.case
        scene = results.cases[case].scene
        asked, implied = (_exact(results, case, law, stops) for law in (scene.plane, next(iter(by_step.values())).contact_law))
        if asked is None:
            continue
        seen = {
            step: _quantities(scene, measured_stop(scene, run.outcome.trajectory))
            for step, run in by_step.items()
            if isinstance(run.outcome, Completed)
        }
        steps = sorted(seen)
        for quantity in QUANTITIES:
            limit = None
            if len(steps) > 1:
                fine, coarse = steps[:2]
                slope = (seen[coarse][quantity] - seen[fine][quantity]) / (coarse - fine)
                limit = seen[fine][quantity] - slope * fine
            for step in steps:
                found.append(
                    Attribution(
                        *(case, key.engine, by_step[step].version, key.method.name, step, quantity),
                        total=seen[step][quantity] - asked[quantity],
                        model_form=None if implied is None else implied[quantity] - asked[quantity],
                        constraint=None if limit is None else limit - (implied or asked)[quantity],
                        time_step=None if limit is None else seen[step][quantity] - limit,
                    )
                )
    return found


def write(attributions: Mapping[str, Iterable[Attribution]], folder: Path) -> None:
    """Write attribution.csv into a folder if there are any attributions.

    They are given by the label of their set of results, which is a column of the table if there are several sets.
    """
    rows = [{LABEL: label} | asdict(part) for label, own in attributions.items() for part in own]
    if len(attributions) == 1:
        rows = [{name: row[name] for name in COLUMNS} for row in rows]
    if rows:
        csv_tables.write(folder / "attribution.csv", list(rows[0]), rows)


def _exact(
    results: Results, name: str, law: Plane | None, stops: dict[tuple[str, Plane], Stop | None]
) -> dict[str, float] | None:
    """The quantities of the truth of a case under a law, None where it does not stop; a stop that is missing is added."""
    if law is None:
        return None
    case = results.cases[name]
    if (name, law) not in stops:
        stops[name, law] = stop_under(case, law)
    stop = stops[name, law]
    return None if stop is None else _quantities(case.scene, stop)


def _quantities(scene: Scene, stop: Stop) -> dict[str, float]:
    way = math.dist(stop.position[:2], scene.initial.position[:2])
    return dict(zip(QUANTITIES, (stop.time, way, stop.yaw - float(yaw(np.array(scene.initial.quaternion)))), strict=True))
