"""Bodies between two fingers, drawn from a seed by families, and the verdicts on their truths."""

import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from tests.judge import gripping
from tests.judge.contact_scenes import event_claims
from tests.judge.documents import written
from tests.judge.numerals import exact
from tests.judge.states import Motion
from tests.judge.verdicts import Verdict, state_claims, truth_of, verdict

Table = dict[str, Any]
Chance = random.Random

#: Rotations about the vertical, as a quaternion, and the direction to which they turn x.
YAWS = (([1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0]), ([0.8, 0.0, 0.0, 0.6], [0.28, 0.96, 0.0]))

WEIGHT, LENGTHS = 9.81, [0.03, 0.05, 0.15]


def judge(seed: int, folder: Path) -> Verdict:
    """Return the verdict on the truth of the scene of a seed."""
    chance = random.Random(f"gripping {seed}")
    kind = list(FAMILIES)[seed % len(FAMILIES)]
    document = {"format": 2, "name": f"judged-{seed}", "title": f"A scene that was drawn: {kind}"} | FAMILIES[kind](chance)
    text = written(document)
    truth = truth_of(text, folder)
    if isinstance(truth, str):
        return Verdict(seed, kind, 0.0, refused=truth)
    claims, last = [], float(truth.trajectory.t[~np.isnan(truth.bounds.error)][-1])
    for body, motion in enumerate(gripping.motions(text, exact(truth.trajectory.t.tolist()))):
        known = {index: state for index, state in motion.states.items() if truth.trajectory.t[index] <= last}
        own = replace(truth, events=tuple(event for event in truth.events if event.body == body and event.time <= last))
        events = [(kind, time) for kind, time in motion.events if time <= last]
        claims += state_claims(truth, body, known) + event_claims(own, Motion(known, events))
    return verdict(seed, f"{kind} ({len(truth.events)} events, until {last:.3g} s)", claims)


def _scene(
    chance: Chance,
    press: Any,
    law: Table,
    *,
    points: bool = False,
    aside: tuple[float, float] = (0.0, 0.0),
    lift: Any = None,
    start: Table | None = None,
    duration: float = 0.4,
) -> Table:
    """Return a scene. aside: the place of the fingers from the centre of the body, across the line of the load and along it."""
    turn, normal = chance.choice(YAWS)
    mass, finger = chance.choice([0.3, 1.0, 2.5]), chance.choice([0.1, 0.25])
    ball = not points and chance.random() < 0.4
    body: Table = {"name": "body", "mass": mass}
    body |= {"shape": "sphere", "radius": 0.04} if ball else {"shape": "brick", "semi_axes": LENGTHS}
    if points and chance.random() < 0.4:
        body["inertia"] = [mass * each for each in (0.002, 0.003, 0.0025)]
    body["initial"] = (start or {}) | {"quaternion": turn}
    shape: Table = {"shape": "sphere", "radius": 0.02} if points else {"shape": "brick", "semi_axes": [0.01, 0.1, 0.2]}
    reach = (0.04 if ball else 0.03) + (0.02 if points else 0.01)
    across = [-normal[1], normal[0]]
    bodies, joints = [body], []
    for name, side in (("left", -1), ("right", 1)):
        place = [side * reach * normal[0] + aside[0] * across[0], side * reach * normal[1] + aside[0] * across[1], aside[1]]
        bodies.append({"name": name, "mass": finger} | shape)
        joint: Table = {"name": name, "type": "prismatic", "child": name, "position": place, "quaternion": turn}
        joints.append(joint | {"axis": [float(-side), 0.0, 0.0]} | ({} if lift is None else {"parent": "carriage"}))
    controllers = [{"joint": name, "law": "effort", "effort": press} for name in ("left", "right")]
    if lift is not None:
        borne = chance.choice([0.5, 1.5])
        bodies.append({"name": "carriage", "mass": borne, "inertia": [0.01, 0.01, 0.01]})
        rail: Table = {"name": "lift", "type": "prismatic", "child": "carriage", "axis": [0.0, 0.0, 1.0]}
        if chance.random() < 0.3:
            rail["initial"] = {"velocity": 0.25}
            body["initial"] |= {"velocity": [0.0, 0.0, 0.25]}
        joints.append(rail)
        weight = (borne + 2 * finger + mass) * WEIGHT
        controllers.append({"joint": "lift", "law": "effort", "effort": lift(weight, mass + borne)})
    contacts = [{"bodies": ["body", name], "restitution": 0.0} | law for name in ("left", "right")]
    return {
        "bodies": bodies,
        "joints": joints,
        "controllers": controllers,
        "scene": {"gravity": WEIGHT, "contacts": contacts},
        "run": {"duration": duration, "samples": 9},
    }


