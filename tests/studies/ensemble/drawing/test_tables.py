"""Members from tables that users give, which may be anything."""

import os
import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bodycheck.casefile.case import parse
from bodycheck.errors import BadInput
from bodycheck.reference.scenes import Scenes
from bodycheck.studies.ensemble.drawing import members, tables
from tests.support.ensemble_texts import BRICK, attitude, columns_of, ensemble_of, log_uniform, normal

CASE = parse(BRICK, "f")


def written(path: Path, columns: dict[str, list[float]], groups: int = 3) -> Path:
    table = pa.table(columns)
    if path.suffix == ".parquet":
        pq.write_table(table, path, row_group_size=groups)
    else:
        rows = zip(*columns.values(), strict=True)
        path.write_text("\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n")
    return path


@pytest.mark.parametrize("end", ["parquet", "csv"])
def test_rows_are_members(tmp_path: Path, end: str) -> None:
    mass = (np.arange(10) / 7 + 1).tolist()
    path = written(tmp_path / f"m.{end}", {"body.mass": mass, "initial.velocity.2": [float(k) for k in range(10)]})
    source = members.tabled(CASE, path)
    assert (source.size, source.names) == (10, ("body.mass", "initial.velocity.2"))
    again = pickle.loads(pickle.dumps(source))
    for first, count in ((0, 10), (2, 3), (9, 1), (0, 1)):
        values = again.values(first, count)
        assert values["body.mass"].tolist() == mass[first : first + count]
        assert values["initial.velocity.2"].tolist() == list(range(first, first + count))
    scenes = members.scenes(CASE, source.values(0, 10))
    assert isinstance(scenes, Scenes)
    assert scenes.mass.tolist() == mass
    assert scenes.velocity.tolist() == [[0.0, 0.0, k] for k in range(10)]


@pytest.mark.parametrize("end", ["parquet", "csv"])
def test_stored_members_can_be_run_again(tmp_path: Path, end: str) -> None:
    """The columns of what was drawn, to the last bit, with those that say whose they are."""
    case = parse(ensemble_of(BRICK, attitude(), normal("initial.angular_velocity", 0, 3), log_uniform("body.mass", 1, 2)), "f")
    source = members.drawn(case, 50)
    columns = {
        "member": list(range(50)),
        **{name: column.tolist() for name, column in columns_of(source.values(0, 50)).items()},
    }
    stored = members.tabled(case, written(tmp_path / f"m.{end}", columns))
    assert stored.names == source.names
    for (key, one), (other_key, other) in zip(source.values(7, 20).items(), stored.values(7, 20).items(), strict=True):
        assert key == other_key
        assert np.array_equal(one, other)
    assert members.text(case, stored, 31) == members.text(case, source, 31)


def test_columns_of_a_vector_may_stand_anywhere(tmp_path: Path) -> None:
    columns = {"initial.velocity.2": [3.0], "body.mass": [2.0], "initial.velocity.0": [1.0], "initial.velocity.1": [2.0]}
    source = members.tabled(CASE, written(tmp_path / "m.csv", columns))
    assert source.values(0, 1)["initial.velocity"].tolist() == [[1.0, 2.0, 3.0]]
    assert tuple(columns_of(source.values(0, 1))) == source.names


def test_a_whole_vector_replaces_what_the_file_says_otherwise(tmp_path: Path) -> None:
    turned = parse(BRICK.replace("angular_velocity =", "euler_zxz = [0.1, 0.2, 0.3]\nangular_velocity ="), "f")
    one = {f"initial.quaternion.{k}": [0.5] for k in range(4)}
    path = written(tmp_path / "m.csv", one)
    assert "euler_zxz" not in members.text(turned, members.tabled(turned, path), 0)
    with pytest.raises(BadInput, match=r"initial.quaternion.1: the file gives initial.euler_zxz instead"):
        members.tabled(turned, written(tmp_path / "n.csv", {"initial.quaternion.1": [0.5]}))


