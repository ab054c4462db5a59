"""A case: one data file, its scene, how long to look at it, and what must hold."""

import re
import tomllib
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from datetime import date, time
from importlib import resources
from itertools import accumulate
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from bodycheck.adapters.method import Method, current
from bodycheck.casefile import grammar
from bodycheck.casefile.axes import AXES
from bodycheck.casefile.contradictions import contradictions
from bodycheck.casefile.expectation import OK, ORDER, Expectation, Limit
from bodycheck.casefile.toml_positions import Path, Position, positions
from bodycheck.errors import BadInput
from bodycheck.figures.columns import LIMITED
from bodycheck.reference.inertia import MassProperties, composite, particles, principal_axes, principal_moments, solid
from bodycheck.reference.kinematics import body_rates, euler_from_quaternion, normalise, quaternion_from_euler
from bodycheck.reference.planar import resting_height
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Plane, Scene, Shape, Sphere, State
from bodycheck.reference.trajectory import Array
from bodycheck.suggestion import did_you_mean

SUFFIX = ".case.toml"
LARGEST_FILE = 1 << 18
MOST_KEY_PARTS = 16
MOST_DIGITS = 500
MOST_FAULTS = 100
LONGEST_QUOTE = 60
LONGEST_MESSAGE = 200

#: An order that is expected as one number may differ by so much: it is read off three time steps, not at the limit.
ORDER_TOLERANCE = 0.25

#: Least ratio of principal moments that particles or parts may have: less is rounding.
SLENDER = 1e-15


@dataclass(frozen=True)
class Fault:
    """One thing wrong with a case file: where, what was read, what is allowed."""

    file: str
    message: str
    position: Position | None = None
    key: str = ""

    def __str__(self) -> str:
        place = f":{self.position.line}:{self.position.column}" if self.position else ""
        return f"{self.file}{place}: " + (f"{self.key}: " if self.key else "") + self.message


class CaseFaults(BadInput):
    """Everything wrong with one or more case files, one line a fault."""

    def __init__(self, faults: tuple[Fault, ...]) -> None:
        super().__init__("\n".join(map(str, faults)))
        self.faults = faults


class _Unfit(Exception):
    """The keys are allowed one by one, but what they make is not; faults: paths, and what is wrong there."""

    def __init__(self, *faults: tuple[Path, str]) -> None:
        super().__init__(*faults)
        self.faults = faults


@dataclass(frozen=True)
class Case:
    """A validated case. extremes: axes by name, with the values to be tried. text: the file as it was read."""

    name: str
    title: str
    source: str
    tags: tuple[str, ...]
    scene: Scene
    duration: float
    samples: int
    expectations: tuple[Expectation, ...]
    extremes: tuple[tuple[str, tuple[float, ...]], ...]
    text: str

    @property
    def instants(self) -> Array:
        """The case's sampling times (samples,), s."""
        return np.linspace(0.0, self.duration, self.samples)


def shipped() -> tuple[str, ...]:
    """Names of the cases that come with the package."""
    entries = resources.files("bodycheck.cases").iterdir()
    return tuple(sorted(entry.name.removesuffix(SUFFIX) for entry in entries if entry.name.endswith(SUFFIX)))


def load(case: str | FilePath) -> Case:
    """A case by the name of a shipped one or by the path of a file.

    Raises `CaseFaults` with every fault of the file, a file that cannot be read being one.
    """
    if isinstance(case, str) and case in shipped():
        file = resources.files("bodycheck.cases") / (case + SUFFIX)
        return parse(file.read_text("utf-8"), str(file))
    return parse(_read(FilePath(case)), str(case))


def parse(text: str, file: str) -> Case:
    """The case in the text of a case file; `file` is what faults call it. Raises `CaseFaults`."""
    return _parsed(_document(text, file), text, file)


def parse_stored(text: str, file: str) -> Case:
    """The case in a text that bodycheck itself has stored, maybe an earlier version of it, which spelled methods otherwise.

    Raises `CaseFaults`.
    """
    document = _document(text, file)
    expectations = document.get("expect")
    for expectation in expectations if isinstance(expectations, list) else []:
        if isinstance(expectation, dict) and isinstance(spelling := expectation.get("integrator"), str):
            expectation["integrator"] = current(spelling)
    return _parsed(document, text, file)


