"""Load and check case files. A case contains a scene, the duration and the samples of a run, and expectations."""

import re
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import date
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from itertools import accumulate
from pathlib import Path as FilePath
from typing import Any

from pydantic import ValidationError

from bodycheck.adapters.method import Method, current
from bodycheck.casefile import contradictions, grammar
from bodycheck.casefile.axes import AXES
from bodycheck.casefile.content import Case as Case
from bodycheck.casefile.content import check_case as check_case
from bodycheck.casefile.ensemble import build_ensemble
from bodycheck.casefile.expectation import OK, ORDER, Expectation, Limit
from bodycheck.casefile.finding import SUFFIX
from bodycheck.casefile.formats import AnyCaseTable, explain, is_misleading, key_text, whole_table
from bodycheck.casefile.mechanisms import faults
from bodycheck.casefile.mechanisms.building import build_mechanism
from bodycheck.casefile.mechanisms.grammar import MechanismTable
from bodycheck.casefile.mechanisms.model import Expanded, expanded, with_model, with_scene
from bodycheck.casefile.mechanisms.signal_files import with_signals
from bodycheck.casefile.mechanisms.stored import loads, parted, text_of_file
from bodycheck.casefile.raw_values import quote
from bodycheck.casefile.robot_notes import Ignored
from bodycheck.casefile.scenes import Inconsistent, build_scene
from bodycheck.casefile.sensors.building import build_sensors, limits_of, sensor_faults
from bodycheck.casefile.toml_positions import Path, Position, positions
from bodycheck.errors import BadInput
from bodycheck.figures.columns import LIMITED
from bodycheck.files import reading
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.suggestion import did_you_mean

#: Limits of a case file's size, of the parts of a dotted key and of the digits of a number.
MAX_FILE_BYTES = 1 << 18
MAX_KEY_PARTS = 16
MAX_DIGITS = 500
#: The mark that some editors write at the beginning of a file.
BYTE_ORDER_MARK = "\ufeff"
#: The largest number of reported faults, and the longest message of the TOML parser (characters).
MAX_FAULTS = 100
MAX_MESSAGE_LENGTH = 200

#: Allowed deviation from an order that is given as one number: it is measured at three time steps, not in the limit.
ORDER_TOLERANCE = 0.25


@dataclass(frozen=True)
class Fault:
    """One fault of a case file: its position, the value that was read, and what is allowed.

    ignore: the word of `[model] ignore` without which a robot's file is refused; None for all other faults.
    """

    file: str
    message: str
    position: Position | None = None
    key: str = ""
    ignore: Ignored | None = None

    def __str__(self) -> str:
        where = f":{self.position.line}:{self.position.column}" if self.position else ""
        return f"{self.file}{where}: " + (f"{self.key}: " if self.key else "") + self.message


class CaseFaults(BadInput):
    """All faults of one or more case files, one per line."""

    def __init__(self, faults: tuple[Fault, ...]) -> None:
        super().__init__("\n".join(map(str, faults)))
        self.faults = faults


@cache
def _shipped_files() -> dict[str, Traversable]:
    """Return the files of the cases that come with the package, from its folder of cases and the folders there, by name."""
    folder = resources.files("bodycheck.cases")
    below = [entry for entry in folder.iterdir() if entry.is_dir()]
    files = [file for parent in (folder, *below) for file in parent.iterdir() if file.name.endswith(SUFFIX)]
    return {file.name.removesuffix(SUFFIX): file for file in sorted(files, key=lambda file: file.name)}


@cache
def shipped() -> tuple[str, ...]:
    """Return the names of the cases that come with the package."""
    return tuple(sorted(_shipped_files()))


def shipped_file(name: str) -> FilePath:
    """Return the file of the case of this name that comes with the package."""
    return FilePath(str(_shipped_files()[name]))


def is_shipped(case: str | FilePath) -> bool:
    """Return whether this is the name of a shipped case, or the path of its file."""
    path = FilePath(case)
    shipped_file = _shipped_files().get(path.name.removesuffix(SUFFIX)) if path.name.endswith(SUFFIX) else None
    return str(case) in shipped() or (shipped_file is not None and path.resolve() == FilePath(str(shipped_file)).resolve())


def load(case: str | FilePath, packages: Sequence[FilePath] = ()) -> Case:
    """Load a case, given the name of a shipped case or the path of a case file.

    packages: folders in which a robot model of the case may name files, beside the folder of the case and those below it.

    Raises `CaseFaults` with every fault of the file; a file that cannot be read has one fault. Raises `TypeError` for anything
    that is neither a text nor a path.
    """
    if not isinstance(case, str | FilePath):
        raise TypeError(f"read {quote(case)} as the case; allowed: the name of a shipped case, or a path")
    if isinstance(case, str) and case in shipped():
        file = _shipped_files()[case]
        return loaded(file.read_text("utf-8"), str(file), FilePath(str(file)).parent)
    return loaded(_read(FilePath(case)), str(case), FilePath(case).parent, packages)


