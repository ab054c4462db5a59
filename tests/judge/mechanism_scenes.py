"""Mechanisms of up to three bodies with dry friction on their joints, drawn from a seed, and the verdicts on their truths.

Shapes of mechanisms are few, so that the integrators of the truth are compiled once for each. Their numbers are drawn: joints
that rest with a load next to their friction, joints that stop and turn back, and twins that stop at one instant.
"""

import random
from decimal import Decimal
from pathlib import Path
from typing import Any

from tests.judge import jointed
from tests.judge.documents import written
from tests.judge.numerals import ZERO, exact, fifty_digits
from tests.judge.series import Series
from tests.judge.verdicts import Verdict, joint_claims, state_claims, truth_of, verdict

Table = dict[str, Any]

#: Joints as type, parent and axis; and whether gravity acts.
SHAPES: dict[str, tuple[list[tuple[str, int | None, tuple[float, float, float]]], bool]] = {
    "slider-wheel": ([("prismatic", None, (1, 0, 0)), ("revolute", 0, (0, 0, 1))], False),
    "sliders": ([("prismatic", None, (1, 0, 0)), ("prismatic", 0, (1, 0, 0))], False),
    "three-sliders": ([("prismatic", None, (1, 0, 0)), ("prismatic", 0, (1, 0, 0)), ("prismatic", 1, (1, 0, 0))], False),
    "crossed-sliders": ([("prismatic", None, (1, 0, 0)), ("prismatic", 0, (0.6, 0, 0.8))], True),
    "cart-pole": ([("prismatic", None, (1, 0, 0)), ("revolute", 0, (0, 1, 0))], True),
    "pendulum": ([("revolute", None, (0, 1, 0))], True),
    "planar-pendulum": ([("revolute", None, (0, 1, 0)), ("revolute", 0, (0, 1, 0))], True),
    "spatial-pendulum": ([("revolute", None, (1, 0, 0)), ("revolute", 0, (0, 1, 0))], True),
    "triple-pendulum": ([("revolute", None, (0, 1, 0)), ("revolute", 0, (0, 1, 0)), ("revolute", 1, (0, 1, 0))], True),
    "twins": ([("prismatic", None, (1, 0, 0)), ("revolute", 0, (0, 0, 1)), ("revolute", 0, (0, 0, 1))], False),
    "arm": ([("revolute", None, (0, 0, 1)), ("revolute", 0, (0, 1, 0)), ("revolute", 1, (1, 0, 0))], True),
    "cart-arm": ([("prismatic", None, (1, 0, 0)), ("revolute", 0, (0, 1, 0)), ("prismatic", 1, (0, 0, 1))], True),
    "skew": ([("revolute", None, (0.3, -0.4, 0.866)), ("prismatic", 0, (0.48, 0.6, 0.64))], True),
}


def drawn(seed: int) -> tuple[str, str]:
    """Return the kind and the text of the case of a seed."""
    chance = random.Random(f"mechanism {seed}")
    kind = chance.choice(list(SHAPES))
    shape, heavy = SHAPES[kind]
    round_numbers = chance.random() < 0.3
    document: Table = {
        "format": 2,
        "name": f"judged-{seed}",
        "title": f"A mechanism that was drawn: {kind}",
        "bodies": [_body(chance, place, round_numbers) for place in range(len(shape))],
        "joints": [_joint(chance, place, *each, round_numbers) for place, each in enumerate(shape)],
        "scene": {"gravity": chance.choice([9.81, 9.81, 1.62])} if heavy else {},
    }
    if kind == "twins":
        for tables in (document["bodies"], document["joints"]):
            tables[2] = tables[1] | {key: tables[2][key] for key in ("name", "child") if key in tables[2]}
        if chance.random() < 0.5:
            document["joints"][2]["initial"] = {key: -value for key, value in document["joints"][1].get("initial", {}).items()}
            document["joints"][2]["position"] = [-value for value in document["joints"][1]["position"]]
    if kind == "slider-wheel" and chance.random() < 0.5:
        document["bodies"][1].pop("center_of_mass", None)
    steady = "sliders" in kind or (kind == "slider-wheel" and "center_of_mass" not in document["bodies"][1])
    durations = [1.0, 10.0, 100.0] if steady and not heavy else [0.5, 1.0, 1.5]
    document["run"] = {"duration": chance.choice(durations), "samples": chance.choice([4, 6, 9])}
    if chance.random() < 0.6:
        _balanced(chance, document)
    return kind, written(document)


def judge(seed: int, folder: Path) -> Verdict:
    """Return the verdict on the truth of the mechanism of a seed."""
    kind, text = drawn(seed)
    return judge_text(seed, kind, text, folder)