def _parsed(document: dict[str, Any], text: str, file: str) -> Case:
    errors, untold = list(contradictions(document)), 0
    try:
        table = grammar.CaseTable.model_validate(document)
    except ValidationError as error:
        records = [record for record in error.errors(include_url=False) if not _misleads(record)]
        errors += [_explain(record, document) for record in records[:MOST_FAULTS]]
        untold += len(records[MOST_FAULTS:])
    if not errors:
        try:
            return _case(table, text)
        except _Unfit as error:
            errors += error.faults
    untold += len(errors[MOST_FAULTS:])
    places = positions(text, [path for path, _ in errors[:MOST_FAULTS]])
    faults = [_locate(file, places, document, path, message) for path, message in errors[:MOST_FAULTS]]
    faults.sort(key=lambda fault: fault.position or Position(0, 0))
    raise CaseFaults((*faults, *([Fault(file, f"{untold} more faults")] if untold else [])))


#: A part of a dotted key, up to its dot.
DOTTED = r"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+)"""

#: What takes a parser of TOML long, or more than it can, and what there is to say of it.
TOO_MUCH = {
    f"{DOTTED}{{{MOST_KEY_PARTS}}}": f"a key of more than {MOST_KEY_PARTS} parts",
    rf"(?<![\w-])(?:0[xob]|[0-9])[0-9A-Fa-f_.]{{{MOST_DIGITS}}}": f"a number of more than {MOST_DIGITS} digits",
}


def _document(text: str, file: str) -> dict[str, Any]:
    for much, message in TOO_MUCH.items():
        if (found := re.search(much, text)) is not None:
            raise CaseFaults((Fault(file, message, _position(text, found.start())),))
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise CaseFaults((Fault(file, "nested too deeply", _position(text, _deepest(text))),)) from error
    except tomllib.TOMLDecodeError as error:
        raise CaseFaults((_syntax_fault(file, text, str(error)),)) from error


def _position(text: str, offset: int) -> Position:
    return Position(text.count("\n", 0, offset) + 1, offset - text.rfind("\n", 0, offset))


def _deepest(text: str) -> int:
    """The offset at which most brackets are open."""
    depths = accumulate((character in "[{") - (character in "]}") for character in text)
    return max(enumerate(depths), key=lambda place: place[1])[0]


def _read(path: FilePath) -> str:
    try:
        if not path.is_file():
            known = f"there is no such file, and no shipped case of this name; shipped: {', '.join(shipped())}"
            raise CaseFaults((Fault(str(path), known + did_you_mean(str(path), shipped())),))
        with path.open("rb") as stream:
            content = stream.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise CaseFaults((Fault(str(path), f"larger than {LARGEST_FILE} bytes, the most that a case file may have"),))
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        read = error.object[: error.start].decode("utf-8")
        wrong = f"cannot be read: it is not UTF-8: {error.reason}"
        raise CaseFaults((Fault(str(path), wrong, _position(read, len(read))),)) from error
    except (OSError, ValueError) as error:
        raise CaseFaults((Fault(str(path), f"cannot be read: {error}"),)) from error


def _syntax_fault(file: str, text: str, message: str) -> Fault:
    """A fault from tomllib's message, which ends in the place: "(at line 1, column 2)" or "(at end of document)"."""
    what, _, place = message.rpartition(" (at ")
    numbers = [int(number) for number in re.findall(r"\d+", place)]
    position = Position(*numbers) if len(numbers) == 2 else _position(text, len(text.rstrip("\n")))
    return Fault(file, f"not TOML: {(what or message)[:LONGEST_MESSAGE]}", position)


#: What pydantic says in the words of Python, by the kind of its error.
IN_TOML = {
    **dict.fromkeys(("model_type", "model_attributes_type"), "should be a table"),
    "tuple_type": "should be an array",
    "string_type": "should be a string",
}


def _misleads(record: Any) -> bool:
    """Whether an error is that there are too few items, where there are enough and some have faults of their own."""
    if record["type"] != "too_short":
        return False
    least: int = record["ctx"]["min_length"]
    return len(record["input"]) >= least


