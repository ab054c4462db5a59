"""Bodies that touch a plane, drawn from a seed by families, and the verdicts on their truths."""

import math
import random
from collections.abc import Callable, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

from tests.judge import balls, blocks, coins, drops, rods
from tests.judge.documents import written
from tests.judge.numerals import exact
from tests.judge.states import Motion
from tests.judge.verdicts import Claim, Verdict, state_claims, truth_of, verdict

Table = dict[str, Any]
Chance = random.Random

#: An attitude that turns the axis of a cylinder exactly across the fall line of a plane that is level.
ACROSS = [0.5, 0.5, 0.5, 0.5]


def judge(seed: int, folder: Path) -> Verdict:
    """Return the verdict on the truth of the scene of a seed."""
    kind, text, motion = drawn(seed)
    return judge_text(seed, kind, text, motion, folder)


def drawn(seed: int) -> tuple[str, str, Callable[[str, Sequence[Decimal]], Motion]]:
    """Return the kind and the text of the case of a seed, and what computes its motion."""
    chance = random.Random(f"contact {seed}")
    kind = list(FAMILIES)[seed % len(FAMILIES)]
    draw, motion = FAMILIES[kind]
    document = {"format": 1, "name": f"judged-{seed}", "title": f"A scene that was drawn: {kind}"} | draw(chance)
    return kind, written(document), motion


def judge_text(seed: int, kind: str, text: str, motion: Callable[[str, Sequence[Decimal]], Motion], folder: Path) -> Verdict:
    """Return the verdict on the truth of a scene."""
    truth = truth_of(text, folder)
    if isinstance(truth, str):
        return Verdict(seed, kind, 0.0, refused=truth)
    judged = motion(text, exact(truth.trajectory.t.tolist()))
    bounds = truth.bounds.error
    known = {index: state for index, state in judged.states.items() if not math.isnan(bounds[index])}
    body = None if truth.trajectory.position.ndim == 2 else 0
    claims = state_claims(truth, body, known) + event_claims(truth, judged)
    for index, bound in enumerate(bounds):
        if math.isnan(bound) == (index in judged.states):
            what = "no state" if math.isnan(bound) else "a state after the motion has ended"
            claims.append(Claim(f"{what} at t = {truth.trajectory.t[index]:.17g}", math.inf, 0.0))
    return verdict(seed, f"{kind} ({len(judged.events)} events, {len(known)} of {len(bounds)} instants)", claims)


def event_claims(truth: Any, judged: Motion) -> list[Claim]:
    """Return the claims of a truth on the instants of its events, each compared with the judge's of its kind and order.

    Of bounces without end, the judge has as many as it computes, which may be more than the truth has.
    """
    claims = []
    for kind in sorted({event.kind for event in truth.events} | {name for name, _ in judged.events}):
        told = [event for event in truth.events if event.kind == kind]
        own = [time for name, time in judged.events if name == kind]
        if len(told) > len(own) or (len(told) < len(own) and kind != "impact"):
            claims.append(Claim(f"{len(told)} events {kind}, not {len(own)}", math.inf, 0.0))
        for number, (event, time) in enumerate(zip(told, own, strict=False)):
            error = float(abs(exact(event.time) - time))
            claims.append(Claim(f"time of {kind} {number}", error, event.error + 1.2e-16 * abs(event.time)))
    return claims


def _run(duration: float, samples: int = 7) -> Table:
    return {"duration": duration, "samples": samples}


def _friction(chance: Chance) -> float:
    return chance.choice([0.0, 0.1, 0.3, 1.0, chance.uniform(0.01, 1.0), chance.uniform(0.01, 1.0)])


def _spin(chance: Chance, size: float) -> list[float]:
    return [round(chance.uniform(-size, size), 3) * chance.choice([0, 1, 1]) for _ in range(3)]


