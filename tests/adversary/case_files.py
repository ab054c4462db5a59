"""Hostile case files, each drawn by its seed: mutants of good files, noise, and good grammar with extreme numbers."""

import json
import math
import random
from collections.abc import Callable
from functools import cache
from typing import Any

from bodycheck import load
from bodycheck.casefile.axes import AXES
from bodycheck.casefile.case import MAX_FILE_BYTES, shipped
from bodycheck.casefile.values import MAX_NUMBER, MAX_SAMPLES
from bodycheck.figures.columns import LIMITED
from tests.adversary import ensemble_tables, mechanism_tables
from tests.support.cases import a_case
from tests.support.mutants import MECHANISMS, NASTY, RICH, mutant

Chance = random.Random
Table = dict[str, Any]

#: Numbers at the limits of the grammar, and where double precision has its limits.
EDGES = (MAX_NUMBER, 1 / MAX_NUMBER, 0.9e100, 1e-99, 1e50, 1e-50, 1e75, 1e-75, 1e16, 1e-16, 1e9, 1e-9, 1 + 2**-52)

#: How often each kind of file is drawn.
KINDS = {"mutant": 0.4, "noise": 0.05, "extreme": 0.4, "mechanism": 0.15}


def drawn(seed: int) -> bytes:
    """The content of the file of a seed."""
    chance = random.Random(seed)
    (kind,) = chance.choices(list(KINDS), list(KINDS.values()))
    if kind == "mutant":
        return mutant(chance, _good())[1]
    if kind == "noise":
        return noise(chance)
    return (extreme(chance) if kind == "extreme" else mechanism(chance)).encode()


@cache
def _good() -> tuple[str, ...]:
    return RICH, *MECHANISMS, *(load(name).text for name in shipped())


