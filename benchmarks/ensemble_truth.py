"""Measure the cost of the truths of an ensemble: all members of a block at once, and the same members one by one.

The CPU time of both is taken alternately in one process, after a first turn that warms up. Each member has 101 samples in 2 s.
Run: python benchmarks/ensemble_truth.py
"""

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from bodycheck.reference.exact.start import defined_scene
from bodycheck.reference.flight import closed_form
from bodycheck.reference.flight.flights import flights
from bodycheck.reference.scene import Brick, Cylinder, Definition, Scene, Shape, Solid, Sphere
from bodycheck.reference.scenes import Scenes, vary
from bodycheck.reference.trajectory import Array

TURNS = 5

#: Members of a block, and those of them that are also computed one by one.
MEMBERS, ALONE = 1000, 100

TIMES = np.linspace(0.0, 2.0, 101)


def ensembles() -> dict[str, Scenes]:
    """Blocks of members with the initial attitude and rotation drawn, and with the body drawn too."""
    rng = np.random.default_rng(1)
    motion = {"quaternion": rng.normal(size=(MEMBERS, 4)), "angular_velocity": rng.normal(0, 3, (MEMBERS, 3))}
    near = np.array([0.0, 0.0, 10.0]) + rng.normal(0, 1e-3, (MEMBERS, 3))
    body: Mapping[str, Array] = {"mass": rng.uniform(0.5, 2, MEMBERS), "semi_axes": rng.uniform(0.05, 0.3, (MEMBERS, 3))}
    brick = Brick((0.1, 0.2, 0.15))
    return {
        "brick, rotation drawn": vary(base(brick), motion),
        "brick, rotation and body drawn": vary(base(brick), {**motion, **body}),
        "brick, near the unstable axis": vary(base(brick), {"angular_velocity": near}),
        "cylinder": vary(base(Cylinder(0.1, 0.2)), motion),
        "sphere": vary(base(Sphere(0.1)), motion),
    }


def base(shape: Shape) -> Scene:
    return replace(defined_scene(Definition(Solid(shape, 1.0)), shape), gravity=9.81)


def main() -> None:
    print(f"{MEMBERS} members, {len(TIMES)} samples in {TIMES[-1]:g} s; CPU time a member in microseconds, median of {TURNS}")
    print(f"{'':32} at once  one by one  ratio")
    for name, scenes in ensembles().items():
        single = [scenes.scene(k) for k in range(ALONE)]

        def one_by_one(single: list[Scene] = single) -> None:
            for scene in single:
                closed_form.flight(replace(scene), TIMES)

        ways: dict[str, tuple[Callable[[], object], int]] = {
            "at once": (lambda scenes=scenes: flights(scenes, TIMES), MEMBERS),  # type: ignore[misc]
            "one by one": (one_by_one, ALONE),
        }
        costs: dict[str, list[float]] = {way: [] for way in ways}
        for turn in range(TURNS + 1):
            for way, (call, members) in ways.items():
                start = time.process_time()
                call()
                if turn:  # the first turn warms up
                    costs[way].append((time.process_time() - start) / members * 1e6)
        at_once, alone = (statistics.median(costs[way]) for way in ways)
        ratio = statistics.median(a / b for a, b in zip(costs["at once"], costs["one by one"], strict=True))
        print(f"{name:32}{at_once:8.1f}{alone:12.1f}{ratio:7.3f}")


if __name__ == "__main__":
    main()