def loaded(text: str, file: str, folder: FilePath, packages: Sequence[FilePath] = (), follow: bool = False) -> Case:
    """Return the case in the text of a case file, whose model may be a file in a folder. Raises `CaseFaults`.

    Parameters
    ----------
    text
        The text.
    file
        The name of the case file in the faults.
    folder, packages
        The folder of the case file, and further folders in which the model may name files.
    follow
        Whether the model may be a symbolic link, because the user named it.
    """
    document = _document(text, file)
    with_values, further = with_signals(text, document, folder)
    whole, refused = with_model(with_values, document, folder, packages, follow)
    if whole != text:
        document = _document(whole, file)
    return _parsed(document, whole, file, contradictions.uncheckable(document), (*further, *refused))


def parse(text: str, file: str) -> Case:
    """Return the case in the text of a case file; `file` is its name in the faults. Raises `CaseFaults`.

    The file of a model is not read: the text of a loaded case contains the text of its model.
    """
    document = _document(text, file)
    return _parsed(document, text, file, contradictions.uncheckable(document))


def parse_stored(text: str, file: str) -> Case:
    """Return the case in a text stored by bodycheck, perhaps by an earlier version that spelled methods differently.

    Expectations that cannot be checked here are allowed. Raises `CaseFaults`.
    """
    document = _document(text, file)
    expectations = document.get("expect")
    for expectation in expectations if isinstance(expectations, list) else []:
        if isinstance(expectation, dict) and isinstance(spelling := expectation.get("integrator"), str):
            expectation["integrator"] = current(spelling)
    return _parsed(document, text, file)


def _parsed(
    document: dict[str, Any],
    text: str,
    file: str,
    further: Iterable[tuple[Path, str]] = (),
    refused: Sequence[tuple[Path, str]] = (),
) -> Case:
    """Return the case of a document. Raises `CaseFaults` with the faults of the format and the faults in `further`.

    refused: why the model of the case was not read.
    """
    expansion = expanded(document, refused)
    whole = whole_table(expansion.document)
    between_keys = faults.contradictions if whole is MechanismTable else contradictions.contradictions
    between = (*between_keys(expansion.document), *sensor_faults(expansion.document))
    errors, unreported = [*between, *expansion.faults, *further], 0
    try:
        table = whole.model_validate(expansion.document)
    except ValidationError as error:
        records = [record for record in error.errors(include_url=False) if not is_misleading(record)]
        errors += [explain(record, expansion.document) for record in records[:MAX_FAULTS]]
        unreported += len(records[MAX_FAULTS:])
    if not errors:
        try:
            if not isinstance(table, MechanismTable):
                return _case(table, build_scene(table), expansion, text)
            return _case(table, replace(build_mechanism(table), stops_until=expansion.stops_until), expansion, text)
        except Inconsistent as error:
            errors += error.faults
    unreported += len(errors[MAX_FAULTS:])
    errors = list(dict.fromkeys(expansion.in_the_file(path, message) for path, message in errors[:MAX_FAULTS]))
    places = positions(text_of_file(text), [path for path, _ in errors])
    located = [_locate(file, places, document, path, message) for path, message in errors]
    located.sort(key=lambda fault: fault.position or Position(0, 0))
    raise CaseFaults((*located, *([Fault(file, f"{unreported} more faults")] if unreported else [])))


#: A pattern for a part of a dotted key with the dot after it.
DOTTED_KEY_PART = r"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+)"""

#: Patterns that make tomllib slow or exceed its recursion limit, with the error message for each.
SLOW_PATTERNS = {
    f"{DOTTED_KEY_PART}{{{MAX_KEY_PARTS}}}": f"a key of more than {MAX_KEY_PARTS} parts",
    rf"(?<![\w-])[+-]?(?:0[xob]|[0-9])[0-9A-Fa-f_.]{{{MAX_DIGITS}}}": f"a number of more than {MAX_DIGITS} digits",
}


def _document(text: str, file: str) -> dict[str, Any]:
    """Return the raw document of a text, with what was read of its model. Raises `CaseFaults` if it is not TOML."""
    whole, (text, _) = text, parted(text)
    for pattern, message in SLOW_PATTERNS.items():
        if (match := re.search(pattern, text)) is not None:
            raise CaseFaults((Fault(file, message, _position(text, match.start())),))
    try:
        document = loads(whole)
    except RecursionError as error:
        raise CaseFaults((Fault(file, "nested too deeply", _position(text, _deepest_offset(text))),)) from error
    except tomllib.TOMLDecodeError as error:
        raise CaseFaults((_syntax_fault(file, text, str(error)),)) from error
    return document


def _position(text: str, offset: int) -> Position:
    return Position(text.count("\n", 0, offset) + 1, offset - text.rfind("\n", 0, offset))


