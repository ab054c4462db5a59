"""The reference of case files, from the JSON Schema that `bodycheck schema` prints: every table and key of both formats.

A table of the schema is a section. Its heading says where the table stands in a case file, as TOML spells it.
"""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bodycheck.casefile.authoring import schema
from docs.extensions.markdown import code, prose, table

Schema = Mapping[str, Any]

#: Larger numbers are refused everywhere, which the page says once.
LARGEST = 1e100

UNIT = r"(?:kg|m|s|rad|N)(?:\^\d)?(?:[ /](?:kg|m|s|rad|N)(?:\^\d)?)*"

#: A unit at the end of a meaning, or units of which the kind of a joint or a figure chooses one.
UNITS = re.compile(rf"(?:^|, )({UNIT}(?: or {UNIT})*)(?:$|, (?=with inertia$))")

#: The tables at the top of both formats, with the headings of their parts of the page.
FORMATS = {"CaseTable": "Format 1: one body", "MechanismTable": "Format 2: bodies and joints"}


def page() -> str:
    """Return all tables of both formats, then those that both have in common, as Markdown."""
    grammar = json.loads(schema())
    defined = grammar["$defs"]
    places = {top: _places(defined, top) for top in FORMATS}
    common = [name for name in places["CaseTable"] if name in places["MechanismTable"]]
    parts = [
        f"A number is at most {LARGEST:g} in size, unless its limits say otherwise. Keys in bold are required; others may be "
        "left out. Rules between keys are in [the description of the format](../cases.md)."
    ]
    for top, heading in FORMATS.items():
        parts.append(f"## {heading}")
        for name, where in places[top].items():
            if name not in common:
                parts += _section(defined, name, where)
    parts.append("## Tables of both formats")
    for name in common:
        where = [*places["CaseTable"][name], *places["MechanismTable"][name]]
        parts += _section(defined, name, list(dict.fromkeys(where)))
    return "\n\n".join(parts)


def keys() -> Iterator[tuple[str, str]]:
    """Yield all keys, each with the name of its table in the schema."""
    for name, definition in json.loads(schema())["$defs"].items():
        for key in definition.get("properties", ()):
            yield name, key


def _places(defined: Schema, top: str) -> dict[str, list[str]]:
    """Return the paths at which each table can be reached from the top one, in the order of the keys; none for the top one."""
    found: dict[str, list[str]] = {top: []}
    waiting = [(top, "")]
    while waiting:
        name, before = waiting.pop(0)
        for key, value in defined[name].get("properties", {}).items():
            for inner, several in _tables(value):
                path = f"{before}{key}"
                spelling = f"[[{path}]]" if several else f"[{path}]"
                if inner not in found:
                    found[inner] = []
                    waiting.append((inner, f"{path}."))
                if spelling not in found[inner]:
                    found[inner].append(spelling)
    return found


def _tables(value: Schema, several: bool = False) -> Iterator[tuple[str, bool]]:
    """The tables that a key may have, and whether it has a list of them."""
    if "$ref" in value:
        yield value["$ref"].rpartition("/")[2], several
    for choice in value.get("oneOf", ()):
        yield from _tables(choice, several)
    if "items" in value:
        yield from _tables(value["items"], True)


def _section(defined: Schema, name: str, where: Sequence[str]) -> list[str]:
    definition = defined[name]
    rows = []
    for key, value in definition.get("properties", {}).items():
        meaning, unit = _apart(_description(defined, value))
        required = key in definition.get("required", ())
        default = "" if required or "default" not in value else code(json.dumps(value["default"]))
        rows.append((f"**`{key}`**" if required else code(key), _type(value), unit, default, prose(meaning)))
    return [
        f"({_anchor(name)})=\n### {_heading(definition, name, where)}",
        prose(definition.get("description", "")),
        table(("key", "value", "unit", "default", "meaning"), rows),
    ]


def _heading(definition: Schema, name: str, where: Sequence[str]) -> str:
    """Return the path of a table and the key that distinguishes it there, or its name in words if it has many paths."""
    fixed = {key: value["const"] for key, value in definition.get("properties", {}).items() if "const" in value}
    chosen = [f" with `{key} = {json.dumps(fixed[key])}`" for key in ("shape", "type", "distribution") if key in fixed]
    if not where:
        return "The file itself"
    if len(where) > 2:
        return _words(name)
    # The states of joints all have one place.
    kind = [f" ({_words(name).lower()})"] if name.endswith("Start") else []
    return "".join([" or ".join(map(code, where)), *chosen, *kind])


def _type(value: Schema) -> str:
    """Return the type of a key's value, with its limits."""
    if "$ref" in value:
        name = value["$ref"].rpartition("/")[2]
        return f"[{_words(name)}](#{_anchor(name)})"
    if "oneOf" in value:
        return " or ".join(_type(choice) for choice in value["oneOf"])
    if "const" in value:
        return code(json.dumps(value["const"]))
    if "enum" in value:
        return " or ".join(code(json.dumps(each)) for each in value["enum"])
    if value.get("type") == "array":
        return _list(value)
    if value.get("type") in ("number", "integer"):
        return f"{value['type']}{_limits(value)}"
    if "pattern" in value:
        return f"text of the form {code(value['pattern'])}"
    return {"string": "text", "boolean": "`true` or `false`"}.get(value.get("type", ""), "value")


def _list(value: Schema) -> str:
    least, most = value.get("minItems", 0), value.get("maxItems")
    items = _type(value["items"])
    if least == most:
        return f"{least} × {items}"
    return f"list of {items}" + (f" ({least} to {most})" if most is not None else "")


def _limits(value: Schema) -> str:
    low, above, high = value.get("minimum", -LARGEST), value.get("exclusiveMinimum"), value.get("maximum", LARGEST)
    if above is not None:
        return f" > {above:g}" + (f", at most {high:g}" if high < LARGEST else "")
    if high < LARGEST:
        return f" from {low:.17g} to {high:.17g}"
    return f" ≥ {low:g}" if low > -LARGEST else ""


def _apart(description: str) -> tuple[str, str]:
    """A meaning without the unit at the end of its first part, and the unit."""
    first, semicolon, rest = description.partition(";")
    match = UNITS.search(first)
    if match is None:
        return description, ""
    meaning = first[: match.start()] + first[match.end() :]
    return f"{meaning}{semicolon if meaning else ''}{rest}".strip(), match[1]


def _description(defined: Schema, value: Schema) -> str:
    """Return the description of a key, or of its table if the key itself has no description."""
    told = value.get("description", "")
    if not told and "$ref" in value:
        told = defined[value["$ref"].rpartition("/")[2]].get("description", "").rstrip(".")
        return f"{told[:1].lower()}{told[1:]}"
    return str(told)


def _words(name: str) -> str:
    words = re.sub(r"(?<!^)([A-Z])", r" \1", name.removesuffix("Table")).lower()
    return words.capitalize()


def _anchor(name: str) -> str:
    return f"case-{name.lower()}"