def _explain(record: Any, document: dict[str, Any]) -> tuple[Path, str]:
    """The path in the document and what is allowed there, from one of pydantic's error records."""
    path = tuple(record["loc"])
    if path[:1] == ("body",):
        # pydantic puts the members of its unions into the path
        path = ("body", *(key for key in path[1:] if key not in (*grammar.SHAPE_TABLES, "moments", "tensor")))
    if path[:1] == ("expect",):
        path = tuple(key for key in path if key not in ("limit", "range"))
    kind = record["type"]
    if kind == "missing":
        return path, "is missing"
    if kind == "union_tag_not_found":
        return (*path, "shape"), f"is missing; allowed: {', '.join(grammar.SHAPE_TABLES)}"
    if kind == "union_tag_invalid":
        return (*path, "shape"), _allowed(record["input"].get("shape"), grammar.SHAPE_TABLES)
    if kind == "extra_forbidden" and (table := grammar.table_at(path[:-1], document)) is not None:
        return path, f"unknown key; {_allowed(path[-1], table.model_fields)}"
    message = IN_TOML.get(kind) or str(record["msg"]).removeprefix("Input ").removeprefix("Value error, ")
    if kind in ("too_long", "too_short"):
        side, bound = ("most", "max_length") if kind == "too_long" else ("least", "min_length")
        message = f"has {len(record['input'])} items; allowed: at {side} {record['ctx'][bound]}"
    if kind == "literal_error":
        message += _meant(record["input"], re.findall("'([^']*)'", record["ctx"]["expected"]))
    return path, message


def _allowed(word: Any, known: Collection[str]) -> str:
    return f"allowed: {', '.join(known)}{_meant(word, known)}"


def _meant(word: Any, known: Collection[str]) -> str:
    return did_you_mean(word, known) if isinstance(word, str) else ""


def _locate(file: str, places: dict[Path, Position], document: dict[str, Any], path: Path, message: str) -> Fault:
    """A fault at the place of its key, or of the nearest table around a key that is not there."""
    place = path
    while place not in places:
        place = place[:-1]
    key = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{_bare(part)}" for part in path).removeprefix(".")
    value: Any = document
    for part in path:
        try:
            value = value[part]
        except (KeyError, IndexError, TypeError):
            return Fault(file, message, places[place], key)
    if isinstance(value, dict):
        return Fault(file, message, places[place], key)
    return Fault(file, f"read {_quote(value)}; {message}", places[place], key)


def _bare(key: str) -> str:
    """A key as it may stand in a message: on one line."""
    return key if re.fullmatch(f"[A-Za-z0-9_-]{{1,{LONGEST_QUOTE}}}", key) else _quote(key)


def _quote(value: Any) -> str:
    """The beginning of a value, on one line."""
    try:
        quote = str(value) if isinstance(value, date | time) else repr(value)
    except RecursionError:
        return "what is nested deeply"
    return quote if len(quote) <= LONGEST_QUOTE else quote[: LONGEST_QUOTE - 1] + "…"


def _case(table: grammar.CaseTable, text: str) -> Case:
    body = _body(table.body)
    scene = Scene(
        body=body,
        initial=_state(table.initial, body, table.scene.plane is not None),
        gravity=table.scene.gravity,
        plane=Plane(**table.scene.plane.model_dump()) if table.scene.plane else None,
        drag=table.scene.drag.quadratic if table.scene.drag else 0.0,
    )
    extremes = tuple((name, values) for name, values in table.extremes if values is not None)
    if faults := [(("extremes", name), fault) for name, _ in extremes if (fault := AXES[name].missing(scene))]:
        raise _Unfit(*faults)
    return Case(
        name=table.name,
        title=table.title,
        source=table.source,
        tags=table.tags,
        scene=scene,
        duration=table.run.duration,
        samples=table.run.samples,
        expectations=tuple(_expectation(expect) for expect in table.expect),
        extremes=extremes,
        text=text,
    )


