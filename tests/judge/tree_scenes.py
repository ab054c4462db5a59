"""Trees as robots' files have them, drawn from a seed, and the verdicts on their truths.

Several joints of one body, welds, bodies without mass, joints that follow others, and free bases. Shapes are few, so that the
integrators of the truth are compiled once for each; their numbers are drawn.
"""

import math
import random
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.judge import maximal
from tests.judge.documents import written
from tests.judge.numerals import exact
from tests.judge.verdicts import Verdict, joint_claims, state_claims, truth_of, verdict

Table = dict[str, Any]
Axis = tuple[float, float, float]

X, Y, Z, SKEW = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.48, 0.6, 0.64)

#: Forces along joints, each of which a shape has at all of its joints or at none.
FORCES = ("damping", "stiffness", "effort", "armature")


@dataclass(frozen=True)
class Part:
    """A body with its joint.

    type: of the joint, "free" for a base. parent: the index of another part, None for the world. follows: the index of the part
    whose joint the joint follows. still: whether it follows with a multiplier of zero.
    """

    type: str
    parent: int | None = None
    axis: Axis = Z
    massless: bool = False
    follows: int | None = None
    still: bool = False


def hinge(parent: int | None = None, axis: Axis = Z, **further: Any) -> Part:
    return Part("revolute", parent, axis, **further)


def slider(parent: int | None = None, axis: Axis = Z, **further: Any) -> Part:
    return Part("prismatic", parent, axis, **further)


def weld(parent: int | None = None, **further: Any) -> Part:
    return Part("fixed", parent, **further)


BASE, FRAME = Part("free"), Part("free", massless=True)

#: The parts of each shape, and the forces along its joints.
SHAPES: dict[str, tuple[tuple[Part, ...], tuple[str, ...]]] = {
    "two hinges": ((hinge(axis=X, massless=True), hinge(0, Y)), ()),
    "three hinges": ((hinge(axis=X, massless=True), hinge(0, Y, massless=True), hinge(1, Z)), ("damping",)),
    "hinge and slider": ((hinge(axis=Y, massless=True), slider(0, SKEW), hinge(1, X)), ("stiffness",)),
    "welds": ((hinge(axis=SKEW), weld(0, massless=True), weld(1), hinge(2, Y)), ()),
    "free welds": ((FRAME, weld(0), hinge(1, X), slider(1, Y)), ("effort",)),
    "free chains on bodies": ((BASE, hinge(0, X, massless=True), hinge(1, Y), hinge(0, Z)), ("damping", "stiffness")),
    "ancestor": ((hinge(axis=Y), hinge(0, X), hinge(1, Y, follows=0)), ()),
    "descendant": ((hinge(axis=Y, follows=2), slider(0, X), hinge(1, SKEW)), ("effort", "armature")),
    "followers": ((hinge(axis=Y), hinge(0, Y, follows=0), hinge(1, Y, follows=1), hinge(2, X)), ("damping", "armature")),
    "gripper": ((hinge(axis=Y), slider(0, X), slider(0, X, follows=1)), FORCES),
    "other tree": ((hinge(axis=Y), hinge(0, X), hinge(axis=X), slider(2, Z, follows=1)), ("stiffness",)),
    "still": ((hinge(axis=X), hinge(0, Y, follows=0, still=True), hinge(1, Z)), ("stiffness", "damping")),
    "followed on one body": ((hinge(axis=X, massless=True), hinge(0, Y, follows=0), hinge(1, X)), ()),
    "free gripper": ((BASE, hinge(0, X), hinge(0, X, follows=1), hinge(2, Y)), ("armature",)),
    "two free bases": ((BASE, hinge(0, X), BASE, hinge(2, Y, follows=1)), ("damping",)),
    "branches": ((hinge(axis=Z), hinge(0, X), slider(0, Y), weld(2), hinge(3, X)), ("effort", "damping")),
}


def drawn(seed: int) -> tuple[str, str]:
    """Return the kind and the text of the case of a seed."""
    chance = random.Random(f"tree {seed}")
    kind = chance.choice(list(SHAPES))
    parts, forces = SHAPES[kind]
    document: Table = {
        "format": 2,
        "name": f"judged-{seed}",
        "title": f"A tree that was drawn: {kind}",
        "bodies": [_body(chance, index, part) for index, part in enumerate(parts)],
        "joints": [_joint(chance, index, part, forces) for index, part in enumerate(parts) if part.type != "free"],
        "scene": {"gravity": chance.choice([9.81, 1.62])},
        "run": {"duration": chance.choice([0.1, 0.2, 0.3]), "samples": 3},
    }
    return kind, written(document)


def judge(seed: int, folder: Path) -> Verdict:
    """Return the verdict on the truth of the tree of a seed."""
    kind, text = drawn(seed)
    truth = truth_of(text, folder)
    if isinstance(truth, str):
        return Verdict(seed, kind, 0.0, refused=truth)
    motion = maximal.motion(text, exact(truth.trajectory.t.tolist()))
    claims = joint_claims(truth, motion, lengths=10.0)
    for body, name in enumerate(each.name for each in truth.scene.bodies):
        states = {index: instant.bodies[name] for index, instant in enumerate(motion)}
        claims += state_claims(truth, body, states, f" of {name}")
    return verdict(seed, kind, claims)


def vector(chance: random.Random, size: float) -> list[float]:
    return [chance.uniform(-size, size) for _ in range(3)]


def quaternion(chance: random.Random) -> list[float]:
    parts = [1.0, *vector(chance, 1.0)]
    return [part / math.hypot(*parts) for part in parts]


def _body(chance: random.Random, index: int, part: Part) -> Table:
    table: Table = {"name": f"body-{index}"}
    if part.massless:
        table |= {"mass": 0.0, "inertia": [0.0, 0.0, 0.0]}
    else:
        a, b, c = (chance.uniform(0.02, 0.2) for _ in range(3))
        table |= {"mass": chance.uniform(0.5, 2.0), "inertia": [b + c, a + c, a + b], "center_of_mass": vector(chance, 0.4)}
    if part.type == "free":
        table["initial"] = {
            "position": vector(chance, 2.0),
            "quaternion": quaternion(chance),
            "velocity": vector(chance, 2.0),
            "angular_velocity": vector(chance, 3.0),
        }
    return table


def _joint(chance: random.Random, index: int, part: Part, forces: tuple[str, ...]) -> Table:
    table: Table = {
        "name": f"joint-{index}",
        "type": part.type,
        "child": f"body-{index}",
        "position": vector(chance, 0.6),
        "quaternion": quaternion(chance),
    }
    if part.parent is not None:
        table["parent"] = f"body-{part.parent}"
    if part.type == "fixed":
        return table
    table["axis"] = list(part.axis)
    for key, high in zip(FORCES, (0.5, 5.0, 3.0, 0.2), strict=True):
        if key in forces:
            table[key] = chance.uniform(0.05, high)
    if "stiffness" in forces:
        table["rest"] = chance.uniform(-0.5, 0.5)
    if part.follows is None:
        # Three hinges of one body are far from the position in which two of their axes are parallel.
        table["initial"] = {"position": chance.uniform(-0.6, 0.6), "velocity": chance.uniform(-2.0, 2.0)}
    else:
        multiplier = 0.0 if part.still else chance.choice([-1.0, 1.0, chance.uniform(-2.0, 2.0)])
        table["mimic"] = {"joint": f"joint-{part.follows}", "multiplier": multiplier, "offset": chance.uniform(-0.5, 0.5)}
    return table
