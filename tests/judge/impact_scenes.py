"""Two spheres that hit each other, drawn from a seed by families, and the verdicts on their truths."""

import math
import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.judge import impacts
from tests.judge.contact_scenes import event_claims
from tests.judge.documents import written
from tests.judge.numerals import exact
from tests.judge.verdicts import Verdict, state_claims, truth_of, verdict

Table = dict[str, Any]
Chance = random.Random

#: The factor between the moments of a hollow and of a homogeneous sphere is 5/3: 2/3 m r^2 and 2/5 m r^2.
HOLLOW = 2 / 3


def judge(seed: int, folder: Path) -> Verdict:
    """Return the verdict on the truth of the scene of a seed."""
    chance = random.Random(f"impacts {seed}")
    kind = list(FAMILIES)[seed % len(FAMILIES)]
    document = {"format": 2, "name": f"judged-{seed}", "title": f"A scene that was drawn: {kind}"} | FAMILIES[kind](chance)
    text = written(document)
    truth = truth_of(text, folder)
    if isinstance(truth, str):
        return Verdict(seed, kind, 0.0, refused=truth)
    claims = []
    met = 0
    for body, motion in enumerate(impacts.motions(text, exact(truth.trajectory.t.tolist()))):
        own = replace(truth, events=tuple(event for event in truth.events if event.body == body))
        met += sum(event.other >= 0 for event in own.events)
        claims += state_claims(truth, body, motion.states) + event_claims(own, motion)
    return verdict(seed, f"{kind} ({met // 2} impacts of both, {len(truth.events)} events)", claims)


def _scene(chance: Chance, bodies: list[Table], scene: Table, *, friction: float | None = None) -> Table:
    pair = {
        "bodies": ["one", "other"],
        "friction": chance.choice([0.0, 0.1, 0.5, chance.uniform(0, 1)]) if friction is None else friction,
        "restitution": chance.choice([0.0, 0.5, 0.9, 1.0, chance.random()]),
    }
    return {"bodies": bodies, "scene": scene | {"contacts": [pair]}, "run": {"duration": 1.5, "samples": 7}}


def _ball(chance: Chance, name: str, radius: float, start: Table) -> Table:
    mass = chance.choice([0.17, 1.0, 2.5])
    table = {"name": name, "shape": "sphere", "radius": radius, "mass": mass}
    if chance.random() < 0.3:
        table["inertia"] = [HOLLOW * mass * radius * radius] * 3
    if chance.random() < 0.5:
        start = start | {"euler_zxz": [round(chance.uniform(0, 3), 3) for _ in range(3)]}
    return table | {"initial": start}


def _spin(chance: Chance, size: float) -> list[float]:
    return [round(chance.uniform(-size, size), 3) * chance.choice([0, 1, 1]) for _ in range(3)]


def _in_space(chance: Chance) -> Table:
    """Two spheres that hit, miss or nearly graze each other."""
    radii = [chance.choice([0.05, 0.1, 0.2]) for _ in range(2)]
    aside = chance.choice([0.0, chance.uniform(-1.1, 1.1), chance.choice([-1, 1]) * (1 - 10 ** -chance.uniform(2, 14))])
    angle = chance.choice([0.0, math.pi / 2, chance.uniform(0, 6.28)])
    reach = sum(radii) * aside
    first: Table = {"position": [-0.6, 0.0, 0.0], "velocity": [chance.uniform(1, 3), 0.0, 0.0]}
    second: Table = {"position": [0.5, reach * math.cos(angle), reach * math.sin(angle)]}
    if chance.random() < 0.4:
        second["velocity"] = [chance.uniform(-2, 0.5), chance.uniform(-0.1, 0.1), 0.0]
    for start in (first, second):
        start["angular_velocity"] = _spin(chance, chance.choice([0.0, 5.0, 60.0]))
    balls = [_ball(chance, name, r, start) for name, r, start in zip(("one", "other"), radii, (first, second), strict=True)]
    return _scene(chance, balls, {"gravity": chance.choice([0.0, 9.81])})


def _on_plane(chance: Chance) -> Table:
    """Two spheres of one size on a plane. Without friction between them they may spin about any axis."""
    radius, rough = chance.choice([0.028575, 0.1]), chance.random() < 0.5
    starts: list[Table] = []
    for x, speed in ((-0.5, chance.uniform(1, 3)), (0.3, chance.choice([0.0, chance.uniform(-2, 0)]))):
        spin = [0.0, 0.0, chance.uniform(-20, 20)] if rough else _spin(chance, 30.0)
        aside = chance.uniform(-1, 1) * radius
        starts.append({"position": [x, aside, radius], "velocity": [speed, 0.0, 0.0], "angular_velocity": spin})
    plane = {"friction": 0.0 if rough else chance.choice([0.0, 0.1, 0.3])}
    balls = [_plain(chance, name, radius, start) for name, start in zip(("one", "other"), starts, strict=True)]
    return _scene(chance, balls, {"gravity": 9.81, "plane": plane}, friction=None if rough else 0.0)


def _plain(chance: Chance, name: str, radius: float, start: Table) -> Table:
    mass = chance.choice([0.17, 1.0])
    return {"name": name, "shape": "sphere", "radius": radius, "mass": mass, "initial": start}


def _thrown(chance: Chance) -> Table:
    """Two spheres that are thrown over a plane, and bounce."""
    starts: list[Table] = []
    rise = chance.uniform(-1, 2)
    for x, speed in ((-0.4, chance.uniform(0.5, 3)), (0.4, chance.uniform(-3, -0.5))):
        place = [x, chance.uniform(-0.05, 0.05), chance.uniform(0.5, 0.6)]
        velocity = [speed, 0.0, rise]
        starts.append({"position": place, "velocity": velocity, "angular_velocity": _spin(chance, 20.0)})
    plane = {"friction": chance.choice([0.0, 0.1, 0.5]), "restitution": chance.choice([0.0, 0.3, 0.8, 1.0])}
    balls = [_ball(chance, name, 0.1, start) for name, start in zip(("one", "other"), starts, strict=True)]
    return _scene(chance, balls, {"gravity": 9.81, "plane": plane})


#: What draws a scene of each family.
FAMILIES: dict[str, Callable[[Chance], Table]] = {
    "in space": _in_space,
    "on a plane": _on_plane,
    "thrown over a plane": _thrown,
}
