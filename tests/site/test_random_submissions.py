"""Random changes of a submission: it is left out with a reason, or every page can be made of it."""

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck.site import build, catalogue
from bodycheck.site.submissions import archive, contents, gathering, packing
from bodycheck.site.submissions.contents import Contents
from bodycheck.site.submissions.tables import TABLES
from tests.site import hostile
from tests.site import submissions as made

#: Entries of tables: what may stand there, the ends of ranges, and anything.
ENTRIES = (
    st.sampled_from(
        ["", "0", "-0.0", "1e-320", "1e200", "-1e200", "ok", "True", "mujoco", "file", "status", "0.002", made.FREE]
    )
    | st.floats(allow_nan=False, allow_infinity=False).map(repr)
    | st.text(max_size=40)
)

#: Values of JSON.
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=10) | st.just("mujoco"), inner, max_size=4),
    max_leaves=10,
)


@pytest.fixture(scope="module")
def honest(tmp_path_factory: pytest.TempPathFactory) -> Contents:
    tables = {name: rows[:2] for name, rows in made.ROWS.items()}
    return packing.contents(made.write_folder(tmp_path_factory.mktemp("honest"), tables))


def check(content: bytes) -> None:
    """Gather the submission in a zip file, and make the site of it."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "random.zip"
        path.write_bytes(content)
        found, left_out = gathering.gathered([path])
    assert len(found) + len(left_out) == 1
    pages = list(build.files(catalogue.catalogued(found, left_out)))
    assert len({page.path.lower() for page in pages}) == len(pages)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_random_entries(honest: Contents, data: st.DataObject) -> None:
    """In one to three places of any table."""
    files = dict(honest.files)
    for _ in range(data.draw(st.integers(1, 3))):
        name = data.draw(st.sampled_from(sorted(TABLES)))
        head, row, *others = hostile.rows_of(files[f"tables/{name}"])
        row[data.draw(st.integers(0, len(row) - 1))] = data.draw(ENTRIES)
        files[f"tables/{name}"] = hostile.table_of([head, row, *others])
    check(archive.zipped(Contents(honest.header, files)))


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_random_headers(honest: Contents, data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(honest.header)))
    check(archive.zipped(Contents({**honest.header, name: data.draw(JSON)}, honest.files)))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**9), st.integers(0, 255), st.integers(1, 40))
def test_random_bytes(honest: Contents, place: int, byte: int, count: int) -> None:
    content = bytearray(archive.zipped(honest))
    start = place % len(content)
    content[start : start + count] = bytes([byte]) * count
    check(bytes(content))


@settings(max_examples=40, deadline=None)
@given(st.binary(max_size=300) | st.text(max_size=300).map(str.encode))
def test_random_files(honest: Contents, content: bytes) -> None:
    for name in ("tables/results.csv", f"cases/{made.FREE}.case.toml", contents.TRACKS):
        check(archive.zipped(Contents(honest.header, {**honest.files, name: content})))
