"""Damage to results folders, studies and baselines, drawn by seed: as accidents make it, and as strangers would."""

import json
import os
import random
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from tests.support import journals

Chance = random.Random

#: Values that a stranger may write into JSON.
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1, 10**30, -(10**30), 1e308, 1e-320, float("nan"), float("inf"), -float("inf"), [], {}, [None]),
    *("", "x", "ok", "crashed", "nan", "../../outside/victim", "/etc/passwd", "..", "a/b", "a\0b", "\n", "\ud800", "\x1b[2J"),
    *("=1+1", "::error::x", "##[error]x", "<script>x</script>", "{{7*7}}", "%s%n", "x" * 100_000, "2020-13-45", "Euler:model="),
    *(
        [[[[[[1]]]]]],
        {"a": {"b": {"c": []}}},
        [1, 2, 3],
        [0.0, 0.0, 0.0],
        {"friction": -1.0},
        [float("nan")] * 3,
        "closed-form:x",
    ),
)

#: Cells that a stranger may write into a table.
CELLS = (
    "",
    "nan",
    "inf",
    "-inf",
    "1e400",
    "x",
    "-1",
    "0",
    "=1+1",
    '"',
    "a,b",
    "\0",
    "ok",
    "true",
    "9" * 400,
    "../..",
    "é\u202e",
)

#: Text instead of JSON.
LINES = ("", "{", "null", "3", "[]", '{"record": 1}', '{"record": "run"}', '{"record": "footer", "records": 0}', "[" * 10_000)


def damage_folder(chance: Chance, folder: Path, outside: Path) -> None:
    """Damage one or several files of a folder. Links lead to what is outside."""
    for _ in range(chance.choice([1, 1, 1, 2, 5])):
        files = sorted(path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
        if not files:
            return
        telling = [path for path in files if path.suffix == ".jsonl"] or files
        tables = [path for path in files if path.suffix in (".csv", ".parquet")] or files
        path = chance.choice([chance.choice(telling), chance.choice(tables), chance.choice(files)])
        damage_file(chance, path, outside)


def damage_file(chance: Chance, path: Path, outside: Path) -> None:
    """Damage a file, mostly as files of its kind may be damaged."""
    own = {".jsonl": damage_records, ".csv": damage_table, ".parquet": damage_columns}.get(path.suffix)
    if own is not None and chance.random() < 0.75:
        own(chance, path)
    else:
        chance.choice(ANY_FILE)(chance, path, outside)


def _cut(chance: Chance, path: Path, outside: Path) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: chance.choice([0, 1, chance.randint(0, len(content))])])


def _flip(chance: Chance, path: Path, outside: Path) -> None:
    content = bytearray(path.read_bytes())
    for _ in range(chance.choice([1, 3, 100]) if content else 0):
        content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
    path.write_bytes(content)


def _noise(chance: Chance, path: Path, outside: Path) -> None:
    path.write_bytes(chance.randbytes(chance.choice([1, 100, 10_000])))


def _folder(chance: Chance, path: Path, outside: Path) -> None:
    path.unlink()
    path.mkdir()


def _link(chance: Chance, path: Path, outside: Path) -> None:
    target = chance.choice([outside / "victim", outside / "none", Path("/dev/zero"), path, outside])
    if path.parent.name == "trajectories" and chance.random() < 0.5:
        path = path.parent
    path.unlink() if path.is_file() else shutil.rmtree(path)
    path.symlink_to(target)


