"""Read and check the records of claims, and write their sentences."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

from packaging.version import Version
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from bodycheck.adapters import registry
from bodycheck.casefile import toml_positions
from bodycheck.errors import BadInput

#: The folder with a folder for each engine.
CLAIMS = Path(__file__).parent

#: Most lines of a script.
MOST_LINES = 30

#: The name of the table that a command prints on the terminal in Markdown, in place of the name of a file.
PRINTED = "stdout"

#: A place for the number of a value in a sentence.
PLACE = re.compile(r"\{(\w+)\}")


def _https(address: str) -> str:
    if not address.startswith("https://"):
        raise ValueError("allowed: an address that begins with https://")
    return address


def _version(text: str) -> str:
    Version(text)  # its error, a ValueError, quotes the text
    return text


def _engine(name: str) -> str:
    if name not in registry.names():
        raise ValueError(f"allowed: {', '.join(registry.names())}")
    return name


Text = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1)]
Release = Annotated[str, AfterValidator(_version)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Value(_Table):
    """A number of a claim, or a word such as a verdict.

    Attributes
    ----------
    value, unit
        The value; the unit is empty for words and pure numbers.
    shown
        The format of the number in the sentence, such as ".2g".
    tolerance
        The largest deviation of a measured number, relative to `value`; absolute if `value` is 0.
    releases
        The releases that give this value; empty for all releases of the record.
    table, row, column
        The table that the command writes, or `PRINTED`, the contents of some columns in the row that is meant, and the column
        that has the value. They are absent if only the script gives the value.
    script
        Whether the script prints the value. Only what bodycheck itself adds, such as the bound of the truth, is not printed.
    """

    value: Annotated[float, Field(allow_inf_nan=False)] | Text
    unit: str = ""
    shown: str = ""
    tolerance: Annotated[float, Field(ge=0, lt=0.5)] | None = None
    releases: tuple[Release, ...] = Field((), strict=False)
    table: Text | None = None
    row: Mapping[str, str | float] = {}
    column: Text | None = None
    script: bool = True

    @property
    def text(self) -> str:
        """Return the value as it stands in a sentence; exponents are written without padding."""
        return re.sub(r"e([+-])0*(\d)", lambda e: f"e{e[1].strip('+')}{e[2]}", format(self.value, self.shown))

    def in_release(self, release: str) -> bool:
        """Return whether a release gives this value."""
        return not self.releases or release in self.releases


class Documentation(_Table):
    """What the documentation of an engine, its changelog or a thread says of the subject, in a few quoted words."""

    address: Annotated[str, AfterValidator(_https)]
    says: Text


class Cause(_Table):
    """The cause of what is claimed, the experiment that shows it, and at least two candidates that the experiment rejects."""

    text: Text
    experiment: Text
    against: Annotated[tuple[Text, ...], Field(min_length=2, strict=False)]


class Claim(_Table):
    """A record; CONTRIBUTING.md describes its keys.

    Attributes
    ----------
    path
        The path of its file.
    sentence, wordings
        The sentence in Markdown, with the name of a value in braces for each number, and further wordings for other pages.
        Links lead from the folder of the checkout.
    kind
        A fault of the engine, a documented choice of its authors, or a default, which users can change.
    """

    path: Path
    sentence: Text
    wordings: Mapping[str, Text] = {}
    engine: Annotated[str, AfterValidator(_engine)]
    releases: Annotated[tuple[Release, ...], Field(min_length=1, strict=False)]
    kind: Literal["fault", "choice", "default"]
    command: Annotated[str, StringConstraints(pattern=r"^(bodycheck|python docs/\w+\.py)( |$)")]
    values: Annotated[Mapping[str, Value], Field(min_length=1)]
    documentation: tuple[Documentation, ...] = Field((), strict=False)
    cause: Cause | None = None

    @property
    def name(self) -> str:
        """Return the name of the claim, `ENGINE/NAME`."""
        return f"{self.path.parent.name}/{self.path.stem}"

    @property
    def script(self) -> Path:
        """Return the path of the script."""
        return self.path.with_suffix(".py")


def read(path: Path) -> Claim:
    """Return the claim in a file and check it together with its script. Raises `BadInput` for every fault."""
    text = path.read_text("utf-8")
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise BadInput(f"{path}: is not TOML: {error}") from error
    try:
        claim = Claim.model_validate({"path": path, **document})
    except ValidationError as error:
        raise BadInput("\n".join(_fault(path, text, one["loc"], one["msg"], one["input"]) for one in error.errors())) from error
    faults = [_fault(path, text, location, allowed, was) for location, allowed, was in _contradictions(claim)]
    if faults := [*faults, *_script_faults(claim)]:
        raise BadInput("\n".join(faults))
    return claim


@cache
def claims() -> Mapping[str, Claim]:
    """Return all claims by name, without the cases of their commands. Raises `BadInput` for a fault in a record or script."""
    paths = [path for path in sorted(CLAIMS.glob("*/*.toml")) if not path.name.endswith(".case.toml")]
    return {claim.name: claim for claim in map(read, paths)}


def sentence(claim: Claim, wording: str = "") -> str:
    """Return the sentence of a claim, or another wording of it, with its numbers. Raises `BadInput` for an unknown wording."""
    if wording and wording not in claim.wordings:
        raise BadInput(f"{claim.name}: has no wording {wording!r}; there are: {', '.join(claim.wordings) or 'none'}")
    template = claim.wordings[wording] if wording else claim.sentence
    return PLACE.sub(lambda place: claim.values[place[1]].text, template)


def _fault(path: Path, text: str, location: tuple[str | int, ...], allowed: str, read_value: Any) -> str:
    """Return one line about a fault: file, line, key, what is allowed and what was read."""
    keys = toml_positions.positions(text, [location])
    line = keys[max((known for known in keys if known == location[: len(known)]), key=len)].line
    return f"{path}:{line}: {'.'.join(map(str, location))}: {allowed}; read: {str(read_value)[:80]!r}"


def _contradictions(claim: Claim) -> Iterator[tuple[tuple[str | int, ...], str, Any]]:
    """Yield the contradictions between keys: the location of a key, what is allowed, and what was read."""
    if claim.engine != claim.path.parent.name:
        yield ("engine",), f"allowed: {claim.path.parent.name!r}, the folder of the file", claim.engine
    wordings = [(("wordings", name), text) for name, text in claim.wordings.items()]
    for location, template in ((("sentence",), claim.sentence), *wordings):
        for name in PLACE.findall(template):
            if name not in claim.values:
                yield location, f"allowed in braces: {', '.join(claim.values)}", name
    for name, value in claim.values.items():
        yield from ((("values", name, *key), allowed, was) for key, allowed, was in _contradictions_of_value(claim, value))
    if not any(value.script for value in claim.values.values()):
        yield ("values",), "at least one value must be printed by the script", "script = false everywhere"


def _contradictions_of_value(claim: Claim, value: Value) -> Iterator[tuple[tuple[str, ...], str, Any]]:
    numeric = isinstance(value.value, float)
    if numeric != (value.tolerance is not None):
        yield ("tolerance",), f"{'required for a number' if numeric else 'not allowed for a word'}", value.tolerance
    try:
        format(value.value, value.shown)
    except ValueError:
        yield ("shown",), "allowed: a format of Python, such as .2g", value.shown
    if numeric and not value.shown:
        yield ("shown",), "required for a number, such as .2g", value.shown
    if (value.table is None) != (value.column is None):
        yield ("column",), "allowed: table and column together", value.column
    if value.table is None and not value.script:
        yield ("script",), "a value has a table, or the script prints it", value.script
    for release in value.releases:
        if release not in claim.releases:
            yield ("releases",), f"allowed: {', '.join(claim.releases)}", release


def _script_faults(claim: Claim) -> Iterator[str]:
    """Yield the faults of a script: it is short, and imports the engine, NumPy and the standard library alone."""
    if not claim.script.is_file():
        yield f"{claim.script}: is missing: a claim has a script that shows it with the engine alone"
        return
    source = claim.script.read_text("utf-8")
    if (lines := len(source.splitlines())) > MOST_LINES:
        yield f"{claim.script}: has {lines} lines, allowed: {MOST_LINES}"
    allowed = {"numpy", *registry.installation(claim.engine).imported}
    for node in ast.walk(ast.parse(source)):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        for name in names:
            if (module := name.partition(".")[0]) not in allowed | sys.stdlib_module_names:
                yield f"{claim.script}: imports {module!r}, allowed: {', '.join(sorted(allowed))} and the standard library"
