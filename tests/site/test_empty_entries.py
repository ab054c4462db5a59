"""Pages of engines and releases, the feed and badges are made whatever entries of a table are empty, where they may be."""

import pytest

from bodycheck.errors import BadInput
from bodycheck.site.pages import badges, engines, feed, releases
from bodycheck.site.submissions.tables import TABLES
from tests.site import submissions as make
from tests.site import upgrades as example

ROWS = example.STUDIES | {
    "results.csv": [make.run(version=example.NEW)],
    "releases.csv": [make.release(example.NEW)],
    "changes.csv": [make.change(scheme_before="A", scheme_after="B")],
}


@pytest.mark.parametrize("table", ROWS)
def test_an_empty_entry_or_a_zero_breaks_no_page(table: str) -> None:
    row, *others = ROWS[table]
    columns = [column for column in row if column not in TABLES[table].filled]
    assert columns
    made = 0
    for column in columns:
        values = (None, 0.0) if isinstance(row[column], float) else (None,)
        for value in values:
            try:
                more = make.submission({table: [dict(row) | {column: value}, *others]}, day="2026-01-08")
            except BadInput:
                continue
            catalogue = example.catalogue(more)
            for pages in (engines, releases, feed, badges):
                made += len(list(pages.pages(catalogue)))
    assert made > 0
