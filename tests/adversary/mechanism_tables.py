"""Case files of mechanisms of good grammar, some numbers of which are as large or as small as they may be."""

import random
from collections.abc import Callable
from typing import Any

from bodycheck.casefile.mechanisms.grammar import JOINT_TABLES
from bodycheck.casefile.toml_text import written

Chance = random.Random
Table = dict[str, Any]
Number = Callable[..., float]

#: How many bodies a mechanism has.
COUNTS = (1, 1, 2, 2, 3, 5, 9)


def drawn(chance: Chance, number: Number, solid: Callable[[], Table], run: Table) -> str:
    """The text of a file.

    Parameters
    ----------
    chance, number
        What everything is drawn from, and what draws a number that is allowed.
    solid
        Draws the table of a body of format 1.
    run
        The table `[run]`.
    """
    names = [f"b{place}" for place in range(chance.choice(COUNTS))]
    bodies, joints = [], []
    for place, name in enumerate(names):
        body = {"name": name, **solid()}
        if "particles" not in body and "parts" not in body:
            body |= chance.choice([{}, {"center_of_mass": _vector(number)}])
            if "inertia" in body:
                body["inertia"] = chance.choice([body["inertia"], body["inertia"], [0.0, 0.0, 0.0]])
        if chance.random() < 0.15:
            body |= chance.choice([{}, {"initial": {"position": _vector(number), "angular_velocity": _vector(number)}}])
        else:
            joints.append(_joint(chance, number, place, ["world", *names[:place]]))
        bodies.append(body)
    document: Table = {"format": 2, "name": "extreme", "title": "A mechanism", "bodies": bodies}
    document |= {"joints": joints} if joints else {}
    if chance.random() < 0.1 and len(names) > 1:
        ends = chance.sample(["world", *names], 2)
        document["loops"] = [{"bodies": ends, "points": [_vector(number), _vector(number)]}]
    document |= {"scene": {"gravity": chance.choice([0.0, 9.81, abs(number())])}, "run": run}
    return written(document)


def _joint(chance: Chance, number: Number, place: int, parents: list[str]) -> Table:
    kind = chance.choice(list(JOINT_TABLES))
    joint: Table = {"name": f"j{place}", "type": kind, "parent": chance.choice(parents), "child": f"b{place}"}
    joint |= chance.choice([{}, {"position": _vector(number)}, {"position": _vector(number), "euler_zxz": _vector(number)}])
    if kind in ("revolute", "prismatic"):
        joint["axis"] = _vector(number) if chance.random() < 0.3 else chance.choice([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        for key in ("armature", "damping", "stiffness", "rest", "friction", "effort"):
            if chance.random() < 0.2:
                joint[key] = abs(number())
    quaternion = chance.choice([[1.0, 0.0, 0.0, 0.0], [0.6, 0.0, 0.8, 0.0]])
    starts: dict[str, Table] = {
        "universal": {"position": _vector(number)[:2], "velocity": _vector(number)[:2]},
        "planar": {"position": _vector(number), "velocity": _vector(number)},
        "spherical": {"quaternion": quaternion, "velocity": _vector(number)},
        "free": {"position": _vector(number), "quaternion": quaternion, "velocity": _vector(number), "linear": _vector(number)},
    }
    if kind != "fixed" and chance.random() < 0.8:
        joint["initial"] = starts.get(kind, {"position": number(), "velocity": number()})
    return joint


def _vector(number: Number) -> list[float]:
    return [number() for _ in range(3)]
