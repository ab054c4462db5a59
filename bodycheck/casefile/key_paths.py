"""Key paths: the numbers and vectors of a case file that can be drawn, such as `body.mass` or `initial.velocity.2`.

Bodies and joints of a mechanism are given by their names, as in `joints.pin.damping`, or counted from 0, as in
`joints.1.damping`; controllers are given by the names of their joints, as in `controllers.pin.kp`. Names that are numbers or
have special characters are quoted, as in `joints."8".damping`.

The key paths follow from the content of the file and from the grammar of the tables that determine the motion: a new key of
such a table can be drawn at once.
"""

import re
import tomllib
import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import TypeAdapter, ValidationError

from bodycheck.casefile import grammar
from bodycheck.casefile.distributions import Key, Sign, name_in_path, rivals
from bodycheck.casefile.formats import is_mechanism, table_at
from bodycheck.casefile.mechanisms.model import standalone
from bodycheck.casefile.raw_values import mapping
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import Table
from bodycheck.suggestion import did_you_mean

#: The tables whose numbers determine the motion, of one body and of mechanisms, and the tables that are arrays of tables.
MOVING = ("body", "initial", "scene", "run")
OF_MECHANISMS = ("bodies", "joints", "loops", "controllers", "scene", "run")
ARRAYS = ("bodies", "joints", "loops", "controllers")

#: The key of the initial attitude as a quaternion, which the distribution `attitude` draws.
ATTITUDE = "initial.quaternion"


#: Default values of vectors that a file may leave out, by their names; the defaults of other keys are in the grammar.
DEFAULTS: dict[str, tuple[float, ...]] = {
    "position": (0.0, 0.0, 0.0),
    "center_of_mass": (0.0, 0.0, 0.0),
    "euler_zxz": (0.0, 0.0, 0.0),
    "quaternion": (1.0, 0.0, 0.0, 0.0),
    "euler_rates": (0.0, 0.0, 0.0),
    "angular_velocity": (0.0, 0.0, 0.0),
    "velocity": (0.0, 0.0, 0.0),
}

#: Names of keys that can be drawn even if the file leaves them out and the grammar has no default for them.
OPTIONAL = frozenset({*DEFAULTS, "inertia"})

#: A number that counts the items of an array, from 0.
INDEX = re.compile(r"0|[1-9][0-9]{0,5}")

#: The arrays of tables with names, and the key of each that has the name.
NAMES = {"bodies": "name", "joints": "name", "controllers": "joint"}

#: The beginning of the path of a key of such a table that is given by its index, or by its name in quotes.
PART = re.compile(r"""(?P<array>bodies|joints|controllers)\.(?P<part>0|[1-9][0-9]{0,5}|"(?:[^"\\]|\\.)*"|'[^']*')(?=\.)""")

#: The most keys that a message lists.
MAX_LISTED = 30


class Unknown(Exception):
    """Raised for a path without a number or vector that can be drawn; the text says why, or lists allowed paths."""


def keys(document: Mapping[str, Any]) -> dict[str, Key]:
    """Return the keys of all numbers, vectors and tensors of a document, present or with default values, by their texts.

    The document may have faults; a body of unknown shape has no keys.
    """
    document, by_text = standalone(document), dict[str, Key]()
    for path, table in _moving(document):
        content = mapping(value_at(document, path))
        keys_of_table = {key.text: key for key in _of_table(table, path, content)} if table is not None else {}
        for text in _that_follow(path, content):
            keys_of_table.pop(text, None)
        by_text |= {key.text: key for key in (_named(key, content) for key in keys_of_table.values())}
    return by_text


def _moving(document: Mapping[str, Any]) -> list[tuple[Path, type[Table] | None]]:
    """Return the paths of the tables whose numbers determine the motion, each with its grammar (None if unknown)."""
    if not is_mechanism(document):
        return [((name,), table_at((name,), document)) for name in MOVING]
    paths: list[Path] = []
    for name in OF_MECHANISMS:
        tables = document.get(name)
        paths += [(name, index) for index in range(len(tables))] if isinstance(tables, list) else [(name,)]
    return [(path, table_at(path, document)) for path in paths]


def is_complete(document: Mapping[str, Any]) -> bool:
    """Return whether the grammar of all tables whose numbers determine the motion is known, so that `keys` is complete."""
    return all(table is not None for path, table in _moving(document) if path == ("body",) or present(document, path))


