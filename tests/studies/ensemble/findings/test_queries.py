import contextlib
import csv
import io
import json
import os
import sys
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bodycheck.errors import BadFolder, BadInput
from bodycheck.studies.ensemble.findings import queries
from tests.support.commands import bodycheck, call
from tests.support.terminals import terminal

duckdb = pytest.importorskip("duckdb")

#: Errors of the members of each engine.
ERRORS = {"mujoco": [0.25, 0.5, None], "pinocchio": [1e-7, 1e-6, 3e-6]}


def write(path: Path, rows: list[dict[str, Any]]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(pa.Table.from_pylist(rows), path)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The results of an ensemble of three members, in a folder whose name SQL and patterns of files would misread."""
    made = tmp_path / "it's [a] *"
    for engine, errors in ERRORS.items():
        rows = [{"engine": engine, "member": member, "attitude_error": error} for member, error in enumerate(errors)]
        write(made / "runs" / engine / "brick" / "part-00000.parquet", rows)
    write(made / "runs/mujoco/brick/part-00001.parquet", [{"engine": "mujoco", "member": 3, "status": "crashed"}])
    write(made / "members/brick/part-00000.parquet", [{"member": m, "initial.velocity.0": m / 2} for m in range(4)])
    write(made / "truths/brick/part-00000.parquet", [{"member": m, "model": "closed form"} for m in range(4)])
    (made / "header.json").write_text("{}", "utf-8")
    (tmp_path / "it's ab").mkdir()  # what the name of the folder would stand for as a pattern
    return made


def rows(folder: Path, question: str) -> list[tuple[Any, ...]]:
    with queries.answer(folder, question) as answer:
        return list(answer.rows)


def contents(folder: Path) -> dict[str, bytes | None]:
    return {str(path): path.read_bytes() if path.is_file() else None for path in sorted(folder.rglob("*"))}


def test_tables_hold_the_rows_of_all_files(folder: Path) -> None:
    assert rows(folder, "SELECT engine, count(*), max(attitude_error) FROM runs GROUP BY ALL ORDER BY ALL") == [
        ("mujoco", 4, 0.5),
        ("pinocchio", 3, 3e-6),
    ]
    joined = "FROM runs JOIN members USING (member) JOIN truths USING (member) WHERE status = 'crashed'"
    assert rows(folder, f'SELECT "initial.velocity.0", model {joined}') == [(1.5, "closed form")]


def test_what_is_shown_is_what_is_answered(folder: Path) -> None:
    question = "SELECT engine, member FROM runs ORDER BY ALL"
    with duckdb.connect() as elsewhere:
        assert elsewhere.execute(queries.sql(folder, question)).fetchall() == rows(folder, question)


@pytest.mark.parametrize(
    "question",
    [
        "COPY runs TO '{outside}/copy.csv'",
        "COPY (SELECT 1) TO '{inside}/runs/mujoco/brick/part-00000.parquet'",
        "EXPORT DATABASE '{outside}/exported'",
        "ATTACH '{outside}/new.duckdb'",
        "INSTALL httpfs",
        "LOAD '{outside}/some.duckdb_extension'",
        "PRAGMA database_list",
        "SET enable_external_access = true",
        "RESET lock_configuration",
        "CREATE TABLE more AS SELECT * FROM runs",
        "DROP VIEW runs",
        "DELETE FROM runs",
        "CALL enable_logging(storage = 'file', storage_path = '{outside}/log')",
        "SELECT 1; COPY runs TO '{outside}/copy.csv'",
        "SELECT * FROM read_csv('{outside}/secret.csv')",
        "SELECT * FROM read_text('{outside}/secret.csv')",
        "SELECT * FROM read_blob('{inside}/../secret.csv')",
        "SELECT * FROM read_text('{inside}/header.json')",
        "SELECT * FROM '{outside}/secret.csv'",
        "SELECT * FROM '/etc/passwd'",
        "SELECT * FROM read_parquet('{outside}/other.parquet')",
        "SELECT * FROM parquet_metadata('{outside}/other.parquet')",
        "SELECT * FROM read_parquet('{inside}/runs/mujoco/brick/../../../../other.parquet')",
        "SELECT * FROM glob('{outside}/*')",
        "SELECT * FROM read_csv('https://example.org/some.csv')",
        "SELECT * FROM enable_logging(storage = 'file', storage_path = '{outside}/log')",
        "SELECT * FROM enable_profiling(save_location = '{outside}/profile')",
        "SELECT * FROM query('COPY runs TO ''{outside}/copy.csv''')",
        "SELECT * FROM folder",
        "SELECT getenv('HOME')",
        "SELEC 1",
        "",
    ],
)
def test_a_question_reaches_nothing_outside(folder: Path, question: str) -> None:
    outside = folder.parent
    (outside / "secret.csv").write_text("a,b\n1,2\n", "utf-8")
    write(outside / "other.parquet", [{"a": 1}])
    before = contents(outside)
    in_sql = {"outside": str(outside).replace("'", "''"), "inside": str(folder).replace("'", "''")}
    with pytest.raises(BadInput):
        rows(folder, question.format(**in_sql))
    assert contents(outside) == before


def test_no_function_reaches_a_file_outside(folder: Path) -> None:
    """Every function that DuckDB has is given the path of a file outside, in a question of its own."""
    outside = folder.parent
    (outside / "secret.csv").write_text("a,b\nsecret,2\n", "utf-8")
    before = contents(outside)
    path = str(outside / "secret.csv").replace("'", "''")
    with queries.connected(folder) as connection:
        found = connection.execute("SELECT DISTINCT function_name, function_type FROM duckdb_functions()").fetchall()
        functions = [(name, kind) for name, kind in sorted(found) if name.isidentifier() and not name.startswith("sleep")]
        assert len(functions) > 500
        for name, kind in functions:
            call = f"SELECT * FROM {name}('{path}')" if "table" in kind else f"SELECT {name}('{path}')"
            with contextlib.suppress(duckdb.Error):
                assert "secret," not in str(connection.execute(call).fetchall()), call
    assert contents(outside) == before


def test_memory_is_limited_and_nothing_is_spilled(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(queries.SETTINGS, "memory_limit", "40MB")
    before = contents(tmp_path)
    with pytest.raises(BadInput, match=r"[Mm]emory"):
        rows(folder, "SELECT i, row_number() OVER (ORDER BY hash(i)) FROM range(20000000) AS t(i) ORDER BY 2 DESC")
    assert contents(tmp_path) == before


def test_links_and_what_is_no_file_are_refused(folder: Path, tmp_path: Path) -> None:
    write(tmp_path / "other.parquet", [{"a": 1}])
    link = folder / "runs/mujoco/brick/part-00002.parquet"
    link.symlink_to(tmp_path / "other.parquet")
    with pytest.raises(BadFolder, match="is a symbolic link"):
        rows(folder, "SELECT * FROM runs")
    link.unlink()
    os.mkfifo(link)  # reading it would wait for ever
    with pytest.raises(BadFolder, match="is not a regular file"):
        rows(folder, "SELECT * FROM runs")


def test_damaged_and_other_folders_are_refused(folder: Path, tmp_path: Path) -> None:
    (folder / "runs/mujoco/brick/part-00002.parquet").write_bytes(b"PAR1 and no more PAR1")
    with pytest.raises(BadFolder, match=r"part-00002\.parquet"):
        rows(folder, "SELECT 1")
    with pytest.raises(BadFolder, match="has no Parquet files in runs/"):
        rows(tmp_path, "SELECT 1")
    with pytest.raises(BadFolder, match="there is no such folder"):
        rows(tmp_path / "nowhere", "SELECT 1")


def test_a_folder_may_be_named_by_a_link(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "linked").symlink_to(folder)
    assert rows(tmp_path / "linked", "SELECT count(*) FROM runs") == [(7,)]


def test_without_duckdb_one_sentence_says_what_to_install(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "duckdb", None)
    done = bodycheck("query", "SELECT 1", folder)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "query needs DuckDB: pip install 'bodycheck[scale]'\n"


def test_json_and_csv_are_read_by_programs(folder: Path) -> None:
    columns = "member, attitude_error, '=1+1' AS text, 'inf'::DOUBLE AS large, [1, 2] AS list"
    question = f"SELECT {columns} FROM runs WHERE engine = 'mujoco' ORDER BY 1"
    done = bodycheck("query", question, folder, "--json")
    assert done.returncode == 0
    objects = json.loads(done.stdout)
    assert objects[0] == {"member": 0, "attitude_error": 0.25, "text": "=1+1", "large": None, "list": [1, 2]}
    assert [one["attitude_error"] for one in objects] == [0.25, 0.5, None, None]
    table = list(csv.reader(io.StringIO(bodycheck("query", question, folder, "--csv").stdout)))
    assert table[:2] == [["member", "attitude_error", "text", "large", "list"], ["0", "0.25", "'=1+1", "inf", "[1, 2]"]]
    assert json.loads(bodycheck("query", "SELECT 1 WHERE false", folder, "--json").stdout) == []
    twice = json.loads(bodycheck("query", "SELECT 1 AS a, 2 AS a", folder, "--json").stdout)
    assert twice == [{"a": 1, "a_2": 2}]


def test_a_terminal_gets_so_many_rows_and_no_commands(folder: Path) -> None:
    with terminal(80) as screen:
        call("query", "SELECT i, chr(27) || '[2J' AS sign FROM range(1000) AS t(i)", folder)
    assert screen.lines[-2].split()[0] == "99"
    assert screen.lines[-1] == "these are the first 100 rows; --csv and --json print all"
    assert "\033[2J" not in screen.getvalue()


def test_faults_of_a_question_are_told(folder: Path) -> None:
    done = bodycheck("query", "SELECT atitude_error FROM runs", folder)
    assert done.returncode == 2
    assert 'Candidate bindings: "attitude_error"' in done.stderr
    done = bodycheck("query", "DROP VIEW runs", folder)
    assert "a question is one SELECT statement" in done.stderr


def test_a_question_that_is_not_utf_8_is_refused(folder: Path) -> None:
    with pytest.raises(BadInput, match=r"read SELECT \\udcff; a question is text in UTF-8"):
        rows(folder, "SELECT \udcff")


def test_a_time_with_a_zone_is_refused_in_words(folder: Path) -> None:
    question = "SELECT TIMESTAMPTZ '2020-01-01 00:00:00+00' AS t"
    try:
        import pytz  # noqa: F401  # pandas may have installed it, and DuckDB then prints such times
    except ModuleNotFoundError:
        with pytest.raises(BadInput, match=r"^a time with a time zone cannot be printed; cast it"):
            rows(folder, question)
    ((text,),) = rows(folder, f"SELECT CAST(t AS VARCHAR) FROM ({question})")
    assert text.startswith("20")


def test_a_long_text_is_shortened_in_a_table_and_whole_in_csv(folder: Path) -> None:
    question = "SELECT repeat('a', 100000) AS long"
    table, whole = bodycheck("query", question, folder), bodycheck("query", question, folder, "--csv")
    assert max(map(len, table.stdout.splitlines())) == 300
    assert "a" * 100000 in whole.stdout