def content(text: str | bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(text.encode() if isinstance(text, str) else text)


BAD: dict[str, tuple[Callable[[Path], object], str]] = {
    "nothing": (lambda _: None, "cannot be read as a table"),
    "folder": (lambda path: path.mkdir(), "is not a regular file"),
    "pipe": (lambda path: os.mkfifo(path), "is not a regular file"),
    "empty": (content(""), "cannot be read as a table"),
    "no rows": (content("body.mass\n"), "has 0 rows; allowed: 1 to 1,000,000,000"),
    "no columns": (content("member\n1\n"), "has no column that is a key path"),
    "unknown": (
        content("body.mas\n1\n"),
        "the column body.mas: there is no number or vector of this path; .*did you mean 'body.mass'",
    ),
    "vector": (
        content("initial.velocity\n1\n"),
        "the column initial.velocity is that of a vector; allowed: initial.velocity.0, ",
    ),
    "too far": (content("initial.velocity.3\n1\n"), "there is no such component"),
    "twice": (content("body.mass,body.mass\n1,2\n"), "has the column 'body.mass' more than once"),
    "one quantity": (
        content("initial.euler_zxz.0,initial.quaternion.0\n1,2\n"),
        "for initial.euler_zxz.0 and for initial.quaternion.0",
    ),
    "words": (content("body.mass\n1\nheavy\n"), "the column body.mass holds values of the type string; allowed: numbers"),
    "gap": (content("body.mass,scene.gravity\n1,1\n,2\n"), "member 1 has no finite number in the column body.mass"),
    "infinite": (content("body.mass\n1\n2\n-inf\n"), "member 2 has no finite number in the column body.mass"),
    "ragged": (content("body.mass,scene.gravity\n1,2\n3\n"), "cannot be read as a table: .*Expected 2 columns, got 1"),
    "negative": (content("body.mass\n1\n-1\n"), "brick: member 1: body.mass: .*greater than 0"),
    "not utf-8": (content(b"body.mass\xff\n1\n"), "m.csv: "),
    "escape": (content("a\x1b[2J\n1\n"), r"read 'a\\x1b\[2J' as a column"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_with_a_table_is_one_message(tmp_path: Path, name: str) -> None:
    make, message = BAD[name]
    path = tmp_path / "m.csv"
    make(path)
    with pytest.raises(BadInput, match=message) as told:
        members.check(CASE, members.tabled(CASE, path))
    assert "\n" not in str(told.value)


def test_a_damaged_parquet_file_is_one_message(tmp_path: Path) -> None:
    path = written(tmp_path / "m.parquet", {"body.mass": [float(k + 1) for k in range(100)]})
    good = path.read_bytes()
    chance = np.random.default_rng(1)
    refused = 0
    for _ in range(60):
        bad = bytearray(good)
        for place in chance.integers(4, len(good) - 4, 8):
            bad[place] ^= int(chance.integers(1, 256))
        path.write_bytes(bad[: int(chance.integers(len(bad) // 2, len(bad) + 1))])
        try:
            members.check(CASE, members.tabled(CASE, path))
        except BadInput as error:
            refused += "\n" not in str(error)
    assert refused > 30, "the damage does too little, or is told in several lines"


def test_a_table_that_changes_is_noticed(tmp_path: Path) -> None:
    path = written(tmp_path / "m.csv", {"body.mass": [1.0, 2.0]})
    source = members.tabled(CASE, path)
    path.write_text("body.mass\n1.0\n3.0\n")
    os.utime(path, ns=(1, 1))
    with pytest.raises(BadInput, match="has changed since the members were planned"):
        source.values(0, 2)


def test_a_table_gives_as_many_members_as_asked_for(tmp_path: Path) -> None:
    path = written(tmp_path / "m.csv", {"body.mass": [1.0, 2.0, 3.0]})
    assert members.tabled(CASE, path, 2).size == 2
    for number in (0, 4):
        with pytest.raises(BadInput, match=f"read {number} members; allowed: 1 to 3, the rows of the table"):
            members.tabled(CASE, path, number)
    with pytest.raises(ValueError, match="allowed: members 0 to 1"):
        members.tabled(CASE, path, 2).values(0, 3)


def test_many_columns_are_refused_before_they_are_read(tmp_path: Path) -> None:
    """PyArrow takes some kilobytes for each column of a CSV file. Here their names alone have 600 kB."""
    path = tmp_path / "m.csv"
    names = [f"c{place}" for place in range(100_000)]
    path.write_text("\n\n" + ",".join(names) + "\n" + ",".join("1" * len(names)) + "\n")
    before = pa.total_allocated_bytes()
    with pytest.raises(BadInput, match="has 100000 columns; allowed: at most 500"):
        members.tabled(CASE, path)
    assert pa.total_allocated_bytes() - before < 1 << 20


def test_a_column_with_fewer_values_than_claimed_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A damaged Parquet file may have fewer values in a group than its description says."""
    source = members.tabled(CASE, written(tmp_path / "m.parquet", {"body.mass": [1.0, 2.0, 3.0]}))
    column = tables._Stored.column
    monkeypatch.setattr(tables._Stored, "column", lambda *given: column(*given).slice(0, 1))
    with pytest.raises(BadInput, match="cannot be read as a table: it has fewer values than it claims to have"):
        source.values(0, 3)


def test_a_quaternion_whose_length_is_infinite_is_told_as_it_is(tmp_path: Path) -> None:
    columns = {f"initial.quaternion.{place}": [1e200 if place < 2 else 0.0] for place in range(4)}
    source = members.tabled(CASE, written(tmp_path / "m.csv", columns))
    with pytest.raises(BadInput, match=r"member 0: initial.quaternion\[1\]: read 1e\+200"):
        members.scenes(CASE, source.values(0, 1))