def _ball(chance: Chance) -> Table:
    return {"shape": "sphere", "radius": chance.choice([0.1, 0.028575, 0.5]), "mass": chance.choice([0.17, 1.0, 2.0])}


def _ball_on_level(chance: Chance) -> Table:
    start = {"velocity": [chance.uniform(-2, 2), chance.choice([0.0, chance.uniform(-2, 2)]), 0.0]}
    start["angular_velocity"] = _spin(chance, 40.0)
    scene = {"gravity": 9.81, "plane": {"friction": _friction(chance)}}
    return {"body": _ball(chance), "initial": start, "scene": scene, "run": _run(chance.choice([0.5, 1.0, 2.0]))}


def _ball_on_incline(chance: Chance) -> Table:
    incline = chance.uniform(0.05, 1.2)
    friction = _friction(chance)
    if chance.random() < 0.4:  # next to the steepest incline on which it rolls
        friction = math.tan(incline) / 3.5 * (1 + chance.choice([-1, 0, 1]) * 10 ** -chance.uniform(8, 16))
    start: Table = {"velocity": [0.0, 0.0, 0.0]}
    if chance.random() < 0.6:
        along = chance.uniform(-2, 2)
        start["velocity"] = [along, 0.0, -along * math.tan(incline)]
    if chance.random() < 0.6:
        start["velocity"][1] = chance.uniform(-2, 2)
    if chance.random() < 0.4:
        start["angular_velocity"] = _spin(chance, 20.0)
    scene = {"gravity": 9.81, "plane": {"incline": incline, "friction": friction}}
    return {"body": _ball(chance), "initial": start, "scene": scene, "run": _run(chance.choice([0.3, 1.0]))}


def _ball_that_bounces(chance: Chance) -> Table:
    body = _ball(chance)
    incline = chance.choice([0.0, 0.0, chance.uniform(0.05, 0.6)])
    drop = chance.uniform(0.0, 1.0)
    start = {
        "position": [0.0, 0.0, (body["radius"] + drop) / math.cos(incline)],
        "velocity": [chance.uniform(-2, 2), chance.uniform(-1, 1), chance.uniform(-2, 1)],
        "angular_velocity": _spin(chance, 30.0),
    }
    if chance.random() < 0.3:
        start |= {"velocity": [0.0, 0.0, 0.0], "angular_velocity": [0.0, 0.0, 0.0]}
    plane = {
        "incline": incline,
        "friction": _friction(chance),
        "restitution": chance.choice([0.0, 0.5, 0.8, 1.0, chance.random()]),
    }
    scene = {"gravity": 9.81, "plane": plane}
    return {"body": body, "initial": start, "scene": scene, "run": _run(chance.choice([0.6, 1.5, 4.0]), 11)}


def _roller(chance: Chance) -> Table:
    """A cylinder on its side, whose axis is across its path."""
    radius = chance.choice([0.1, 0.25])
    body = {"shape": "cylinder", "radius": radius, "half_length": chance.choice([0.1, 0.3]), "mass": 1.0}
    bounces = chance.random() < 0.4
    incline = 0.0 if chance.random() < 0.5 else chance.uniform(0.05, 1.0)
    # The axis K along y: Rz(0) Rx(-pi/2), then about y by the incline, which does not move it.
    start: Table = {"euler_zxz": [0.0, -math.pi / 2, chance.choice([0.0, 0.7])]}
    if chance.random() < 0.3:
        start = {"quaternion": [0.5, -0.5, 0.5, 0.5]}  # K along y, I along -z
    speed, spin = chance.choice([0.0, chance.uniform(-2, 2)]), chance.choice([0.0, chance.uniform(-20, 20)])
    start["velocity"] = [speed, 0.0, -speed * math.tan(incline) + (chance.uniform(-1, 1) if bounces else 0.0)]
    start["angular_velocity"] = [0.0, 0.0, spin]
    if bounces:
        start["position"] = [0.0, 0.0, (radius + chance.uniform(0.0, 0.5)) / math.cos(incline)]
    friction = _friction(chance)
    if incline and chance.random() < 0.4:
        friction = math.tan(incline) / 3 * (1 + chance.choice([-1, 0, 1]) * 10 ** -chance.uniform(8, 16))
    plane = {"incline": incline, "friction": friction, "restitution": chance.choice([0.0, 0.5, 0.9])}
    return {"body": body, "initial": start, "scene": {"gravity": 9.81, "plane": plane}, "run": _run(chance.choice([0.5, 1.5]))}


