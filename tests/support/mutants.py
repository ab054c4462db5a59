"""Mutants of case files, and a watch on the process that reads them."""

import contextlib
import json
import random
import re
import resource
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from bodycheck import CaseFaults, load
from bodycheck.casefile.case import MAX_FILE_BYTES, shipped
from tests.support.mechanism_texts import ALL_JOINTS, CART_POLE, FOUR_BAR

RICH = """\
format = 1
name = "rich"
title = "All that the grammar has"
source = "nobody"
tags = ["free", "unstable"]

[[body.parts]]
shape = "sphere"
radius = 1.0
mass = 1.0
position = [0.6, 0.0, 0.8]

[[body.parts]]
shape = "cylinder"
radius = 1.0
half_length = 0.5
mass = 1.0
quaternion = [1.0, 0.0, 0.0, 0.0]

[initial]
position = [0.0, 0.0, 1.0]
velocity = [1.0, 0.0, 2.0]
euler_zxz = [0.0, 1.5707963267948966, 0.0]
angular_velocity = [1.0, 2.0, 3.0]

[scene]
gravity = 9.81
drag = {quadratic = 0.01}

[run]
duration = 1.0
samples = 101

[extremes]
spin = [1.0, 1e3]
timestep = [0.001, 0.002]

[ensemble]
members = 1000
seed = 1

[[ensemble.vary]]
key = "initial.velocity"
distribution = "normal"
mean = [0.0, 0.0, 0.0]
standard_deviation = 3.0

[[ensemble.vary]]
key = "body.parts.0.mass"
distribution = "choice"
values = [1.0, 2.0]

[[expect]]
engine = "mujoco"
integrator = "RK4"
timestep = 0.002
attitude_error = {at_least = 0.0, at_most = 1e-6}
order = 4
known = "https://example.org/7"
until = "2030-01-01"

[[expect]]
engine = "pinocchio"
integrator = "rk4"
timestep = 0.002
status = "diverged"
"""

#: The most processor time (s) that a file may take. The largest mutants take up to half a second, and twice as much where other
#: processes use the same caches and cores.
LONGEST_S = 3.0

#: As little as files may have.
BARE = (
    'format = 1\nname = "bare"\ntitle = ""\nbody = {shape = "sphere", radius = 1, mass = 1}\nrun = {duration = 1, samples = 2}'
)
BARE_JOINTS = re.sub("\n(initial|gravity) = .*", "", ALL_JOINTS).replace("[scene]\n", "")

#: Good files of mechanisms.
MECHANISMS = (ALL_JOINTS, CART_POLE, FOUR_BAR)

#: Values that a stranger may give a key.
NASTY = (
    *("nan", "inf", "-inf", "-0.0", "0", "-1", "1e308", "1e-308", "1e99", "1e100", "1e-100", "1e400", "1000000000000", "0x7f"),
    *("9" * 400, "9" * 5000, "0x" + "f" * 20000, "1" + "_0" * 3000, "1." + "0" * 3000, "true", "''", '""', '"x"', '"ok"', "[]"),
    *("{}", "[[]]", "[{}]", "[1, 2, 3]", "[0, 0, 0]", "[1e100, 1e100, 1e100]", "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"),
    *('["a", 1, {}]', "{a = 1}", "{at_least = 2}", "{at_most = -1}", '{shape = "none"}', "2020-01-01", "12:00:00"),
    *("2020-01-01T00:00:00Z", "2020-02-31", r'"\u0000"', r'"\u001b[2J"', r'"a\nb"', r'"\ud800"', '"""\n\n"""', "'''x'''"),
    *("[" * 40 + "]" * 40, "[" * 3000, "[" * 3000 + "]" * 3000, "{a=" * 300 + "1" + "}" * 300, '"' + "x" * 5000 + '"'),
    *('\'__import__("os").system("true")\'', '"{{7*7}}"', '"../../etc/passwd"', '"/dev/zero"', '"$HOME"', '"%n"', "'é\u202e'"),
)

#: Lines that a stranger may write.
JUNK = (
    *("[", "]]", "= 1", "x", "x =", '"x" = 1', "'' = 1", "[a.b]", "[[expect]]", "[body]", "[[body]]", "[scene.plane]"),
    *(
        "[[bodies]]",
        "[[joints]]",
        "[[loops]]",
        "[model]",
        "bodies = 1",
        "joints = [1]",
        "[bodies.initial]",
        "[initial.joints.a]",
    ),
    *(r'"a\nb" = 1', r'"\u001b[31m" = 1', '"\u202e" = 1', "body.mass = 1", "expect = 3", "extremes = 3", "x = [[[]]]", "#\x07"),
    *(".".join("x" * 17) + " = 1", "x." * 9000 + "x = 1", "[" + "a." * 500 + "a]", 'x = """', "x = '''", "include = 'x'"),
)

