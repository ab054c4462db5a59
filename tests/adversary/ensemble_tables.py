"""Hostile tables `[ensemble]` for case files, drawn by chance: keys known and unknown, parameters of any size and length."""

import json
import random
import tomllib
from collections.abc import Callable
from typing import Any

from bodycheck.casefile.distributions import Key
from bodycheck.casefile.ensemble_grammar import DISTRIBUTIONS
from bodycheck.casefile.key_paths import keys
from bodycheck.casefile.values import MAX_CHOICES, MAX_MEMBERS, MAX_NUMBER, MAX_SEED, MAX_VARIATIONS

Chance = random.Random

#: Numbers of members and seeds, at the limits and far beyond.
MEMBERS = (1, 2, 17, 1000, MAX_MEMBERS, MAX_MEMBERS, MAX_MEMBERS + 1, 10**18, 10**400, 0, -1, 1.0, True, "9", [3])
SEEDS = (0, 1, MAX_SEED, MAX_SEED + 1, -1, 2**64, 10**400, 1.5, False)

#: Key paths that lead nowhere, or to what is no number, or are no paths.
STRANGE_KEYS = (
    *("", ".", "..", "body", "body.", ".body.mass", "body..mass", "body.shape", "run.samples", "name", "expect.0.timestep"),
    *("ensemble.members", "ensemble.vary.0.low", "extremes.spin.0", "initial.velocity.3", "initial.velocity.-1"),
    *("initial.velocity.00", "initial.velocity.\u0661", "initial.velocity.9999999999999", "body.mass.0", "body.inertia.1.0"),
    *("BODY.MASS", "bödy.mass", "\u0431ody.mass", "body.mass\u0000", "\u202ebody.mass", "\x1b[2J", "::error::x", "=1+1"),
    *("../../etc/passwd", "x" * 100, "x" * 5000, "__class__.__init__", "scene.plane.friction", "joints.pin.damping"),
)

#: Numbers that no parameter can be.
STRANGE_NUMBERS = ("nan", "inf", "-inf", "1e101", "1e400", "9" * 400, "true", '"x"', "[]", "[[1.0]]", "{}", "1e-101")


def drawn(chance: Chance, text: str, number: Callable[..., float]) -> str:
    """The tables of an ensemble of the case of a text; number: draws the numbers of a case."""
    known = list(keys(tomllib.loads(text)).values())
    right = chance.random() < 0.5  # a table with few faults, so that members are drawn from it
    members = chance.choice(MEMBERS[:6] if right else MEMBERS)
    seed = chance.choice(SEEDS[:3] if right else SEEDS)
    count = chance.choice([1, 1, 2, 3, 5] if right else [0, 1, 2, MAX_VARIATIONS, MAX_VARIATIONS + 1, 300])
    chosen = chance.sample(known, min(count, len(known))) if right else [chance.choice(known) for _ in range(count)]
    tables = [_variation(chance, key, number, right) for key in chosen]
    head = f"\n[ensemble]\nmembers = {json.dumps(members)}\nseed = {json.dumps(seed)}\n"
    return head + "".join(f"[[ensemble.vary]]\n{table}\n" for table in tables)


def _variation(chance: Chance, key: Key, number: Callable[..., float], right: bool) -> str:
    """The table of one key: one that is allowed, for the most part, or any."""
    name, size = key.text, key.components
    distribution = chance.choice(list(DISTRIBUTIONS))
    if len(key.shape) > 1:
        name, size = f"{name}.0.{chance.randrange(3)}", None
    elif size is not None and chance.random() < 0.3:
        name, size = f"{name}.{chance.randrange(size)}", None
    if right and distribution == "sphere" and size != 3:
        distribution = "choice"
    if right and distribution == "attitude":
        distribution = chance.choice(["attitude", "uniform"])
    lines = {} if distribution == "attitude" else {"key": _key(chance, name, right)}
    lines["distribution"] = json.dumps(distribution)
    positive = key.sign != "any"
    match distribution:
        case "uniform" | "log-uniform":
            positive = positive or distribution == "log-uniform"
            pairs = [sorted([_limited(number(positive)), _limited(number(positive))]) for _ in range(size or 1)]
            for place, parameter in enumerate(("low", "high")):
                lines[parameter] = _several([pair[place] for pair in pairs], size)
        case "normal":
            lines["mean"] = _several([_limited(number(positive)) for _ in range(size or 1)], size)
            lines["standard_deviation"] = _several([_limited(number(True)) for _ in range(size or 1)], size)
        case "sphere":
            lines["radius"] = repr(_limited(number(True)))
        case "choice":
            many = chance.choice([1, 2, 5] if right or chance.random() < 0.9 else [0, 1, MAX_CHOICES, MAX_CHOICES + 1, 20_000])
            values = [_several([_limited(number(positive)) for _ in range(size or 1)], size) for _ in range(min(many, 50))]
            lines["values"] = f"[{', '.join(values * (many // max(1, len(values))))}]"
    if not right and chance.random() < 0.5:
        _damage(chance, lines)
    return "\n".join(f"{name} = {value}" for name, value in lines.items())


def _key(chance: Chance, name: str, right: bool) -> str:
    return json.dumps(name if right or chance.random() < 0.6 else chance.choice(STRANGE_KEYS))


def _damage(chance: Chance, lines: dict[str, Any]) -> None:
    """Leave out a line, give a strange number or a vector of another length, or add an unknown key."""
    name = chance.choice(list(lines))
    match chance.randrange(4):
        case 0:
            del lines[name]
        case 1:
            lines[name] = chance.choice(STRANGE_NUMBERS)
        case 2:
            lines[name] = json.dumps([1.0] * chance.choice([0, 1, 2, 4, 5, 1000]))
        case _:
            lines["unknown"] = "1"


def _several(values: list[float], size: int | None) -> str:
    return repr(values) if size else repr(values[0])


def _limited(value: float) -> float:
    """The number nearest to one that the grammar allows."""
    return 0.0 if abs(value) < 1 / MAX_NUMBER else max(-MAX_NUMBER, min(MAX_NUMBER, value))
