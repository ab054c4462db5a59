"""The coordinates of joints over time, in the truth and in runs that differ visibly from it, as the dataset `joints`.

A row is one curve: `joint`, `kind` ("angle" in rad or "slide" in m), `method`, and the arrays `t` and `value`. For a spherical
joint, and for the attitude of a free joint, the value is the angle of the rotation. Targets of controllers are curves too. A
stop is a row with one value, whose `beyond` is "lower" or "upper". `time_charts.joints` draws the curves.
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any, Literal

import numpy as np

from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import COORDINATES, places
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reports.quantities import listing
from bodycheck.reports.runs.targets import target_of
from bodycheck.reports.series import corners, rounded

#: The two kinds of coordinates, and the titles of their charts.
Kind = Literal["angle", "slide"]
TITLES: dict[Kind, str] = {"angle": "Angles of the joints", "slide": "Displacements of the joints"}

#: The names of the truth, the targets and the stops among the methods.
TRUTH, TARGET, STOP = "the truth", "the target", "a stop"

#: The distance of a stop from all curves, relative to their range, above which it is left out so that curves remain readable.
FAR = 1.0

#: What the notes say of targets and stops.
ALSO = {TARGET: "Thin and dotted: the targets of controllers.", STOP: "Bands: beyond the stops of joints."}

#: The kinds of the coordinates of joints that can have a controller or stops.
KINDS: dict[str, Kind] = {"revolute": "angle", "prismatic": "slide"}

#: The most coordinates of each kind that have curves, and the most runs that have curves.
MOST_COORDINATES, MOST_RUNS = 8, 4

#: The most coordinates of a joint.
MOST_OF_A_JOINT = max(COORDINATES.values())

#: The difference from the truth, relative to the range of a coordinate, above which a curve differs visibly.
SEEN = 0.005

#: The significant digits of instants and values; values may be some thousand times as large as the visible differences.
DIGITS = 6


def rows(
    mechanism: Mechanism, truth: Trajectory, runs: Mapping[str, tuple[Trajectory, Trajectory]], most: int
) -> list[dict[str, Any]]:
    """Return the rows of the dataset `joints`.

    Parameters
    ----------
    mechanism, truth
        The mechanism and its truth.
    runs
        The trajectories of the runs, each with the truth at the same instants, by the labels of their methods.
    most
        The most instants of a curve.
    """
    exact = _curves(mechanism, truth)
    drawn_rows = [_row(name, kind, TRUTH, truth.t, values, most) for (name, kind), values in exact.items()]
    drawn_rows += [row for row in _targets(mechanism, float(truth.t[-1]), most) if (row["joint"], row["kind"]) in exact]
    drawn = 0
    for label, (motion, at_its_instants) in runs.items():
        own, beside = _curves(mechanism, motion), _curves(mechanism, at_its_instants)
        apart = [key for key, values in own.items() if _differs(values, beside[key])]
        if apart and drawn < MOST_RUNS:
            drawn += 1
            drawn_rows += [_row(*key, label, motion.t, own[key], most) for key in apart]
    return [*drawn_rows, *(row for row in _stops(mechanism) if (row["joint"], row["kind"]) in exact and _near(row, drawn_rows))]


def _targets(mechanism: Mechanism, end: float, most: int) -> Iterator[dict[str, Any]]:
    """Yield the rows of the targets of controllers. end: the last instant (s). most: the most instants."""
    for controller in mechanism.controllers:
        if (target := target_of(controller, end, most)) is not None:
            joint, (t, values) = mechanism.joints[controller.joint], target
            yield _row(joint.name, KINDS[joint.type], TARGET, t, values, most)


def _stops(mechanism: Mechanism) -> Iterator[dict[str, Any]]:
    """Yield the rows of the stops."""
    for joint in mechanism.joints:
        for side in ("lower", "upper") if joint.stops is not None else ():
            if (value := getattr(joint.stops, side)) is not None:
                point = {"t": [0.0], "value": [float(f"{value:.{DIGITS}g}")]}
                yield {"joint": joint.name, "kind": KINDS[joint.type], "method": STOP, "beyond": side, **point}


def _near(stop: dict[str, Any], curves: list[dict[str, Any]]) -> bool:
    """Return whether a stop is near the curves of its chart."""
    values = [value for row in curves if row["kind"] == stop["kind"] for value in row["value"] if value is not None]
    room = FAR * (max(values) - min(values)) or math.inf
    return bool(min(values) - room <= stop["value"][0] <= max(values) + room)


def described(data: list[dict[str, Any]], mechanism: Mechanism) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return a description for readers who cannot see the chart, and notes below the chart, by the kind of coordinate."""
    counts = Counter(kind for joint in mechanism.joints for _, kind, _ in _of_joint(joint, np.empty((0, MOST_OF_A_JOINT))))
    told: dict[str, tuple[str, tuple[str, ...]]] = {}
    for kind in TITLES:
        own = [row for row in data if row["kind"] == kind]
        if own:
            names = listing(list(dict.fromkeys(row["joint"] for row in own)))
            methods = list(dict.fromkeys(row["method"] for row in own if row["method"] not in (TRUTH, TARGET, STOP)))
            notes: tuple[str, ...] = ()
            if methods:
                notes += (f"Dashed: {listing(methods)}, where the difference is seen.",)
            notes += tuple(sentence for method, sentence in ALSO.items() if any(row["method"] == method for row in own))
            if counts[kind] > MOST_COORDINATES:
                notes = (f"The first {MOST_COORDINATES} of {counts[kind]} are shown.", *notes)
            told[kind] = " ".join((f"{TITLES[kind]} over time, of the truth: {names}.", *notes)), notes
    return told


