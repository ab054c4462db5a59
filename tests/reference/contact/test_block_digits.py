"""The bounds of blocks that lie flat, against a solution of fifty digits that shares no code with the truth or its witness."""

import math
from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.case import parse
from bodycheck.reference.truth import truth
from tests.support.block_digits import MP, Block
from tests.support.cases import a_case

#: The half-lengths of the brick (m): its flat shape makes the rounding of its height large relative to it.
HALVES = 1.0, 1.0, 0.01

#: The instants at which states are compared (s).
INSTANTS = 0.0, 0.3, 0.7, 1.5

GRAVITY = 9.81

#: The seeds of the scenes that do not take seconds: one of each kind.
QUICK = 5, 8, 14, 19


def drawn(seed: int) -> dict[str, Any]:
    """The incline (rad), friction, velocity along the plane (m/s), and pushes along it or not (N) of a random scene."""
    rng = np.random.default_rng(seed)
    kind = seed % 4
    incline = 0.0 if kind == 3 else float(rng.uniform(0.05, 1.0))
    limit = math.tan(incline) * (1 + rng.choice([-1, 1]) * 10.0 ** rng.uniform(-15, -8))
    friction = float(limit) if kind == 0 else float(rng.uniform(0.02, 1.2))
    velocity = (0.0, 0.0) if kind == 0 and rng.random() < 0.5 else tuple(float(part) for part in rng.normal(size=2))
    pushes = []
    for _ in range(rng.integers(1, 3) if kind >= 2 else 0):
        start = float(rng.choice([0.0, rng.uniform(0.0, 0.8)]))
        force = [float(part) for part in rng.normal(size=3) * [4.0, 4.0, 1.0]]
        pushes.append({"force": force, "from": start, "until": start + float(rng.uniform(0.1, 0.9))})
    return {"incline": incline, "friction": friction, "velocity": velocity, "pushes": pushes}


def text_of(scene: dict[str, Any]) -> str:
    (u, v), incline = scene["velocity"], scene["incline"]
    velocity = [u * math.cos(incline), v, -u * math.sin(incline)]
    plane = {"incline": incline, "friction": scene["friction"]}
    head = a_case(
        body={"shape": "brick", "mass": 1.0, "semi_axes": list(HALVES)},
        initial={"velocity": velocity},
        scene={"gravity": GRAVITY, "plane": plane},
        run={"duration": INSTANTS[-1], "samples": 2},
    )
    pushes = [
        f"[[scene.push]]\nforce = {push['force']}\nfrom = {push['from']!r}\nuntil = {push['until']!r}"
        for push in scene["pushes"]
    ]
    return "\n".join([head, *pushes])


def expected(scene: dict[str, Any], velocity: tuple[float, ...]) -> tuple[Block, list[Any], list[Any]]:
    """The block, and its positions (m) and velocities (m/s) in the world at `INSTANTS`."""
    cosine, sine = MP.cos_sin(MP.mpf(scene["incline"]))
    downhill, normal = (cosine, 0, -sine), (sine, 0, cosine)

    def along(vector: Any, axis: Any) -> Any:
        return sum(MP.mpf(a) * b for a, b in zip(vector, axis, strict=True))

    marks = sorted({0.0, *(push[key] for push in scene["pushes"] for key in ("from", "until"))})
    drives = []
    for mark in marks:
        forces = [push["force"] for push in scene["pushes"] if push["from"] <= mark < push["until"]]
        drive = (
            MP.mpf(GRAVITY) * sine + sum(along(force, downhill) for force in forces),
            sum(MP.mpf(force[1]) for force in forces),
        )
        press = MP.mpf(GRAVITY) * cosine - sum(along(force, normal) for force in forces)
        drives.append((MP.mpf(mark), (drive[0], MP.mpf(drive[1])), MP.mpf(scene["friction"]) * press))
    block = Block((along(velocity, downhill), MP.mpf(velocity[1])))
    rows = block.follow(drives, [MP.mpf(instant) for instant in INSTANTS])

    def in_world(x: Any, y: Any, z: Any) -> list[Any]:
        return [cosine * x + sine * z, y, cosine * z - sine * x]

    height = MP.mpf(HALVES[2])
    return block, [in_world(*place, height) for place, _ in rows], [in_world(*speed, 0) for _, speed in rows]


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=[] if seed in QUICK else pytest.mark.slow) for seed in range(60)])
def test_no_bound_of_a_block_is_broken(seed: int) -> None:
    scene = drawn(seed)
    parsed = parse(text_of(scene), "block.case.toml").scene
    solution = truth(parsed, np.array(INSTANTS))
    block, places, speeds = expected(scene, parsed.initial.velocity)  # type: ignore[union-attr]
    for states, exact, bounds in (
        (solution.trajectory.position, places, solution.bounds.position_error),
        (solution.trajectory.velocity, speeds, solution.bounds.velocity_error),
    ):
        for state, right, bound in zip(states.tolist(), exact, bounds.tolist(), strict=True):
            assert MP.sqrt(sum((MP.mpf(a) - b) ** 2 for a, b in zip(state, right, strict=True))) <= bound
    assert [event.kind for event in solution.events] == [kind for kind, _ in block.events]
    for event, (_, time) in zip(solution.events, block.events, strict=True):
        assert abs(MP.mpf(event.time) - time) <= event.error