def judge_text(seed: int, kind: str, text: str, folder: Path) -> Verdict:
    """Return the verdict on the truth of a mechanism."""
    truth = truth_of(text, folder)
    if isinstance(truth, str):
        return Verdict(seed, kind, 0.0, refused=truth)
    try:
        motion, changes = jointed.motion(text, exact(truth.trajectory.t.tolist()))
    except jointed.Undecided as error:
        return Verdict(seed, kind, 0.0, refused=f"by the judge: {error}")
    claims = joint_claims(truth, motion, lengths=10.0)
    for body, name in enumerate(each.name for each in truth.scene.bodies):
        states = {index: instant.bodies[name] for index, instant in enumerate(motion)}
        claims += state_claims(truth, body, states, f" of {name}")
    return verdict(seed, f"{kind} ({changes} changes)", claims)


def _number(chance: random.Random, low: float, high: float, round_numbers: bool) -> float:
    if round_numbers:
        return chance.choice([low, high, (low + high) / 2])
    return round(chance.uniform(low, high), chance.choice([1, 2, 3, 17])) or low


def _body(chance: random.Random, place: int, round_numbers: bool) -> Table:
    mass = _number(chance, 0.5, 2.0, round_numbers)
    table: Table = {"name": f"body-{place}", "mass": mass}
    if chance.random() < 0.8:
        table["center_of_mass"] = [_number(chance, -0.5, 0.5, round_numbers) * chance.choice([0, 1]) for _ in range(3)]
    if chance.random() < 0.5:
        table |= {"shape": "brick", "semi_axes": [_number(chance, 0.1, 0.3, round_numbers) for _ in range(3)]}
    else:
        a, b, c = (_number(chance, 0.02, 0.2, round_numbers) for _ in range(3))
        table["inertia"] = [b + c, a + c, a + b]
    return table


def _joint(
    chance: random.Random, place: int, kind: str, parent: int | None, axis: tuple[float, ...], round_numbers: bool
) -> Table:
    table: Table = {"name": f"joint-{place}", "type": kind, "child": f"body-{place}", "axis": [float(part) for part in axis]}
    if parent is not None:
        table["parent"] = f"body-{parent}"
        table["position"] = [_number(chance, -0.6, 0.6, round_numbers) * chance.choice([0, 1]) for _ in range(3)]
    if chance.random() < 0.85:
        table["friction"] = _number(chance, 0.1, 3.0, round_numbers)
    for key, high in (("effort", 3.0), ("damping", 0.5), ("stiffness", 5.0), ("armature", 0.2)):
        if chance.random() < (0.6 if key == "effort" else 0.2):
            table[key] = _number(chance, 0.05, high, round_numbers) * (chance.choice([-1, 1]) if key == "effort" else 1)
    start = {}
    if chance.random() < 0.6:
        start["position"] = _number(chance, -1.5, 1.5, round_numbers)
    if chance.random() < 0.5:
        start["velocity"] = _number(chance, -2.0, 2.0, round_numbers)
    if start:
        table["initial"] = start
    return table


def _balanced(chance: random.Random, document: Table) -> None:
    """Give the joints at rest frictions next to the forces that hold them."""
    resting = [joint for joint in document["joints"] if "friction" in joint and not joint.get("initial", {}).get("velocity")]
    if not resting:
        return
    with fifty_digits():
        loads = loads_at_start(written(document))
    for joint in resting if chance.random() < 0.5 else [chance.choice(resting)]:
        load = loads.get(joint["name"], ZERO)
        if abs(load) > Decimal("1e-6"):
            apart = chance.choice([-1, 1]) * 10.0 ** -chance.uniform(7, 16)
            joint["friction"] = float(abs(load)) * (1 + chance.choice([0, 1, 1, 1]) * apart)


def loads_at_start(text: str) -> dict[str, Decimal]:
    """Return the forces that hold the joints with dry friction that rest at the start."""
    mechanism = jointed.Mechanism(text)
    links = mechanism.links
    stuck = frozenset(k for k in mechanism.dry if not links[k].start[1])
    equations = mechanism.equations(stuck)
    moving, start = equations.moving, [link.start for link in links]
    frictions = [-links[k].terms["friction"].copy_sign(start[k][1]) for k in moving]
    numbers = [start[k][0] for k in moving] + [start[k][1] for k in moving] + [start[k][0] for k in equations.stuck]
    equations.tape.expand([*numbers, *frictions], 1)
    return {links[k].joint: load.coefficients[0] if isinstance(load, Series) else load for k, load in equations.holding.items()}