def noise(chance: Chance) -> bytes:
    """Bytes of no file, or a good file in another encoding."""
    size = chance.choice([0, 1, 3, 100, 5000])
    text = chance.choice(_good())
    match chance.randrange(6):
        case 0:
            return chance.randbytes(size)
        case 1:
            return bytes(chance.choice(b"[]{}\"'=.,#\n \t\\u0_exn") for _ in range(size))
        case 2:
            return text.encode(chance.choice(["utf-16", "utf-32", "utf-8-sig", "utf-16-le", "cp037"]))
        case 3:
            return chance.randbytes(16) + text.encode()
        case 4:
            return b"\0" * size + text.encode()
        case _:
            return text.encode() * (MAX_FILE_BYTES // len(text.encode()))


def extreme(chance: Chance) -> str:
    """The text of a file of good grammar, some numbers of which are as large or as small as they may be."""
    number = _numbers(chance)
    body, initial = _body(chance, number), _initial(chance, number)
    scene: Table = {"gravity": chance.choice([0.0, 9.81, abs(number())])}
    if chance.random() < 0.25:
        scene["plane"] = _plane(chance, number)
        if chance.random() < 0.7:  # flat on it, with a spin about its normal
            initial = {"velocity": [number(), number(), 0.0], "angular_velocity": [0.0, 0.0, number()]}
    if chance.random() < 0.2:
        scene["drag"] = {"quadratic": number(positive=True)}
    run = _run(chance, number)
    expect = [_expectation(chance, number, run["duration"]) for _ in range(chance.choice([0, 0, 1, 3, 40]))]
    axes = chance.sample(list(AXES), chance.choice([0, 0, 0, 1, 3]))
    extremes = {axis: sorted({min(number(positive=True), 1.0) for _ in range(chance.randint(1, 4))}) for axis in axes}
    text = a_case("extreme", body=body, initial=initial, scene=scene, run=run, extremes=extremes or None, expect=expect)
    if chance.random() < 0.4:
        text += ensemble_tables.drawn(chance, text, number)
    return text if chance.random() < 0.9 else text.replace(json.dumps(run["duration"]), chance.choice(NASTY), 1)


def mechanism(chance: Chance) -> str:
    """The same of a mechanism."""
    number = _numbers(chance)
    text = mechanism_tables.drawn(chance, number, lambda: _body(chance, number), _run(chance, number))
    return text + ensemble_tables.drawn(chance, text, number) if chance.random() < 0.3 else text


Number = Callable[..., float]


def _numbers(chance: Chance) -> Number:
    """What draws numbers, more or less of which are extreme."""
    wild = chance.choice([0.0, 0.05, 0.2, 1.0])

    def number(positive: bool = False) -> float:
        value = 10 ** chance.uniform(-2, 2)
        if chance.random() < wild:
            value = chance.choice(EDGES) if chance.random() < 0.5 else 10 ** chance.uniform(-100, 100)
        return value if positive else value * chance.choice([-1, 0, 1, 1])

    return number


def _run(chance: Chance, number: Number) -> Table:
    samples = MAX_SAMPLES if chance.random() < 0.03 else chance.choice([2, 3, 11, 101])
    return {"duration": number(positive=True), "samples": samples}


def _vector(number: Number, **options: bool) -> list[float]:
    return [number(**options) for _ in range(3)]


def _solid(chance: Chance, number: Number) -> Table:
    shape = chance.choice(["brick", "ellipsoid", "cylinder", "sphere"])
    found: Table = {"shape": shape, "mass": number(positive=True)}
    if shape in ("brick", "ellipsoid"):
        return found | {"semi_axes": _vector(number, positive=True)}
    return found | {"radius": number(positive=True)} | ({"half_length": number(positive=True)} if shape == "cylinder" else {})


def _body(chance: Chance, number: Number) -> Table:
    kind = chance.choice(["solid", "solid", "moments", "solid with moments", "tensor", "particles", "parts", "flat"])
    if kind in ("solid", "solid with moments"):
        return _solid(chance, number) | ({"inertia": _moments(chance, number)} if kind != "solid" else {})
    if kind == "moments":
        return {"shape": "none", "mass": number(positive=True), "inertia": _moments(chance, number)}
    if kind == "tensor":
        a, b, c = _moments(chance, number)
        x, y, z = (allowed(number() * chance.choice([0.0, 1e-3, 1.0])) for _ in range(3))
        rows = [[a, x, y], [x, b, z], [y, z, c]]
        return {"shape": "none", "mass": number(positive=True), "inertia": rows}
    count = chance.choice([1, 2, 3, 4, 10, 100])
    if kind == "parts":
        return {"parts": [_solid(chance, number) | _placed(chance, number) for _ in range(count)]}
    along = _vector(number)
    places = [[allowed(number() * each) for each in along] if kind == "flat" else _vector(number) for _ in range(count)]
    return {"particles": [{"mass": number(positive=True), "position": place} for place in places]}


def _moments(chance: Chance, number: Number) -> list[float]:
    """Moments that a body may have: from the second moments along its axes, each of which may nearly vanish."""
    a, b, c = (number(positive=True) * chance.choice([1.0, 1.0, 1e-15, 0.0]) for _ in range(3))
    return [allowed(moment) or 1.0 for moment in (b + c, c + a, a + b)]


def allowed(value: float) -> float:
    """The number that the grammar allows nearest to one."""
    return math.copysign(min(max(abs(value), 1 / MAX_NUMBER), MAX_NUMBER), value) if value else 0.0


def _placed(chance: Chance, number: Number) -> Table:
    turned = chance.choice([{}, {"euler_zxz": _vector(number)}, {"quaternion": [number() for _ in range(4)]}])
    return turned | ({"position": _vector(number)} if chance.random() < 0.7 else {})


def _initial(chance: Chance, number: Number) -> Table:
    found: Table = {}
    if chance.random() < 0.5:
        found |= {"position": _vector(number), "velocity": _vector(number)}
    quaternion = chance.choice([[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, -0.5, 0.5], [0.9999, 0.0, 0.0, 1e-9], [0.6, 0.0, 0.8, 1e-100]])
    found |= chance.choice([{}, {"euler_zxz": _vector(number)}, {"quaternion": quaternion}])
    rates = [chance.choice([0.0, 1.0, 1.0]) * number() for _ in range(3)]
    return found | chance.choice([{}, {"angular_velocity": rates}, {"angular_velocity": rates}, {"euler_rates": rates}])


def _plane(chance: Chance, number: Number) -> Table:
    return {
        "friction": number(positive=True),
        "law": (law := chance.choice(["area", "corners", "decoupled"])),
        "pressure": chance.choice(["uniform", "balanced"]) if law != "decoupled" else "uniform",
    }


def _expectation(chance: Chance, number: Number, duration: float) -> Table:
    method = {"engine": chance.choice(["mujoco", "pinocchio"]), "integrator": chance.choice(["Euler", "rk4"])}
    steps = chance.choice([1, 10, 1000])
    limited = {chance.choice(list(LIMITED)): chance.choice([number(positive=True), {"at_most": number(positive=True)}])}
    return method | {"timestep": allowed(duration / steps)} | chance.choice([limited, {"status": "diverged"}])
