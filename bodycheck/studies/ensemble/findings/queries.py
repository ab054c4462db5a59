"""Questions in SQL to the results of an ensemble. DuckDB answers them from the Parquet files of the folder.

The folder and the question may come from strangers. DuckDB may open the listed files and nothing else, it loads no extension,
its settings are locked before the question is read, and a question is one SELECT statement, so that nothing is written.
"""

import contextlib
import os
import stat
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bodycheck.errors import BadFolder, BadInput
from bodycheck.files import reading

if TYPE_CHECKING:
    import duckdb

#: The tables that a question may name, each of which is the folder of this name with its Parquet files.
VIEWS = ("runs", "members", "truths")

#: The most memory that a question may take. Nothing is spilled to the disk.
MEMORY_LIMIT = "2GB"

#: Rows that are fetched at once.
FETCHED_ROWS = 4096

#: Settings of a connection that reaches nothing outside: no extension, secret, variable of Python, or file to spill to.
SETTINGS: dict[str, str | bool | int | float | list[str]] = {
    "memory_limit": MEMORY_LIMIT,
    "temp_directory": "",
    "allow_community_extensions": False,
    "allow_unsigned_extensions": False,
    "allow_persistent_secrets": False,
    "autoinstall_known_extensions": False,
    "autoload_known_extensions": False,
    "python_enable_replacements": False,
}


@dataclass(frozen=True)
class Answer:
    """The answer to a question.

    Attributes
    ----------
    columns
        The names of the columns, all different.
    rows
        The rows, which are computed as they are read: numbers, texts, truth values, None, and other types that DuckDB returns.
    """

    columns: tuple[str, ...]
    rows: Iterator[tuple[Any, ...]]


@contextlib.contextmanager
def answer(folder: Path, question: str) -> Iterator[Answer]:
    """Provide the answer to a question about the results of an ensemble.

    Parameters
    ----------
    folder
        The folder of the results.
    question
        One SELECT statement, in the SQL of DuckDB, about the tables `VIEWS`.

    Raises
    ------
    BadFolder
        If the folder has no results of an ensemble, they are damaged, or something in it is a symbolic link.
    BadInput
        If DuckDB is not installed, the question is not a SELECT statement, or it cannot be answered. An error that occurs
        while rows are read is raised at that time.
    """
    with connected(folder) as connection:
        with _told():
            _check(connection, question)
            cursor = connection.execute(question)
            names = _different([_printable(column[0]) for column in cursor.description or ()])
        yield Answer(names, _rows(cursor))


@contextlib.contextmanager
def connected(folder: Path) -> Iterator["duckdb.DuckDBPyConnection"]:
    """Provide a connection that has the tables of a folder, opens no other file, and can no longer be configured.

    Raises as `answer` does.
    """
    duckdb = _duckdb()
    files = _files(folder)
    with contextlib.closing(duckdb.connect(":memory:", config=SETTINGS)) as connection:
        connection.execute("SET allowed_paths = ?", [[str(path) for paths in files.values() for path in paths]])
        connection.execute("SET enable_external_access = false")
        connection.execute("SET lock_configuration = true")
        try:
            for name, paths in files.items():
                connection.execute(_view(name, f"[{', '.join(_quoted(str(path)) for path in paths)}]"))
        except duckdb.Error as error:
            raise BadFolder(f"{folder}: cannot be read: {_printable(error)}") from error
        yield connection


def sql(folder: Path, question: str) -> str:
    """Return a question with the statements that define its tables, for other programs that speak the SQL of DuckDB.

    Raises `BadFolder` as `answer` does.
    """
    root = "".join(f"[{sign}]" if sign in "*?[" else sign for sign in str(folder.resolve()))  # quotes wildcards
    views = [_view(name, _quoted(f"{root}/{name}/**/*.parquet")) for name in _files(folder)]
    return "".join(f"{statement};\n" for statement in (*views, question.strip().rstrip(";")))


def _duckdb() -> Any:
    """Return the package DuckDB. Raises `BadInput` if it is not installed."""
    try:
        import duckdb  # an extra, and large
    except ModuleNotFoundError as error:
        raise BadInput("query needs DuckDB: pip install 'bodycheck[scale]'") from error
    return duckdb


def _files(folder: Path) -> dict[str, list[Path]]:
    """Return the Parquet files of each table that a folder has. Raises `BadFolder`."""
    if not folder.is_dir():
        raise BadFolder(f"{folder}: there is no such folder")
    root = folder.resolve()
    reading.refuse_links(root)
    by_table = {name: sorted(_parquet(root / name)) for name in VIEWS}
    if not by_table["runs"]:
        raise BadFolder(
            f"{folder}: has no Parquet files in runs/, as `bodycheck ensemble --out` writes them when it is complete"
        )
    return {name: paths for name, paths in by_table.items() if paths}


def _parquet(folder: Path) -> Iterator[Path]:
    """Yield the Parquet files in a folder at any depth. Raises `BadFolder` if one is not a regular file."""
    for inside, _, names in os.walk(folder):
        for name in names:
            path = Path(inside, name)
            if path.suffix == ".parquet":
                if not stat.S_ISREG(path.lstat().st_mode):
                    raise BadFolder(f"{path}: is not a regular file")
                yield path


def _view(name: str, files: str) -> str:
    """Return the statement that makes a table of files, which are given in SQL and may have different columns."""
    return f"CREATE VIEW {name} AS SELECT * FROM read_parquet({files}, union_by_name = true, hive_partitioning = false)"


def _quoted(text: str) -> str:
    """Return a text in SQL."""
    return "'" + text.replace("'", "''") + "'"


def _check(connection: "duckdb.DuckDBPyConnection", question: str) -> None:
    """Raise `BadInput` unless a question is one SELECT statement in UTF-8."""
    if not question.isascii() and question != question.encode("utf-8", "replace").decode("utf-8"):
        raise BadInput(f"read {_printable(question)}; a question is text in UTF-8")
    statements = connection.extract_statements(question)
    kinds = [statement.type.name for statement in statements]
    if kinds != ["SELECT"]:
        read = ", ".join(kinds) or "nothing"
        example = "SELECT engine, max(attitude_error) FROM runs GROUP BY ALL"
        raise BadInput(f"read {read}; a question is one SELECT statement, such as: {example}")


@contextlib.contextmanager
def _told() -> Iterator[None]:
    """Turn errors of DuckDB within the context into `BadInput`."""
    duckdb = _duckdb()
    try:
        yield
    except duckdb.Error as error:
        if "pytz" in str(error):  # DuckDB converts such times by this package, whose absence it tells as a traceback
            raise BadInput("a time with a time zone cannot be printed; cast it, for example: CAST(… AS VARCHAR)") from error
        raise BadInput(_printable(error)) from error


def _rows(cursor: "duckdb.DuckDBPyConnection") -> Iterator[tuple[Any, ...]]:
    while True:
        with _told():
            rows = cursor.fetchmany(FETCHED_ROWS)
        if not rows:
            return
        yield from rows


def _different(names: list[str]) -> tuple[str, ...]:
    """Return distinct names of columns: a name that occurred before gets a number, as in a, a_2."""
    different: dict[str, None] = {}
    for name in names:
        number, numbered = 1, name
        while numbered in different:
            number += 1
            numbered = f"{name}_{number}"
        different[numbered] = None
    return tuple(different)


def _printable(text: object) -> str:
    """Return a text in which all characters that a terminal might act on, except line breaks, are escaped."""
    return "".join(sign if sign.isprintable() or sign == "\n" else ascii(sign)[1:-1] for sign in str(text))