def _deepest_offset(text: str) -> int:
    """Return the offset at which the largest number of brackets is open."""
    depths = accumulate((character in "[{") - (character in "]}") for character in text)
    return max(enumerate(depths), key=lambda entry: entry[1])[0]


def _read(path: FilePath) -> str:
    try:
        if not path.exists():
            raise CaseFaults((Fault(str(path), f"there is no such file, and no shipped case of this name{_meant(path)}"),))
        text = reading.content(path, MAX_FILE_BYTES, follow=True).decode("utf-8")
        if text.startswith(BYTE_ORDER_MARK):
            wrong = "begins with a byte order mark (BOM), which TOML does not allow; save it as UTF-8 without one"
            raise CaseFaults((Fault(str(path), wrong, Position(1, 1)),))
        return text
    except reading.Refused as error:
        raise CaseFaults((Fault(str(path), error.reason),)) from error
    except UnicodeDecodeError as error:
        read = error.object[: error.start].decode("utf-8")
        wrong = f"cannot be read: it is not UTF-8: {error.reason}"
        raise CaseFaults((Fault(str(path), wrong, _position(read, len(read))),)) from error
    except (OSError, ValueError) as error:
        raise CaseFaults((Fault(str(path), f"cannot be read: {error}"),)) from error


def _meant(path: FilePath) -> str:
    """Return the end of the message about a missing file: the file or the shipped case that the user may mean."""
    file = path.with_name(path.name + SUFFIX)
    if file.exists():
        return f"; did you mean {str(file)!r}?"
    return did_you_mean(str(path), shipped()) or "; `bodycheck cases` lists the shipped cases"


def _syntax_fault(file: str, text: str, message: str) -> Fault:
    """Return the fault for a message of tomllib, which ends in "(at line 1, column 2)" or "(at end of document)"."""
    what, _, where = message.rpartition(" (at ")
    numbers = [int(number) for number in re.findall(r"\d+", where)]
    position = Position(*numbers) if len(numbers) == 2 else _position(text, len(text.rstrip("\n")))
    return Fault(file, f"not TOML: {(what or message)[:MAX_MESSAGE_LENGTH]}", position)


def _locate(file: str, places: dict[Path, Position], document: dict[str, Any], path: Path, message: str) -> Fault:
    """Return a fault at the position of its key, or of the innermost table around a missing key.

    Parameters
    ----------
    file
        The name of the file.
    places
        The positions of paths in the file.
    document
        The parsed file.
    path
        The path of the key.
    message
        What is wrong, or what is allowed.
    """
    located = path
    while located not in places:
        located = located[:-1]
    key = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{key_text(part)}" for part in path).removeprefix(".")
    value: Any = document
    for part in path:
        try:
            value = value[part]
        except (KeyError, IndexError, TypeError):
            return Fault(file, message, places[located], key)
    if isinstance(value, dict) or (isinstance(value, list) and value and isinstance(value[0], dict)):
        return Fault(file, message, places[located], key)
    return Fault(file, f"read {quote(value)}; {message}", places[located], key)


def _case(table: AnyCaseTable, scene: AnyScene, expansion: Expanded, text: str) -> Case:
    extremes = tuple((name, values) for name, values in table.extremes if values is not None)
    if faults := [(("extremes", name), fault) for name, _ in extremes if (fault := AXES[name].lacking(scene))]:
        raise Inconsistent(*faults)
    sensors = build_sensors(table.sensors, scene)
    return Case(
        name=table.name,
        title=table.title,
        source=table.source,
        tags=table.tags,
        scene=scene,
        duration=table.run.duration,
        samples=table.run.samples,
        expectations=tuple(_expectation(expect, sensors) for expect in table.expect),
        extremes=extremes,
        text=text,
        ensemble=build_ensemble(table.ensemble, expansion.document) if table.ensemble else None,
        timestep=expansion.timestep,
        robot=None if expansion.notes is None else with_scene(expansion.notes, scene),
        sensors=sensors,
    )


def _expectation(table: grammar.ExpectTable, sensors: Sequence[Sensor]) -> Expectation:
    figures = [_limit(name, limit) for name in LIMITED if (limit := getattr(table, name)) is not None]
    limits = (*figures, *limits_of(table.sensors or {}, sensors))
    until = date.fromisoformat(table.until) if table.until is not None else None
    status = table.status or OK
    method = Method.parse(table.integrator, table.timestep)
    return Expectation(table.engine, method, limits, status, table.known or "", until, table.version or "")


def _limit(name: str, allowed: float | grammar.RangeTable) -> Limit:
    if isinstance(allowed, grammar.RangeTable):
        return Limit(name, allowed.at_least, allowed.at_most)
    if name == ORDER:
        return Limit(name, allowed - ORDER_TOLERANCE, allowed + ORDER_TOLERANCE)
    return Limit(name, None, allowed)
