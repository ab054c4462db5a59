"""Many free flights at once, of every kind of motion."""

import math
from dataclasses import replace

import numpy as np

from bodycheck.reference.exact.start import defined_scene
from bodycheck.reference.scene import Body, Brick, Definition, Scene, Solid, State
from bodycheck.reference.scenes import Scenes, vary
from bodycheck.reference.trajectory import Array

EPS = float(np.finfo(float).eps)
PLAIN = Scene(Body(1.0, (1.0, 1.5, 2.0)), State(position=(1.0, 2.0, 3.0), velocity=(1.0, -1.0, 5.0)), gravity=9.81)

#: Moments and rates of every kind of motion, and of those that are almost of another kind.
KINDS: dict[str, tuple[tuple[float, float, float], tuple[float, float, float]]] = {
    "tumble": ((1.0, 1.5, 2.1), (1.0, 2.0, 3.0)),
    "tumble, other labels": ((2.1, 1.0, 1.5), (1.0, -2.0, 0.3)),
    "about the least": ((1.0, 1.5, 1.7), (3.0, 0.1, -0.2)),
    "flip": ((0.13, 0.05, 0.1), (0.1, 0.0, 10.0)),
    "nearly symmetric": ((1.0, math.nextafter(1.0, 2.0), 1.7), (1.0, 2.0, 3.0)),
    "nearly a sphere": ((1.0, 1.0 + 4 * EPS, 1.0 + EPS), (1.0, 2.0, 3.0)),
    "needle": ((1e-12, 1.0, 1.0 + 1e-9), (1.0, 2.0, 3.0)),
    "disc": ((0.5, 0.75, 1.25), (1.0, 2.0, 3.0)),
    "separatrix": ((1.0, 2.0, 2.25), (0.75, 1.0, 1.0)),
    "just outside the separatrix": ((1.0, 2.0, 2.25), (math.nextafter(0.75, 1), 1.0, 1.0)),
    "just inside the separatrix": ((1.0, 2.0, 2.25), (math.nextafter(0.75, 0), 1.0, 1.0)),
    "almost the middle axis": ((1.0, 2.0, 2.25), (1e-12, 3.0, -3e-13)),
    "middle axis": ((1.0, 2.0, 2.5), (0.0, -3.0, -0.0)),
    "about the greatest": ((1.0, 2.0, 2.5), (0.0, 0.0, 2.0)),
    "one rate zero": ((1.0, 1.5, 1.7), (-2.0, -1.0, -0.0)),
    "top about K": ((1.0, 1.0, 1.7), (1.0, 2.0, 3.0)),
    "top about I": ((1.0, 2.0, 2.0), (1.0, 2.0, 3.0)),
    "top about J": ((1.3, 1.0, 1.3), (1.0, -2.0, 3.0)),
    "top that spins across its axis": ((1.3, 1.0, 1.3), (1.0, 0.0, 3.0)),
    "sphere": ((0.4, 0.4, 0.4), (1.0, 2.0, 3.0)),
    "rest": ((1.0, 2.0, 2.5), (0.0, 0.0, 0.0)),
    "a tiny rate": ((1.5, 1.0, 0.5), (0.0, 5e-324, 1.0)),
    "tiny": ((1e-30, 2e-30, 2.5e-30), (1e-20, 2e-20, 3e-20)),
}


def of_kinds(seed: int = 1) -> Scenes:
    rng = np.random.default_rng(seed)
    moments, rates = (np.array(part) for part in zip(*KINDS.values(), strict=True))
    return vary(PLAIN, {"moments": moments, "angular_velocity": rates, "quaternion": rng.normal(size=(len(rates), 4))})


def random_bricks(count: int, seed: int = 2) -> tuple[Scene, dict[str, Array]]:
    rng = np.random.default_rng(seed)
    shape = Brick((0.1, 0.2, 0.3))
    base = defined_scene(Definition(Solid(shape, 1.0)), shape)
    return replace(base, gravity=9.81), {
        "mass": rng.uniform(0.5, 2.0, count),
        "semi_axes": rng.uniform(0.05, 0.5, (count, 3)),
        "quaternion": rng.normal(size=(count, 4)),
        "position": rng.normal(size=(count, 3)),
        "velocity": rng.normal(size=(count, 3)),
        "angular_velocity": rng.normal(size=(count, 3)) * 10 ** rng.uniform(-2, 2, (count, 1)),
    }