def _block(chance: Chance) -> Table:
    """A block that lies flat, on an incline next to the steepest on which it rests or on any, or pushed."""
    edges = [chance.choice([0.1, 0.2, 0.25, 0.5]) for _ in range(2)]
    low = chance.choice([0.01, 0.05, 0.3])
    body: Table = {"shape": "brick", "semi_axes": [*edges, low], "mass": chance.choice([0.5, 1.0, 3.0])}
    if chance.random() < 0.3:
        body = {"shape": "cylinder", "radius": edges[0], "half_length": low, "mass": 1.0}
    incline = chance.choice([0.0, chance.uniform(0.05, 1.0), chance.uniform(0.05, 1.0)])
    friction = chance.choice([0.0, 0.2, 0.5, chance.uniform(0.05, 1.0)])
    if incline and chance.random() < 0.5:
        friction = math.tan(incline) * (1 + chance.choice([-1, 0, 1]) * 10 ** -chance.uniform(8, 16))
    scene: Table = {"gravity": 9.81, "plane": {"incline": incline, "friction": friction}}
    start: Table = {}
    if chance.random() < 0.6:
        along, across = chance.uniform(-2, 2), chance.choice([0.0, chance.uniform(-2, 2)])
        start["velocity"] = [along, across, -along * math.tan(incline)]
        if chance.random() < 0.3:
            start["velocity"] = [0.0, across, 0.0]
    duration = chance.choice([0.5, 1.0, 2.0])
    if not incline or chance.random() < 0.4:
        scene["push"] = [_push(chance, body, incline, friction, duration, start) for _ in range(chance.choice([1, 1, 2]))]
    return {"body": body, "scene": scene, "run": _run(duration)} | ({"initial": start} if start else {})


def _push(chance: Chance, body: Table, incline: float, friction: float, duration: float, start: Table) -> Table:
    """A push at the centre of mass; on a level plane at times next to the force that friction holds."""
    weight = body["mass"] * 9.81
    size = chance.uniform(0.0, 2.0) * weight
    if not incline and chance.random() < 0.4:
        size = friction * weight * (1 + chance.choice([-1, 0, 1]) * 10 ** -chance.uniform(8, 16))
    angle = chance.choice([0.0, math.pi / 2, chance.uniform(0, 6.28)])
    push: Table = {"force": [size * math.cos(angle) if angle != math.pi / 2 else 0.0, size * math.sin(angle), 0.0]}
    if "velocity" not in start and chance.random() < 0.3:
        push["point"] = [0.0, 0.0, round(chance.uniform(-1, 1) * (body.get("half_length") or body["semi_axes"][2]), 3)]
    if chance.random() < 0.5:
        push["from"] = round(chance.uniform(0.0, duration), 2)
        if chance.random() < 0.7:
            push["until"] = push["from"] + round(chance.uniform(0.05, duration), 2)
    return push