CONTROLS = "\0\a\b\f\r\x1b\x7f\x85\u2028"

#: What a file may be filled with, over and over, and what stands before and behind it.
FILLINGS = (
    *(("1,", "x = [", "]\n"), ("[],", "x = [", "]\n"), ("{a=1},", "tags = [", "]\n"), ("\\n", 'x = "', '"\n')),
    *(("[", "x = ", "\n"), ("{a=", "x = ", "\n"), ('"', "", "\n"), ("a", "", " = 1\n"), ("a.", "", "a = 1\n")),
    *(
        ("\n", "", ""),
        ("#\n", "", ""),
        ("[[expect]]\n", "", ""),
        ("[[body.parts]]\nmass=1\n", "", ""),
        ("[[joints]]\n", "", ""),
        ("x", "#", "\n"),
    ),
)

Mutation = Callable[[random.Random, str], str | bytes]


def in_lines(change: Callable[[random.Random, list[str]], object]) -> Mutation:
    def mutate(chance: random.Random, text: str) -> str:
        lines = text.split("\n")
        change(chance, lines)
        return "\n".join(lines)

    return mutate


def somewhere(chance: random.Random, lines: list[str]) -> int:
    return chance.randrange(len(lines))


def insert(chance: random.Random, text: str, what: str) -> str:
    at = chance.randrange(len(text) + 1)
    return text[:at] + what + text[at:]


def swap(chance: random.Random, lines: list[str]) -> None:
    one, other = somewhere(chance, lines), somewhere(chance, lines)
    lines[one], lines[other] = lines[other], lines[one]


def change_a_value(values: Callable[[random.Random], str]) -> Mutation:
    def change(chance: random.Random, lines: list[str]) -> None:
        at = chance.choice([at for at, line in enumerate(lines) if "=" in line] or [0])
        lines[at] = f"{lines[at].partition('=')[0]}= {values(chance)}"

    return in_lines(change)


def misspell(chance: random.Random, text: str) -> str:
    words = list(re.finditer("[a-z_]{3,}", text))
    if not words:
        return text
    word = chance.choice(words)
    at = chance.randrange(word.start(), word.end())
    return text[:at] + chance.choice(["", "x", text[at] * 2, text[at].upper()]) + text[at + 1 :]


def flip_bytes(chance: random.Random, text: str) -> bytes:
    content = bytearray(text.encode())
    for _ in range(chance.randint(1, 5)):
        if content:
            content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
    return bytes(content)


def invalid_utf8(chance: random.Random, text: str) -> bytes:
    at = chance.randrange(len(text) + 1)
    return text[:at].encode() + chance.choice([b"\xff", b"\xc0\x80", b"\xed\xa0\x80", b"\xf4\x90\x80\x80"]) + text[at:].encode()