def _that_follow(path: Path, content: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the texts of the keys of a body's table that follow from its particles or parts; empty if it has none."""
    is_composed = path[0] in ("body", "bodies") and ("particles" in content or "parts" in content)
    return tuple(".".join(map(str, (*path, key))) for key in ("mass", "inertia", "center_of_mass")) if is_composed else ()


def _named(key: Key, content: Mapping[str, Any]) -> Key:
    """Return a key of a table with the name of the body, or of the joint, instead of its number."""
    name = content.get(NAMES.get(str(key.whole[0]), ""))
    if len(key.whole) < 3 or not isinstance(name, str):
        return key
    return replace(key, named=(key.whole[0], name, *key.whole[2:]))


def find(text: str, document: Mapping[str, Any], known: Mapping[str, Key] | None = None) -> Key:
    """Return the key of a path such as "initial.velocity" or "initial.velocity.2".

    Parameters
    ----------
    text
        The path.
    document
        The document of the case file, which may have faults.
    known
        The result of `keys` for the document, if it is already computed.

    Raises
    ------
    Unknown
        There is no such number or vector, or it cannot be drawn. The text says why, or what can be drawn.
    """
    document = standalone(document)
    known, text = keys(document) if known is None else known, _with_name(text, document)
    if (key := known.get(text)) is not None:
        if len(key.shape) > 1:
            raise Unknown(f"is a tensor, which is drawn by its components, such as {text}.0.0 or {text}.0.1")
        return key
    parts = text.split(".")
    for length in (1, 2):
        whole = known.get(".".join(parts[:-length]))
        if whole is not None and whole.shape and all(map(INDEX.fullmatch, parts[-length:])):
            return _component(whole, tuple(map(int, parts[-length:])), document)
    raise Unknown(_advice(text, known, document))


def _with_name(text: str, document: Mapping[str, Any]) -> str:
    """Return a path with the name of a body or joint, as `Key.text` has it, instead of its index or its name in any quotes."""
    if (match := PART.match(text)) is None:
        return text
    array, part, key = match["array"], match["part"], text[match.end() :]
    if INDEX.fullmatch(part):
        name = mapping(value_at(document, (array, int(part)))).get(NAMES[array])
    else:
        try:
            (name,) = tomllib.loads(f"{part} = 0")
        except (ValueError, RecursionError):
            return text
    return f"{array}.{name_in_path(name)}{key}" if isinstance(name, str) else text


def _component(whole: Key, indices: tuple[int, ...], document: Mapping[str, Any]) -> Key:
    """Return the key of a component of a vector or tensor. Raises `Unknown` if there is none."""
    if len(indices) != len(whole.shape) or any(index >= size for index, size in zip(indices, whole.shape, strict=True)):
        last = ".".join(str(size - 1) for size in whole.shape)
        raise Unknown(
            f"there is no such component; allowed: {whole.text}.{'.'.join('0' for _ in whole.shape)} to {whole.text}.{last}"
        )
    if list(indices) != sorted(indices):
        raise Unknown(
            f"is below the diagonal of a symmetric tensor; allowed: {whole.text}.{indices[1]}.{indices[0]}, which means both"
        )
    if base(document, whole) is None:
        raise Unknown(f"the file gives no {whole.text}; give it, or draw the whole vector")
    for rival in rivals(whole.whole):
        if present(document, rival):
            rival_text = whole.text.rpartition(".")[0] + f".{rival[-1]}"
            raise Unknown(f"the file gives {rival_text} instead; draw components of that, or the whole vector {whole.text}")
    return replace(whole, place=indices)


def present(document: Mapping[str, Any], path: Path) -> bool:
    """Return whether a document has a value at a path."""
    return value_at(document, path) is not None


def value_at(document: Mapping[str, Any], path: Path) -> Any:
    """Return the value at a path of a document; None if there is none."""
    value: Any = document
    for part in path:
        try:
            value = value[part]
        except (KeyError, IndexError, TypeError):
            return None
    return value


def base(document: Mapping[str, Any], key: Key) -> Any:
    """Return the value of a number or array in a document, or its default; None if it has neither."""
    if (value := value_at(document, key.whole)) is not None:
        return value
    default = DEFAULTS.get(str(key.whole[-1]))
    if default is None or not key.shape:
        return None
    return default if len(default) == key.shape[0] else (0.0,) * key.shape[0]


def _advice(text: str, known: Mapping[str, Key], document: Mapping[str, Any]) -> str:
    """Return a sentence on why a path has no key, with the allowed paths."""
    parts = text.split(".")
    for length in range(2, len(parts)):
        path = tuple(parts[:length])
        if path in grammar.TABLES and path[0] in MOVING and not present(document, path):
            return f"the file has no table [{'.'.join(path)}]; give it, so that a number in it can be drawn"
    around = text.rpartition(".")[0]
    listed = [key for key in known if not any(map(str.isdecimal, key.split("."))) or key.rpartition(".")[0] == around]
    vectors = [key for key in ("initial.velocity", *listed) if key in known and known[key].shape == (3,)]
    return (
        f"there is no number or vector of this path; allowed: {', '.join(listed[:MAX_LISTED])}"
        f"{f', or a component of a vector, such as {vectors[0]}.2' if vectors else ''}{did_you_mean(text, listed)}"
    )


@dataclass(frozen=True)
class _Form:
    """A form of a value in the grammar of a table: numbers of a shape and sign, a table, or an array of tables."""

    shape: tuple[int, ...] = ()
    sign: Sign = "any"
    table: type[Table] | None = None
    repeated: bool = False


def _of_table(table: type[Table], path: Path, content: Mapping[str, Any]) -> Iterator[Key]:
    """Yield the keys of the table at `path`, from its grammar and its content in a document."""
    for name, forms in _forms(table).items():
        value = content.get(name)
        if value is None and table.model_fields[name].default is None and name not in OPTIONAL:
            continue
        form = next((form for form in forms if _fits_value(form, value)), forms[0])
        if form.table is None:
            yield Key((*path, name), form.shape, sign=form.sign)
        elif form.repeated:
            for index, item in enumerate(value if isinstance(value, list) else ()):
                yield from _of_table(form.table, (*path, name, index), mapping(item))
        elif isinstance(value, dict) or (value is None and table.model_fields[name].default_factory):
            yield from _of_table(form.table, (*path, name), mapping(value))


def _fits_value(form: _Form, value: Any) -> bool:
    """Return whether a form is that of a value: a table has known keys alone, and numbers have the same shape."""
    if isinstance(value, dict):
        return form.table is not None and value.keys() <= form.table.model_fields.keys()
    return len(form.shape) == _depth(value)


def _depth(value: Any) -> int:
    """Return the depth of nested arrays down to the first number of a value: 2 for a tensor, which is the deepest."""
    if not (isinstance(value, list) and value):
        return 0
    return 2 if isinstance(value[0], list) else 1


@cache
def _forms(table: type[Table]) -> dict[str, tuple[_Form, ...]]:
    """Return the forms of the keys of a table that have numbers in them."""
    patterns = {}
    for name, field in table.model_fields.items():
        kind = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
        if forms := tuple(_forms_of(kind)):
            patterns[name] = forms
    return patterns


def _forms_of(kind: Any) -> Iterator[_Form]:
    """Yield the forms of an annotation of the grammar; none for texts and whole numbers."""
    form, parts = get_origin(kind), get_args(kind)
    if kind is float or (form is Annotated and parts[0] is float):
        yield _Form(sign=_sign(kind))
    elif form is Annotated:
        yield from _forms_of(parts[0])
    elif form in (Union, types.UnionType):
        for part in parts:
            yield from _forms_of(part)
    elif isinstance(kind, type) and issubclass(kind, Table):
        yield _Form(table=kind)
    elif form is tuple and parts[-1] is Ellipsis:
        yield from (replace(inner, repeated=True) for inner in _forms_of(parts[0]) if inner.table is not None)
    elif form is tuple:
        for inner in _forms_of(parts[0]):
            yield replace(inner, shape=(len(parts), *inner.shape))


def _sign(kind: Any) -> Sign:
    """Return the sign of the numbers that an annotation of the grammar allows."""
    if _fits(kind, -1.0):
        return "any"
    return "not negative" if _fits(kind, 0.0) else "positive"


def _fits(kind: Any, value: float) -> bool:
    try:
        TypeAdapter(kind).validate_python(value)
    except ValidationError:
        return False
    return True
