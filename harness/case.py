"""A case: one data file, its scene, how long to look at it, and what must hold."""

import re
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from bodycheck import grammar
from bodycheck.errors import BadInput
from bodycheck.reference.friction import height_of
from bodycheck.reference.inertia import MassProperties, composite, particles, principal_axes, principal_moments, solid
from bodycheck.reference.kinematics import body_rates, euler_from_quaternion, normalise, quaternion_from_euler
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Plane, Scene, Shape, Sphere, State
from bodycheck.reference.trajectory import Array
from bodycheck.toml_positions import Path, Position, positions

SUFFIX = ".case.toml"
LARGEST_FILE = 1 << 20
LONGEST_QUOTE = 60

SLENDER = 1e-15
"""Least ratio of principal moments that particles or parts may have: less is rounding."""


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


class _Slender(Exception):
    """Particles or parts make a body that has no moment about one of its axes; the text is that of the fault."""


@dataclass(frozen=True)
class Expectation:
    """Upper limits that one method must keep; the names of the limits are those of the result columns."""

    engine: str
    integrator: str
    timestep: float
    limits: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Case:
    """A validated case. text: the file as it was read."""

    name: str
    title: str
    source: str
    tags: tuple[str, ...]
    scene: Scene
    duration: float
    samples: int
    expectations: tuple[Expectation, ...]
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
    try:
        document = tomllib.loads(text)
    except RecursionError as error:
        raise CaseFaults((Fault(file, "nested too deeply"),)) from error
    except tomllib.TOMLDecodeError as error:
        raise CaseFaults((_syntax_fault(file, text, str(error)),)) from error
    errors: list[tuple[Path, str]] = list(grammar.contradictions(document))
    try:
        table = grammar.CaseTable.model_validate(document)
    except ValidationError as error:
        errors += [_explain(record, document) for record in error.errors(include_url=False)]
    if not errors:
        try:
            return _case(table, text)
        except _Slender as error:
            errors.append((("body",), str(error)))
    places = positions(text)
    faults = [_locate(file, places, document, path, message) for path, message in errors]
    raise CaseFaults(tuple(sorted(faults, key=lambda fault: fault.position or Position(0, 0))))


def _read(path: FilePath) -> str:
    try:
        if not path.is_file():
            known = f"there is no such file, and no shipped case of this name; shipped: {', '.join(shipped())}"
            raise CaseFaults((Fault(str(path), known),))
        with path.open("rb") as stream:
            content = stream.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise CaseFaults((Fault(str(path), f"larger than {LARGEST_FILE} bytes, the most that a case file may have"),))
        return content.decode("utf-8")
    except (OSError, ValueError) as error:
        raise CaseFaults((Fault(str(path), f"cannot be read: {error}"),)) from error


def _syntax_fault(file: str, text: str, message: str) -> Fault:
    """A fault from tomllib's message, which ends in the place: "(at line 1, column 2)" or "(at end of document)"."""
    what, _, place = message.rpartition(" (at ")
    numbers = [int(number) for number in re.findall(r"\d+", place)]
    line, column = numbers if len(numbers) == 2 else (max(len(text.splitlines()), 1), 1)
    return Fault(file, f"not TOML: {what or message}", Position(line, column))


def _explain(record: Any, document: dict[str, Any]) -> tuple[Path, str]:
    """The path in the document and what is allowed there, from one of pydantic's error records."""
    path = tuple(record["loc"])
    if path[:1] == ("body",):
        # pydantic puts the members of its unions into the path
        path = ("body", *(key for key in path[1:] if key not in (*grammar.SHAPE_TABLES, "moments", "tensor")))
    kind = record["type"]
    if kind == "missing":
        return path, "is missing"
    if kind == "union_tag_not_found":
        return (*path, "shape"), f"is missing; allowed: {', '.join(grammar.SHAPE_TABLES)}"
    if kind == "union_tag_invalid":
        return (*path, "shape"), f"allowed: {', '.join(grammar.SHAPE_TABLES)}"
    if kind == "extra_forbidden" and (table := grammar.table_at(path[:-1], document)) is not None:
        return path, f"unknown key; allowed: {', '.join(table.model_fields)}"
    message = str(record["msg"])
    return path, message.removeprefix("Input ").removeprefix("Value error, ")


def _locate(file: str, places: dict[Path, Position], document: dict[str, Any], path: Path, message: str) -> Fault:
    """A fault at the place of its key, or of the nearest table around a key that is not there."""
    place = path
    while place not in places:
        place = place[:-1]
    key = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in path).removeprefix(".")
    value: Any = document
    for part in path:
        try:
            value = value[part]
        except (KeyError, IndexError, TypeError):
            return Fault(file, message, places[place], key)
    if isinstance(value, dict):
        return Fault(file, message, places[place], key)
    quote = repr(value)
    quote = quote if len(quote) <= LONGEST_QUOTE else quote[: LONGEST_QUOTE - 1] + "…"
    return Fault(file, f"read {quote}; {message}", places[place], key)


def _case(table: grammar.CaseTable, text: str) -> Case:
    body = _body(table.body)
    return Case(
        name=table.name,
        title=table.title,
        source=table.source,
        tags=table.tags,
        scene=Scene(
            body=body,
            initial=_state(table.initial, body, table.scene.plane is not None),
            gravity=table.scene.gravity,
            plane=Plane(**table.scene.plane.model_dump()) if table.scene.plane else None,
            drag=table.scene.drag.quadratic if table.scene.drag else 0.0,
        ),
        duration=table.run.duration,
        samples=table.run.samples,
        expectations=tuple(_expectation(expect) for expect in table.expect),
        text=text,
    )


def _body(table: grammar.AnyBody) -> Body:
    if isinstance(table, grammar.ShapelessTable) and table.inertia is None:
        made = _composed(table)
        moments, axes = principal_axes(made.inertia)
        if not min(moments) > SLENDER * max(moments):
            raise _Slender(f"its principal moments are {moments}; a body on a line, with none about it, cannot be followed")
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
    position = table.position or (0.0, 0.0, height_of(body.shape) if lying else 0.0)
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
    limits = tuple((name, limit) for name in grammar.LIMITS if (limit := getattr(table, name)) is not None)
    return Expectation(table.engine, table.integrator, table.timestep, limits)
