"""Prove how far the truths of random scenes are off, and check that no printed bound is smaller than its proof.

The scenes are free bodies in all regimes of `benchmarks/truth_bounds.py`, and others of which there are proofs (`KINDS`). A
table says for each kind how many truths are not enclosed, how many are contradicted (a printed bound below its proof, or an
event that the proof does not have), the largest radius of a ball, and the processor time of the proofs. What has been done is
kept in a file, one scene a line, and is not done again. The exit status is 1 if a truth is not enclosed or contradicted.

Run: python benchmarks/proofs.py [--scenes 1000] [--seed 0] [--kind "two spheres"] [--file proofs.jsonl]
"""

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.casefile.case import parse
from bodycheck.reference.candidate import candidate_of
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.proving import enclosed
from bodycheck.reference.truth import truth
from tests.support import proved_scenes
from tests.support.proofs import certificate_of
from tests.support.random_cases import REGIMES, drawn

#: The kinds of scenes that are no free bodies: the function from a seed to a scene, and the duration (s).
KINDS: dict[str, tuple[Callable[[int], AnyScene], float]] = {
    "flight with drag": (proved_scenes.flight_with_drag, 2.0),
    "hinge or slider": (proved_scenes.hinge_or_slider, 3.0),
    "driven slider": (proved_scenes.driven_slider, 2.0),
    "ball on a plane": (proved_scenes.ball_on_plane, 1.5),
    "two spheres": (proved_scenes.two_spheres, 1.0),
    "top": (proved_scenes.top, 0.25),
    "two links": (proved_scenes.two_links, 0.1),
}

#: Instants at which a scene of these kinds is compared.
INSTANTS = 9

COLUMNS = ("kind", "scenes", "not enclosed", "contradicted", "radius", "median, s", "largest, s")

Found = dict[str, Any]


def main() -> int:
    """Prove the scenes, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = [*REGIMES, *KINDS]
    parser.add_argument("--scenes", type=int, default=1000, help="number of scenes, the same of each kind")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first scene of each kind")
    parser.add_argument("--kind", action="append", choices=kinds, help="a kind; by default all of them")
    parser.add_argument("--file", type=Path, help="file of what has been done, which is continued")
    options = parser.parse_args()
    chosen = options.kind or kinds
    tasks = [(kind, options.seed + n) for n in range(-(-options.scenes // len(chosen))) for kind in chosen]
    found = _kept(options.file)
    for kind, seed in tasks:
        if (kind, seed) not in found:
            found[kind, seed] = examined(kind, seed)
            if options.file:
                with options.file.open("a", encoding="utf-8") as file:
                    file.write(json.dumps({"kind": kind, "seed": seed, **found[kind, seed]}) + "\n")
    results = {task: found[task] for task in tasks}
    print(f"| {' | '.join(COLUMNS)} |\n| --- |{' ---: |' * (len(COLUMNS) - 1)}")
    for kind in (*chosen, "all"):
        print(row(kind, [each for (of, _), each in results.items() if kind in (of, "all")]))
    for (kind, seed), each in results.items():
        for reason in each["reasons"]:
            print(f"{kind}, seed {seed}: {reason}")
    return int(any(each["reasons"] for each in results.values()))


def _kept(file: Path | None) -> dict[tuple[str, int], Found]:
    """What a file says of scenes, by kind and seed."""
    if file is None or not file.exists():
        return {}
    lines = map(json.loads, file.read_text(encoding="utf-8").splitlines())
    return {(line["kind"], line["seed"]): line for line in lines}


def examined(kind: str, seed: int) -> Found:
    """Return what a proof finds of a scene: whether it is enclosed, the largest radius, the time (s), and the faults."""
    scene, times = _scene(kind, seed)
    found = truth(scene, times, vouched=False)
    try:
        proof = enclosed(scene, found.trajectory, found.joints, candidate_of(scene))
    except NotEnclosed as reason:
        return {"enclosed": False, "radius": None, "seconds": None, "reasons": [f"not enclosed: {reason}"]}
    if proof.until is not None:
        reason_in_part = f"enclosed until {proof.until:.3g} s of {times[-1]:.3g} s"
        return {"enclosed": False, "radius": proof.radius, "seconds": proof.seconds, "reasons": [reason_in_part]}
    faults = list(certificate_of(found, proof).faults)
    return {"enclosed": True, "radius": proof.radius, "seconds": proof.seconds, "reasons": faults}


def _scene(kind: str, seed: int) -> tuple[AnyScene, Any]:
    """The scene of a kind and a seed, and its instants (n,), s."""
    if kind in KINDS:
        draw, duration = KINDS[kind]
        return draw(seed), np.linspace(0.0, duration, INSTANTS)
    text, times = drawn(kind, seed)
    return parse(text, kind).scene, np.array(times)


def row(kind: str, found: Sequence[Found]) -> str:
    """Return the row of a kind."""
    proved = [each for each in found if each["enclosed"]]
    contradicted = sum(bool(each["reasons"]) for each in proved)
    radius = max((each["radius"] for each in proved), default=float("nan"))
    seconds = np.array([each["seconds"] for each in proved] or [np.nan])
    counts = f"{len(found)} | {len(found) - len(proved)} | {contradicted}"
    return f"| {kind} | {counts} | {radius:.0e} | {np.median(seconds):.2f} | {seconds.max():.2f} |"


if __name__ == "__main__":
    sys.exit(main())