def fill(chance: random.Random, text: str) -> str:
    """As much of one thing as a file may hold, or somewhat more."""
    room = chance.choice([1000, 20_000, MAX_FILE_BYTES - len(text.encode()) - 100, MAX_FILE_BYTES])
    item, head, tail = chance.choice(FILLINGS)
    filled = head + item * (room // len(item)) + tail
    return filled + text if chance.random() < 0.5 else text + "\n" + filled


def many_keys(chance: random.Random, text: str) -> str:
    keys = "".join(f"k{number} = {number}\n" for number in range(chance.choice([10, 200, 15_000])))
    return keys + text if chance.random() < 0.5 else text + "\n" + keys


MUTATIONS: dict[str, Mutation] = {
    "bytes flipped": flip_bytes,
    "line dropped": in_lines(lambda chance, lines: lines.pop(somewhere(chance, lines))),
    "line twice": in_lines(lambda chance, lines: lines.insert(somewhere(chance, lines), chance.choice(lines))),
    "lines swapped": in_lines(swap),
    "junk line": in_lines(lambda chance, lines: lines.insert(somewhere(chance, lines), chance.choice(JUNK))),
    "nasty value": change_a_value(lambda chance: chance.choice(NASTY)),
    "number": change_a_value(lambda chance: f"{chance.uniform(-10, 10):.3g}e{chance.randint(-120, 120)}"),
    "name misspelled": misspell,
    "control character": lambda chance, text: insert(chance, text, chance.choice(CONTROLS)),
    "bom": lambda chance, text: "\ufeff" + text,
    "not utf-8": invalid_utf8,
    "crlf": lambda chance, text: text.replace("\n", "\r\n"),
    "cr": lambda chance, text: text.replace("\n", "\r", 1),
    "cut off": lambda chance, text: text[: chance.randrange(len(text) + 1)],
    "twice": lambda chance, text: text + text,
    "absurd samples": lambda chance, text: re.sub("samples = .*", f"samples = {10 ** chance.randint(6, 30)}", text),
    "filled": fill,
    "many keys": many_keys,
}

#: Mutations that take time.
RARE = {"filled", "many keys"}

#: Events of a process that touch nothing outside it.
SILENT = {"sys._getframe", "builtins.id", "object.__getattr__", "object.__setattr__"}


def mutants(seed: int, count: int) -> Any:
    """Names and contents of so many mutants, the same for one seed."""
    chance = random.Random(seed)
    good = [RICH, *MECHANISMS, *(load(name).text for name in shipped())]
    for _ in range(count):
        yield mutant(chance, good)


def mutant(chance: random.Random, good: Sequence[str]) -> tuple[str, bytes]:
    """Name and content of a mutant of one of some good files."""
    weights = [0.2 if name in RARE else 1.0 for name in MUTATIONS]
    content: str | bytes = chance.choice(good)
    names = []
    for name in chance.choices(list(MUTATIONS), weights, k=chance.choice([1, 1, 1, 2, 3])):
        if isinstance(content, str):
            content = MUTATIONS[name](chance, content)
            names.append(name)
    return " + ".join(names), content.encode() if isinstance(content, str) else content


def wrong(path: Path, content: bytes, error: CaseFaults) -> str:
    """What is wrong with what is said of a file; nothing where all is as it should be."""
    readable = len(content) <= MAX_FILE_BYTES
    lines = str(error).split("\n")
    if len(lines) != len(error.faults) or not error.faults:
        return "not one line a fault"
    for line, fault in zip(lines, error.faults, strict=True):
        place = fault.position
        if not line.startswith(f"{path}:") or not line.isprintable() or len(line) > 1000 + len(str(path)):
            return f"a line that is no message: {line!r}"
        if place is None and readable and not fault.message.endswith("more faults"):
            return f"no place: {line}"
        if place is not None and not (1 <= place.line <= content.count(b"\n") + 1 and 1 <= place.column <= len(content) + 1):
            return f"a place that is not there: {line}"
    return ""


def watch(folder: str, seed: int, count: int) -> None:
    """Read mutants in this process and print what came of them, as JSON. To be called in a process of its own."""
    path = Path(folder) / "mutant.case.toml"
    watched = False
    seen: list[str] = []

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if watched and event not in SILENT and not (event == "open" and arguments[0] == str(path)):
            seen.append(f"{event} {[argument if isinstance(argument, str) else type(argument) for argument in arguments]}")

    everything = list(mutants(seed, count))
    spoilt = [text.replace("1.0", "-1.0").replace("[scene]", "[scne]") for text in (RICH, *MECHANISMS)]
    for text in (
        RICH,
        BARE,
        BARE_JOINTS,
        *MECHANISMS,
        *spoilt,
        "x = ",
    ):  # so that all is imported, and the grammar of all tables built
        path.write_text(text)
        with contextlib.suppress(CaseFaults):
            load(path)
    sys.addaudithook(hook)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    problems: list[str] = []
    ends: Counter[str] = Counter()
    slowest = 0.0
    for name, content in everything:
        path.write_bytes(content)
        seen.clear()
        start, watched = time.process_time(), True
        try:
            load(path)
            end, problem = "case", ""
        except CaseFaults as error:
            end, problem = "faults", wrong(path, content, error)
        except Exception as error:
            end, problem = "error", f"{type(error).__name__}: {error}"
        watched, taken = False, time.process_time() - start
        slowest = max(slowest, taken)
        ends[end] += 1
        problem = problem or (f"took {taken:.2f} s" if taken > LONGEST_S else "") or ", ".join(seen)
        if problem:
            problems.append(f"{name}: {problem}: {content[:2000]!r}" if len(problems) < 20 else name)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    left = sorted(entry.name for entry in Path(folder).iterdir())
    print(json.dumps({"problems": problems, "ends": ends, "slowest": slowest, "memory": memory / 1024, "left": left}))
