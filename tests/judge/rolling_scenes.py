"""Spheres with rolling and torsional friction, drawn from a seed, and the verdicts on their truths."""

import math
import random
from pathlib import Path
from typing import Any

from tests.judge import rolling
from tests.judge.contact_scenes import judge_text
from tests.judge.documents import written
from tests.judge.verdicts import Verdict

#: What is drawn in turn: motions along a line with separate limits, across it, and in one cone.
KINDS = ("along a line", "along a line", "across", "in one cone")


def judge(seed: int, folder: Path) -> Verdict:
    """Return the verdict on the truth of the scene of a seed."""
    kind = KINDS[seed % len(KINDS)]
    return judge_text(seed, kind, written(drawn(seed)), rolling.motion, folder)


def drawn(seed: int) -> dict[str, Any]:
    """Return the case of a seed."""
    chance = random.Random(f"rolling {seed}")
    kind = KINDS[seed % len(KINDS)]
    radius = chance.choice([0.05, 0.1, 0.5])
    incline = chance.choice([0.0, 0.0, 0.05, 0.3, chance.uniform(0.01, 0.6)])
    friction = chance.choice([0.2, 0.5, 1.0, chance.uniform(0.1, 1.5)])
    share = (
        chance.choice([0.3, 0.6, chance.uniform(0.3, 0.9)]) if kind != "along a line" else chance.choice([0.02, 0.3, 1.0, 5.0])
    )
    plane = {"friction": friction, "incline": incline, "rolling_friction": round(share * friction * radius, 6)}
    if chance.random() < 0.7:
        plane["torsional_friction"] = round(chance.uniform(0.05, 0.6) * friction * radius, 6)
    x, y = chance.choice([0.0, 1.0, -1.5]), 0.0
    turning = [
        0.0,
        chance.choice([0.0, x, chance.uniform(-3, 3)]) / radius,
        chance.choice([0.0, chance.uniform(-2, 2)]) / radius,
    ]
    if kind != "along a line":
        x, y = chance.uniform(-1, 1), chance.uniform(0.1, 1)
        turning[:2] = chance.uniform(0.1, 2) / radius, chance.uniform(-2, 2) / radius
    if kind == "in one cone":
        plane["cone"] = "one"  # type: ignore[assignment]
    scene = {"gravity": 9.81, "plane": plane}
    start: dict[str, Any] = {"angular_velocity": turning}
    start["velocity"] = [x, y, 0.0] if not incline else _along(incline, x, y)
    return {
        "format": 1,
        "name": f"judged-{seed}",
        "title": f"A scene that was drawn: {kind}",
        "body": {"shape": "sphere", "radius": radius, "mass": chance.choice([0.2, 3.0])},
        "initial": start,
        "scene": scene,
        "run": {"duration": chance.choice([0.3, 1.0, 2.0]), "samples": 9},
    }


def _along(incline: float, x: float, y: float) -> list[float]:
    """Return a velocity along an inclined plane, as well as doubles can."""

    return [x * math.cos(incline), y, -x * math.sin(incline)]