def _differs(values: Array, exact: Array) -> bool:
    """Return whether a curve differs visibly from the exact curve. Values that are not finite are ignored."""
    finite = np.isfinite(values)
    size = float(np.ptp(exact)) or 1.0
    return bool((np.abs(values - exact)[finite] > SEEN * size).any())


def _row(joint: str, kind: str, method: str, t: Array, values: Array, most: int) -> dict[str, Any]:
    kept = corners(t, values[:, None], most)
    return {
        "joint": joint,
        "kind": kind,
        "method": method,
        "t": rounded(t[kept], DIGITS),
        "value": rounded(values[kept], DIGITS),
    }


def _curves(mechanism: Mechanism, trajectory: Trajectory) -> dict[tuple[str, str], Array]:
    """Return the curves (n,) of the first `MOST_COORDINATES` coordinates of each kind, by name and kind."""
    motion = kinematics.joints(mechanism, trajectory).position
    counts: dict[str, int] = dict.fromkeys(TITLES, 0)
    found: dict[tuple[str, str], Array] = {}
    for joint, (held, _) in zip(mechanism.joints, places(mechanism), strict=True):
        for name, kind, values in _of_joint(joint, motion[:, held]):
            if counts[kind] < MOST_COORDINATES:
                counts[kind] += 1
                found[name, kind] = values
    return found


def _of_joint(joint: Joint, q: Array) -> Iterator[tuple[str, Kind, Array]]:
    """Yield the name, kind and curve (n,) of each shown coordinate of a joint. q: the coordinates (n, c) of the joint."""
    match joint.type:
        case "revolute":
            yield joint.name, "angle", q[:, 0]
        case "prismatic":
            yield joint.name, "slide", q[:, 0]
        case "universal":
            yield f"{joint.name} first", "angle", q[:, 0]
            yield f"{joint.name} second", "angle", q[:, 1]
        case "planar":
            yield f"{joint.name} x", "slide", q[:, 0]
            yield f"{joint.name} y", "slide", q[:, 1]
            yield joint.name, "angle", q[:, 2]
        case "spherical" | "free":
            for place, letter in enumerate("xyz" if joint.type == "free" else ""):
                yield f"{joint.name} {letter}", "slide", q[:, place]
            turn = q[:, -4:]
            yield joint.name, "angle", 2 * np.arctan2(np.linalg.norm(turn[:, 1:], axis=1), np.abs(turn[:, 0]))
        case "fixed":
            return