def _body(table: grammar.AnyBody) -> Body:
    if isinstance(table, grammar.ShapelessTable) and table.inertia is None:
        made = _composed(table)
        moments, axes = principal_axes(made.inertia)
        if not min(moments) > SLENDER * max(moments):
            slender = f"its principal moments are {moments}; a body on a line, with none about it, cannot be followed"
            raise _Unfit((("body",), slender))
        return Body(made.mass, moments, None, axes)
    shape = _shape(table)
    assert table.mass is not None  # the grammar requires it where it is not composed
    if table.inertia is None:
        assert shape is not None
        return Body(table.mass, principal_moments(shape, table.mass), shape)
    inertia = np.array(table.inertia)
    moments, axes = principal_axes(np.diag(inertia) if inertia.ndim == 1 else inertia)
    return Body(table.mass, moments, shape, axes)


def _shape(table: grammar.AnyBody | grammar.PartTable) -> Shape | None:
    match table:
        case grammar.BrickTable(semi_axes=semi_axes) | grammar.PartTable(shape="brick", semi_axes=tuple(semi_axes)):
            return Brick(semi_axes)
        case grammar.EllipsoidTable(semi_axes=semi_axes) | grammar.PartTable(shape="ellipsoid", semi_axes=tuple(semi_axes)):
            return Ellipsoid(semi_axes)
        case (
            grammar.CylinderTable(radius=radius, half_length=half_length)
            | grammar.PartTable(shape="cylinder", radius=float(radius), half_length=float(half_length))
        ):
            return Cylinder(radius, half_length)
        case grammar.SphereTable(radius=radius) | grammar.PartTable(shape="sphere", radius=float(radius)):
            return Sphere(radius)
        case _:
            return None


def _composed(table: grammar.ShapelessTable) -> MassProperties:
    if table.particles is not None:
        return particles([particle.mass for particle in table.particles], [particle.position for particle in table.particles])
    solids = [
        solid(shape, part.mass, part.position, _attitude(part).astype(float))
        for part in table.parts or ()
        if (shape := _shape(part)) is not None
    ]
    return composite(solids)


def _attitude(table: grammar.InitialTable | grammar.PartTable) -> NDArray[np.longdouble]:
    """A unit quaternion from either way of giving it, in the widest float."""
    if table.quaternion is not None:
        return normalise(np.array(table.quaternion, dtype=np.longdouble))
    return quaternion_from_euler(*_wide(table.euler_zxz or (0.0, 0.0, 0.0)))


def _state(table: grammar.InitialTable, body: Body, on_plane: bool) -> State:
    """The initial state, formed in the widest float so that its doubles are the nearest ones to what the file says.

    Where no position is given, a body with a flat face lies on the plane.
    """
    lying = on_plane and isinstance(body.shape, Brick | Cylinder)
    position = table.position or (0.0, 0.0, resting_height(body.shape) if lying else 0.0)
    rates = table.angular_velocity or (0.0, 0.0, 0.0)
    if table.euler_rates is not None:
        _, theta, psi = euler_from_quaternion(_attitude(table)) if table.quaternion else _wide(table.euler_zxz or (0, 0, 0))
        x, y, z = body_rates(theta, psi, *_wide(table.euler_rates)).tolist()
        rates = float(x), float(y), float(z)
    w, x, y, z = _attitude(table).astype(float).tolist()
    return State(position, (w, x, y, z), table.velocity, rates)


def _wide(values: Sequence[float]) -> Iterator[NDArray[np.longdouble]]:
    return (np.asarray(np.longdouble(value)) for value in values)


def _expectation(table: grammar.ExpectTable) -> Expectation:
    limits = tuple(_limit(name, limit) for name in LIMITED if (limit := getattr(table, name)) is not None)
    until = date.fromisoformat(table.until) if table.until is not None else None
    status = table.status or OK
    method = Method.parse(table.integrator, table.timestep)
    return Expectation(table.engine, method, limits, status, table.known or "", until)


def _limit(name: str, allowed: float | grammar.RangeTable) -> Limit:
    if isinstance(allowed, grammar.RangeTable):
        return Limit(name, allowed.at_least, allowed.at_most)
    if name == ORDER:
        return Limit(name, allowed - ORDER_TOLERANCE, allowed + ORDER_TOLERANCE)
    return Limit(name, None, allowed)