def _pipe(chance: Chance, path: Path, outside: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def _another(chance: Chance, path: Path, outside: Path) -> None:
    others = sorted(other for other in path.parent.iterdir() if other.is_file() and other != path)
    if others:
        shutil.copyfile(chance.choice(others), path)


def _remove(chance: Chance, path: Path, outside: Path) -> None:
    path.unlink()


ANY_FILE = (_cut, _flip, _noise, _folder, _link, _pipe, _another, _remove)


def damage_records(chance: Chance, path: Path) -> None:
    """Change records of a journal, or its lines."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    for _ in range(chance.choice([1, 1, 2, 4]) if lines else 0):
        at = chance.randrange(len(lines))
        match chance.randrange(8):
            case 0:
                lines[at] = chance.choice(LINES)
            case 1:
                lines.insert(at, chance.choice([chance.choice(lines), chance.choice(LINES)]))
            case 2:
                del lines[at]
                if not lines:
                    break
            case _:
                lines[at] = damage_json(chance, lines[at])
    if chance.random() < 0.75:  # a stranger can compute the checksums
        lines = [_sealed(line) for line in lines]
    path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8", errors="surrogatepass")


def _sealed(line: str) -> str:
    """The line of a record with the checksum that belongs to it; any other line as it is."""
    try:
        record = json.loads(line)
    except (ValueError, RecursionError):
        return line
    if not isinstance(record, dict) or not record:
        return line
    record.pop("check", None)
    return journals.sealed(json.dumps(record)).removesuffix("\n")


def damage_json(chance: Chance, text: str) -> str:
    """Change one value of a JSON document, or its name."""
    try:
        document = json.loads(text)
    except (ValueError, RecursionError):
        return text
    places = list(_places(document))
    if not places:
        return text
    holder, key = chance.choice(places)
    value = holder[key]
    match chance.randrange(5):
        case 0 if isinstance(holder, dict):
            del holder[key]
        case 1 if isinstance(holder, dict):
            holder[f"{key}x"] = holder.pop(key)
        case 2 if isinstance(value, str) and value:  # the text of a case, the spelling of a method, a version
            at = chance.randrange(len(value))
            holder[key] = value[:at] + chance.choice(["", "\n", "9", "-", "[", "e9"]) + value[at + 1 :]
        case 3 if isinstance(value, float):
            holder[key] = value * chance.choice([-1, 0, 1e30, 1e-30, 1 + 1e-9])
        case _:
            holder[key] = chance.choice(VALUES)
    return json.dumps(document, ensure_ascii=chance.random() < 0.5)


def _places(document: Any) -> Any:
    """All places of a document, as their holders and keys."""
    keys = document if isinstance(document, dict) else range(len(document)) if isinstance(document, list) else ()
    for key in list(keys):
        yield document, key
        yield from _places(document[key])


def damage_table(chance: Chance, path: Path) -> None:
    """Change a cell of a table of text, or a row."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    if not lines:
        return
    at = chance.randrange(len(lines))
    cells = lines[at].split(",")
    match chance.randrange(5):
        case 0:
            del lines[at]
        case 1:
            lines.insert(at, chance.choice(lines))
        case 2:
            cells.pop(chance.randrange(len(cells)))
            lines[at] = ",".join(cells)
        case _:
            cells[chance.randrange(len(cells))] = chance.choice(CELLS)
            lines[at] = ",".join(cells)
    path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")


def damage_columns(chance: Chance, path: Path) -> None:
    """Change a column of a Parquet file, its rows, or the metadata of its schema."""
    try:
        table = pq.read_table(path)
    except (OSError, pa.ArrowException):
        return
    for _ in range(chance.choice([1, 1, 2])):
        table = chance.choice(COLUMNS)(chance, table)
    pq.write_table(table, path)


def _metadata(chance: Chance, table: pa.Table) -> pa.Table:
    told = dict(table.schema.metadata or {})
    if not told:
        return table
    key = chance.choice(sorted(told))
    text = told[key].decode(errors="replace")
    changed = damage_json(chance, text) if chance.random() < 0.8 else chance.choice(LINES)
    return table.replace_schema_metadata(told | {key: changed.encode(errors="surrogatepass")})


def _values(chance: Chance, table: pa.Table) -> pa.Table:
    """Another value in one cell of a column, or in all of its cells."""
    if not table.num_columns or not len(table):
        return table
    at = chance.randrange(table.num_columns)
    values = table.column(at).to_pylist()
    value = chance.choice(
        [None, float("nan"), float("inf"), -1e300, 0.0, 1e-300, -1.0, "x", "ok", "\x1b[2J", b"\xff", [1], {"a": 1}]
    )
    changed = [value] * len(values) if chance.random() < 0.5 else values
    changed[chance.randrange(len(values))] = value
    try:
        column = pa.array(changed)
    except pa.ArrowException:
        column = pa.array([value] * len(values))
    return table.set_column(at, table.column_names[at], column)


def _kind(chance: Chance, table: pa.Table) -> pa.Table:
    """A column as text, in single precision, of integers, or in an encoding by a dictionary."""
    if not table.num_columns:
        return table
    at = chance.randrange(table.num_columns)
    kind = chance.choice(
        [pa.string(), pa.float32(), pa.int8(), pa.dictionary(pa.int32(), pa.string()), pa.float16(), pa.bool_()]
    )
    try:
        column = table.column(at).cast(kind, safe=False)
    except pa.ArrowException:
        return table
    return table.set_column(at, table.column_names[at], column)


def _drop(chance: Chance, table: pa.Table) -> pa.Table:
    return table.drop_columns([chance.choice(table.column_names)]) if table.num_columns > 1 else table


def _rename(chance: Chance, table: pa.Table) -> pa.Table:
    names = list(table.column_names)
    if names:
        names[chance.randrange(len(names))] = chance.choice([*names, "x", ""])
    return table.rename_columns(names)


def _rows(chance: Chance, table: pa.Table) -> pa.Table:
    """Fewer rows, none, all twice, or in another order."""
    count = len(table)
    return chance.choice(
        [
            table.slice(0, 0),
            table.slice(0, 1),
            table.slice(count // 2),
            pa.concat_tables([table, table]),
            table.take(pa.array(range(count)[::-1], pa.int64())),
        ]
    )


COLUMNS: tuple[Callable[[Chance, pa.Table], pa.Table], ...] = (_metadata, _values, _values, _kind, _drop, _rename, _rows)
