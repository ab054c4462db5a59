"""Attribute the errors of a run with contact to the form of the model, the contact constraint, and the time step.

The engine's contacts imply a friction law, for example the law of four corners whose loads balance the tipping moment. It may
differ from the law of the case. Both laws have exact truths, whose difference is the *model form* error. The limit of the
engine's results for vanishing time steps may differ from the truth of its own law; this is the *constraint* error. The
remaining error at a given step, which vanishes with it, is the *time step* error. The sum of the three is the total error.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from bodycheck.adapters.method import Method
from bodycheck.judging.judgement import LABEL, Verdict
from bodycheck.reference.contact_observables import measured_stop
from bodycheck.reference.mechanisms.mechanism import alone
from bodycheck.reference.planar import Stop, yaw
from bodycheck.reference.requirements import slides
from bodycheck.reference.scene import Plane, Scene
from bodycheck.results import csv_tables
from bodycheck.results.key import RunKey
from bodycheck.results.origin import Origins
from bodycheck.results.outcome import Completed, Run
from bodycheck.results.store import Results
from bodycheck.results.tables import RESULTS, RUN, Meaning, Table, table_of
from bodycheck.running.truths import stop_under

#: The attributed quantities: time (s), distance from the start (m) and rotation since the start (rad) at the stop.
QUANTITIES = ("stop_time", "stop_distance", "stop_yaw")


@dataclass(frozen=True)
class Attribution:
    """The signed parts of the error of one quantity, engine minus truth, in the quantity's unit."""

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    quantity: Annotated[str, Meaning("Quantity", "what the numbers of the row are of")]
    total: Annotated[float, Meaning("Total", "error of the quantity, engine minus truth, in s, m or rad", signed=True)]
    model_form: Annotated[
        float | None,
        Meaning(
            "Model form",
            "part of the error from another law of friction; empty if the reference has no such law, and the constraint then "
            "contains it",
            signed=True,
        ),
    ]
    constraint: Annotated[
        float | None,
        Meaning(
            "Constraint",
            "part that remains for vanishing time steps under the engine's own law; empty for a method with one time step",
            signed=True,
        ),
    ]
    time_step: Annotated[
        float | None,
        Meaning("Time step", "part that vanishes with the time step; empty for a method with one time step", signed=True),
    ]

    @property
    def key(self) -> RunKey:
        """The run."""
        return RunKey(self.case, self.engine, Method.parse(self.integrator, self.timestep))


PARTS = table_of(
    Attribution,
    "attribution",
    "parts of errors",
    key=(*RUN, "quantity"),
    filled=("case", "engine", "version", "integrator", "timestep", "quantity"),
)

#: The same table for several sets of results.
PARTS_OF_SETS: Table[Mapping[str, Any]] = Table(
    PARTS.name, PARTS.title, None, (RESULTS.by_name[LABEL], *PARTS.columns), (LABEL, *PARTS.key), PARTS.filled
)


def attribute(results: Results, verdicts: Iterable[Verdict]) -> list[Attribution]:
    """Return the parts of the errors of every completed run on a plane, if the body stops in the truth.

    The stops under the laws of friction are read from the results. Interrupted results and results of earlier versions lack
    these records; their stops are computed here, once for each case and law.

    The limit for vanishing time steps is extrapolated from a method's two smallest steps by Richardson's method for errors of
    first order. There is none with error control, where the largest step does not determine the steps.
    """
    stops = dict(results.stops)
    methods: dict[RunKey, dict[float, Run]] = defaultdict(dict)
    for run in (verdict.run for verdict in verdicts if isinstance(verdict.outcome, Completed)):
        scene = results.cases[run.case].scene
        if slides(scene):
            methods[run.key.over_steps][run.method.timestep] = run
    attributions: list[Attribution] = []
    for key, by_step in methods.items():
        case = key.case
        scene = alone(results.cases[case].scene)
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
            if len(steps) > 1 and key.method.accuracy is None:
                fine, coarse = steps[:2]
                slope = (seen[coarse][quantity] - seen[fine][quantity]) / (coarse - fine)
                limit = seen[fine][quantity] - slope * fine
            for step in steps:
                attributions.append(
                    Attribution(
                        *(case, key.engine, by_step[step].version, key.method.name, step, quantity),
                        total=seen[step][quantity] - asked[quantity],
                        model_form=None if implied is None else implied[quantity] - asked[quantity],
                        constraint=None if limit is None else limit - (implied or asked)[quantity],
                        time_step=None if limit is None else seen[step][quantity] - limit,
                    )
                )
    return attributions


def write(attributions: Mapping[str, Iterable[Attribution]], folder: Path, origins: Origins) -> None:
    """Write attribution.csv into a folder if there are any attributions.

    Attributions are given by the label of their set of results, which is a column of the table if there are several sets.
    origins: the origins of the numbers, which are written too.
    """
    if len(attributions) > 1:
        rows = [{LABEL: label} | asdict(part) for label, parts in attributions.items() for part in parts]
        if rows:
            csv_tables.write(folder, PARTS_OF_SETS, rows, origins)
    elif parts := [part for parts in attributions.values() for part in parts]:
        csv_tables.write(folder, PARTS, parts, origins)


def _exact(
    results: Results, name: str, law: Plane | None, stops: dict[tuple[str, Plane], Stop | None]
) -> dict[str, float] | None:
    """Return the quantities of a case's truth under a law of friction; None if the body does not stop.

    A stop that is missing in `stops` is computed and added.
    """
    if law is None:
        return None
    case = results.cases[name]
    if (name, law) not in stops:
        stops[name, law] = stop_under(case, law)
    stop = stops[name, law]
    return None if stop is None else _quantities(alone(case.scene), stop)


def _quantities(scene: Scene, stop: Stop) -> dict[str, float]:
    way = math.dist(stop.position[:2], scene.initial.position[:2])
    return dict(zip(QUANTITIES, (stop.time, way, stop.yaw - float(yaw(np.array(scene.initial.quaternion)))), strict=True))