def _friction(chance: Chance) -> float:
    return chance.choice([0.0, 0.3, 0.5, 1.0, chance.uniform(0.05, 1.5)])


def _held_or_falling(chance: Chance) -> Table:
    """A body that is held, falls, or is at the limit, and one that is thrown along its fingers."""
    friction = _friction(chance)
    press = chance.choice([5.0, 20.0, WEIGHT, chance.uniform(1.0, 40.0)])
    start = {"velocity": [0.0, 0.0, chance.choice([0.2, -0.2, 0.4])]} if chance.random() < 0.4 else None
    return _scene(chance, press, {"friction": friction}, start=start, duration=chance.choice([0.05, 0.1]))


def _loosened(chance: Chance) -> Table:
    """Fingers whose force falls or rises."""
    times = sorted(round(chance.uniform(0.0, 0.25), 3) for _ in range(chance.randint(2, 5)))
    times = sorted(set(times)) if len(set(times)) > 1 else [0.0, 0.2]
    values = [round(chance.uniform(2.0, 40.0), 2) for _ in times]
    press: Table = {"times": times, "values": values, "between": chance.choice(["linear", "linear", "hold"])}
    if chance.random() < 0.3:
        press = {
            "amplitude": 8.0,
            "angular_frequency": chance.uniform(5.0, 40.0),
            "offset": 20.0,
            "phase": chance.uniform(-3, 3),
        }
    return _scene(chance, press, {"friction": chance.choice([0.3, 0.5, 1.0])}, duration=0.25)


def _shaken(chance: Chance) -> Table:
    """A carriage that a sine shakes up and down."""

    def lift(weight: float, mass: float) -> Table:
        strength = chance.uniform(0.2, 3.0) * mass * WEIGHT
        return {"amplitude": strength, "angular_frequency": chance.uniform(10.0, 60.0), "offset": weight}

    press = chance.uniform(1.0, 3.0) * WEIGHT
    return _scene(chance, press, {"friction": chance.choice([0.3, 0.5, 1.0])}, lift=lift, duration=0.3)


def _eccentric(chance: Chance) -> Table:
    """Fingers beside the centre of mass, on which the body is held, turns, or is at the limit."""
    law: Table = {"friction": chance.choice([1.0, 2.0]), "torsional_friction": chance.choice([0.0, 0.002, 0.005, 0.02])}
    if law["torsional_friction"] and chance.random() < 0.3:
        law["cone"] = "one"
    press = chance.choice([20.0, 40.0, chance.uniform(10.0, 80.0)])
    aside = chance.choice([-1, 1]) * chance.choice([0.01, 0.02, chance.uniform(0.001, 0.03)]), chance.choice([0.0, 0.02, -0.03])
    return _scene(chance, press, law, points=True, aside=aside, duration=chance.choice([0.4, 1.0]))


#: What draws a scene of each family.
FAMILIES: dict[str, Callable[[Chance], Table]] = {
    "held or falling": _held_or_falling,
    "loosened": _loosened,
    "shaken": _shaken,
    "eccentric": _eccentric,
}
