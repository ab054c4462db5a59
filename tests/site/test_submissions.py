"""What these tests make their submissions of is what the site reads: every kind of row, from a folder and from a zip file."""

from pathlib import Path

import pytest

from bodycheck.site.submissions import archive, gathering, packing
from bodycheck.site.submissions.tables import TABLES
from tests.site import submissions as made


def test_there_are_rows_of_every_table() -> None:
    assert list(made.ROWS) == list(TABLES)


@pytest.mark.parametrize("name", made.ROWS)
def test_a_table_is_read_as_it_was_made(name: str, tmp_path: Path) -> None:
    folder = made.write_folder(tmp_path / "results", {"results.csv": [made.run()], name: made.ROWS[name]})
    read = gathering.read(folder)
    told = [{column: value for column, value in row.items() if value is not None} for row in read.tables[name]]
    assert told == [{column: value for column, value in row.items() if value not in (None, "")} for row in made.ROWS[name]]
    packed = archive.read(archive.zipped(packing.contents(folder)))
    assert packed.key == read.key
    assert packed.tables == read.tables
    assert packed.cases == read.cases


def test_a_catalogue_has_the_scenes_and_engines_of_its_submissions() -> None:
    older = made.submission([made.run(version="3.17.0")], day="2026-01-01")
    newer = made.submission([made.run(), made.run(engine="dart", version="6.20.0")], day="2026-02-01")
    found = made.catalogued(newer, older)
    assert found.submissions == (older, newer)
    assert not found.left_out
    assert found.engines == ("dart", "mujoco")
    assert found.versions["mujoco"] == ("3.17.0", "4.0.0")
    assert list(found.scenes) == [made.FREE]
    assert found.scenes[made.FREE].shipped
