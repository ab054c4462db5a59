"""Driven mechanisms of up to three bodies, drawn from a seed, and the verdicts on their truths.

Each has controllers on some joints, and stops or dry friction on some. The shapes are those of `mechanism_scenes`.
"""

import random
from pathlib import Path
from typing import Any

from tests.judge import driven, jointed
from tests.judge.documents import written
from tests.judge.mechanism_scenes import SHAPES, Table
from tests.judge.numerals import exact
from tests.judge.verdicts import Verdict, joint_claims, state_claims, truth_of, verdict

#: The shapes, from one joint on.
KINDS = (
    "hinge",
    "slider",
    "pendulum",
    "sliders",
    "crossed-sliders",
    "cart-pole",
    "planar-pendulum",
    "spatial-pendulum",
    "arm",
    "skew",
)

ALONE = {"hinge": ([("revolute", None, (0, 1, 0))], False), "slider": ([("prismatic", None, (0, 0, 1))], True)}


def drawn(seed: int) -> tuple[str, str]:
    """Return the kind and the text of the case of a seed."""
    chance = random.Random(f"driven {seed}")
    kind = chance.choice(KINDS)
    shape, heavy = (ALONE | SHAPES)[kind]
    joints = [_joint(chance, place, *each) for place, each in enumerate(shape)]
    names = [joint["name"] for joint in joints]
    chosen = chance.sample(names, chance.randint(1, len(names)))
    document: Table = {
        "format": 2,
        "name": f"judged-{seed}",
        "title": f"A driven mechanism that was drawn: {kind}",
        "bodies": [_body(chance, place) for place in range(len(shape))],
        "joints": joints,
        "controllers": [_controller(chance, name) for name in names if name in chosen],
        "scene": {"gravity": 9.81} if heavy else {},
        "run": {"duration": chance.choice([0.1, 0.2, 0.4]), "samples": 3},
    }
    if chance.random() < 0.6:
        joint = chance.choice(joints)
        joint |= {"limits": _limits(chance, joint.get("initial", {}).get("position", 0.0))}
    elif chance.random() < 0.5:
        chance.choice(joints)["friction"] = chance.uniform(0.1, 2.0)
    return kind, written(document)


def judge(seed: int, folder: Path) -> Verdict:
    """Return the verdict on the truth of the driven mechanism of a seed."""
    kind, text = drawn(seed)
    truth = truth_of(text, folder)
    if isinstance(truth, str):
        return Verdict(seed, kind, 0.0, refused=truth)
    try:
        motion, events = driven.motion(text, exact(truth.trajectory.t.tolist()))
    except jointed.Undecided as error:
        return Verdict(seed, kind, 0.0, refused=f"by the judge: {error}")
    claims = joint_claims(truth, motion, lengths=10.0)
    for body, name in enumerate(each.name for each in truth.scene.bodies):
        claims += state_claims(
            truth, body, {index: instant.bodies[name] for index, instant in enumerate(motion)}, f" of {name}"
        )
    return verdict(seed, f"{kind} ({events} events)", claims)


def _body(chance: random.Random, place: int) -> Table:
    a, b, c = (chance.uniform(0.02, 0.2) for _ in range(3))
    table: Table = {"name": f"body-{place}", "mass": chance.uniform(0.5, 2.0), "inertia": [b + c, a + c, a + b]}
    if chance.random() < 0.7:
        table["center_of_mass"] = [chance.uniform(-0.4, 0.4) for _ in range(3)]
    return table


def _joint(chance: random.Random, place: int, kind: str, parent: int | None, axis: tuple[float, ...]) -> Table:
    table: Table = {"name": f"joint-{place}", "type": kind, "child": f"body-{place}", "axis": [float(part) for part in axis]}
    if parent is not None:
        table |= {"parent": f"body-{parent}", "position": [chance.uniform(-0.6, 0.6) for _ in range(3)]}
    for key, high in (("damping", 0.5), ("stiffness", 5.0), ("armature", 0.2), ("effort", 1.0)):
        if chance.random() < 0.2:
            table[key] = chance.uniform(0.05, high)
    if chance.random() < 0.6:
        table["initial"] = {"position": chance.uniform(-0.5, 0.5), "velocity": chance.uniform(-2.0, 2.0)}
    return table


def _controller(chance: random.Random, joint: str) -> Table:
    table: Table = {"joint": joint, "law": "pd", "kp": chance.uniform(1.0, 40.0), "kd": chance.uniform(0.0, 2.0)}
    if chance.random() < 0.2:
        table = {"joint": joint, "law": "effort"}
    else:
        table["target"] = _signal(chance, 1.0)
        if chance.random() < 0.3:
            table["target_velocity"] = _signal(chance, 1.0)
        if chance.random() < 0.3:
            table["ki"] = chance.uniform(1.0, 20.0)
    if table["law"] == "effort" or chance.random() < 0.3:
        table["effort"] = _signal(chance, 3.0)
    if chance.random() < 0.6:
        table["rate"] = chance.choice([50.0, 100.0, 30.0, 123.456])
        table["delay"] = chance.choice([0, 0, 1, 2])
    if chance.random() < 0.4:
        table["effort_limit"] = chance.uniform(1.0, 8.0)
        if chance.random() < 0.5:
            table["no_load_speed"] = chance.uniform(1.0, 6.0)
    return table


def _signal(chance: random.Random, size: float) -> Any:
    kind = chance.choice(["number", "number", "sine", "hold", "linear"])
    match kind:
        case "number":
            return chance.uniform(-size, size)
        case "sine":
            sine = {"amplitude": chance.uniform(0.1, size), "angular_frequency": chance.uniform(1.0, 30.0)}
            return sine | {"phase": chance.uniform(-3.0, 3.0), "offset": chance.uniform(-size, size)}
        case _:
            times = sorted(chance.uniform(0.0, 0.3) for _ in range(chance.randint(1, 4)))
            return {"times": times, "values": [chance.uniform(-size, size) for _ in times], "between": kind}


def _limits(chance: random.Random, start: float) -> Table:
    lower, upper = start - chance.uniform(0.02, 0.3), start + chance.uniform(0.02, 0.3)
    stops: Table = chance.choice([{"lower": lower}, {"upper": upper}, {"lower": lower, "upper": upper}])
    if chance.random() < 0.5:
        return stops | {"stiffness": chance.uniform(50.0, 2000.0), "damping": chance.choice([0.0, chance.uniform(0.5, 10.0)])}
    return stops | {"restitution": chance.choice([0.0, 0.0, 1.0, chance.uniform(0.2, 0.9)])}
