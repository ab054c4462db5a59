"""The tracks of a results folder: how truths were computed, and the motions of engines with the methods they choose."""

import contextlib
import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.casefile.content import Case
from bodycheck.errors import BadFolder
from bodycheck.files import reading
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.reports.lines import assign
from bodycheck.reports.runs.motions.animation import animation
from bodycheck.reports.runs.motions.cast import ERRORS, Cast, Shown
from bodycheck.results import records, store
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed
from bodycheck.results.store import Results
from bodycheck.results.trajectory_files import TRAJECTORIES
from bodycheck.site.submissions.own_methods import own_method
from bodycheck.site.submissions.submission import Row
from bodycheck.site.submissions.tracks import Motion, Tracks

#: The most characters of the motions of a case; a chain of twenty bodies in eleven engines needs half of them.
MOST_CHARACTERS = 800_000


def traced(folder: Path, rows: Sequence[Row]) -> Tracks:
    """Return the tracks of a results folder. rows: the rows of its results.csv.

    Raises `BadFolder` if the folder is damaged or contains a symbolic link.
    """
    motions_at = folder / TRAJECTORIES
    if motions_at.is_symlink():
        raise BadFolder(f"{motions_at}: is a symbolic link; a results folder must not contain any, remove it")
    reading.refuse_links(motions_at)
    results = store.read(folder)
    truths = [record for record in results.records if record["record"] == "truth"]
    told = {record["case"]: {name: record[name] for name in record if name != "record"} for record in reversed(truths)}
    by_case: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        by_case[row["case"]].append(row)
    there = results.cases if motions_at.is_dir() else {}
    motions = [made for name, own in by_case.items() if name in there for made in _motions(results, there[name], own)]
    return Tracks(dict(sorted(told.items())), motions)


def _motions(results: Results, case: Case, rows: Sequence[Row]) -> Iterator[Motion]:
    """Yield the motions of a case: one for each time step of the engines' own methods, of runs that are sampled alike."""
    engines: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in rows:
        engines[adapter_of(row["engine"]), row["version"]].append(row)
    steps: dict[float, list[Row]] = defaultdict(list)
    for own in engines.values():
        chosen = own[own_method(own, results.header["defaults"])]
        if chosen["status"] == Completed.status:
            steps[chosen["timestep"]].append(chosen)
    for _, chosen_rows in sorted(steps.items()):
        sampling = RunKey.of_row(chosen_rows[0]).method.sampling
        alike = [row for row in chosen_rows if RunKey.of_row(row).method.sampling == sampling]
        truth = results.truth(case.name, sampling)
        if isinstance(truth, Truth) and (made := _motion(results, case, truth.trajectory, alike)) is not None:
            yield made


def _motion(results: Results, case: Case, exact: Trajectory, rows: Sequence[Row]) -> Motion | None:
    """Return the motions of the truth and of runs with one time step; None if no run has a motion that can be shown."""
    by_label = {}
    for row in rows:
        if (shown := _shown(results, case, exact, row)) is not None:
            by_label[f"{shown.line.engine} {shown.line.integrator}"] = (row, shown)
    if not by_label or len(exact) < 2:
        return None
    runs = tuple(shown for _, shown in by_label.values())
    cast = Cast(RunKey.of_row(rows[0]).method.sampling, exact, runs, (), False)
    played = animation(case.scene, cast, MOST_CHARACTERS)
    if played.data is None:
        return None
    several = played.frame is not None
    made = {
        "case": case.name,
        "timestep": rows[0]["timestep"],
        "end": played.data["end"],
        "truth": _parts(played.data["truth"], several),
        "runs": [_named(by_label[entry["label"]][0]) | {"parts": _parts(entry, several)} for entry in played.data["runs"]],
        "momentum": played.data.get("momentum", 0.0),
        "frame": None if played.frame is None else asdict(played.frame),
    }
    with contextlib.suppress(ValueError):  # some lengths or rates are too large for any picture
        return records.typed(Motion, made)
    return None


def _shown(results: Results, case: Case, exact: Trajectory, row: Row) -> Shown | None:
    """Return the motions of a run and of the truth at the instants of the run; None if they cannot be shown together."""
    key = RunKey.of_row(row)
    run = results.run(key)
    if run is None or not isinstance(run.outcome, Completed):
        return None
    maxima = {name: row[name] for name in ERRORS if row.get(name) is not None}
    if isinstance(case.scene, Scene) and not touches(case.scene) and len(maxima) < len(ERRORS):
        return None
    trajectory = run.outcome.trajectory
    places = np.minimum(np.searchsorted(exact.t, trajectory.t), len(exact) - 1)
    if not np.array_equal(exact.t[places], trajectory.t) or not all(map(math.isfinite, maxima.values())):
        return None
    return Shown(assign([key])[key], trajectory, exact.part(places), maxima)


def _named(row: Row) -> dict[str, Any]:
    return {name: row[name] for name in ("engine", "version", "integrator")}


def _parts(entry: Mapping[str, Any], several: bool) -> list[dict[str, Any]]:
    """Return the parts of a motion from its entry in the data of the player. several: whether the entry lists bodies."""
    if several:
        return list(entry.get("parts", ()))
    return [{name: entry[name] for name in ("turning", "course") if name in entry}]