def _dropped(chance: Chance) -> Table:
    """A body that falls and turns until something of it touches."""
    body: Table = {
        "shape": chance.choice(["brick", "ellipsoid"]),
        "semi_axes": [0.1, 0.15, chance.uniform(0.05, 0.3)],
        "mass": 1.0,
    }
    if chance.random() < 0.4:
        body = {"shape": "cylinder", "radius": chance.uniform(0.05, 0.2), "half_length": chance.uniform(0.05, 0.2), "mass": 2.0}
    start = {
        "position": [0.0, chance.choice([0.0, 1.0]), chance.uniform(0.5, 1.5)],
        "euler_zxz": [chance.uniform(0, 6.28), chance.uniform(0.1, 1.4), chance.uniform(0, 6.28)],
        "velocity": [chance.uniform(-1, 1), 0.0, chance.uniform(-1, 1)],
        "angular_velocity": _spin(chance, chance.choice([0.0, 3.0, 15.0])),
    }
    plane = {"incline": chance.choice([0.0, 0.3]), "friction": 0.5, "restitution": 0.3}
    return {"body": body, "initial": start, "scene": {"gravity": 9.81, "plane": plane}, "run": _run(0.8, 9)}


def _leaning(chance: Chance) -> Table:
    """A rod on its rim, or a brick on its edge, that is released at rest."""
    if chance.random() < 0.6:
        body: Table = {"shape": "cylinder", "radius": chance.choice([0.005, 0.02]), "half_length": 0.5, "mass": 1.0}
        start = {"euler_zxz": [chance.choice([0.0, 0.4]), chance.uniform(0.001, 1.3), 0.0]}
    else:
        body = {"shape": "brick", "semi_axes": [0.1, chance.choice([0.05, 0.1]), 0.3], "mass": 1.0}
        start = {"euler_zxz": [chance.choice([0.0, 1.1]), chance.uniform(0.05, 1.3), 0.0]}
    scene = {"gravity": 9.81, "plane": {"friction": chance.choice([0.1, 0.3, 0.6, 1.0, chance.uniform(0.2, 2.0)])}}
    return {"body": body, "initial": start, "scene": scene, "run": _run(chance.choice([0.5, 1.0, 2.0]), 9)}


def _coin(chance: Chance) -> Table:
    """A cylinder that rolls on its rim; velocity and spin fit within a rounding."""
    radius, half_length = chance.choice([0.05, 0.1]), chance.choice([0.002, 0.02])
    tilt = chance.uniform(0.4, 1.3)
    p, q, s = chance.choice([0.0, chance.uniform(-3, 3)]), chance.uniform(-8, 8), chance.uniform(-15, 15)
    sine, cosine = math.sin(tilt), math.cos(tilt)
    # K = (0, -sine, cosine); from the centre of mass to the rim: -half_length K + radius (0, -cosine, -sine)
    arm = (0.0, half_length * sine - radius * cosine, -half_length * cosine - radius * sine)
    spin = (p, q * cosine - s * sine, q * sine + s * cosine)
    velocity = [
        -(spin[1] * arm[2] - spin[2] * arm[1]),
        -(spin[2] * arm[0] - spin[0] * arm[2]),
        -(spin[0] * arm[1] - spin[1] * arm[0]),
    ]
    return {
        "body": {"shape": "cylinder", "radius": radius, "half_length": half_length, "mass": 0.02},
        "initial": {"euler_zxz": [0.0, tilt, 0.0], "velocity": velocity, "angular_velocity": [p, q, s]},
        "scene": {"gravity": 9.81, "plane": {"friction": chance.choice(["no-slip", "no-slip", 0.3, 1.0])}},
        "run": _run(chance.choice([0.2, 0.4]), 5),
    }


#: What draws a scene of each family, and what computes its motion.
FAMILIES: dict[str, tuple[Callable[[Chance], Table], Callable[[str, Sequence[Decimal]], Motion]]] = {
    "ball on a level plane": (_ball_on_level, balls.motion),
    "ball on an incline": (_ball_on_incline, balls.motion),
    "ball that bounces": (_ball_that_bounces, balls.motion),
    "cylinder on its side": (_roller, balls.motion),
    "block": (_block, blocks.motion),
    "dropped body": (_dropped, drops.motion),
    "leaning body": (_leaning, rods.motion),
    "rolling coin": (_coin, coins.motion),
}
