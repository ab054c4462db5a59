"""The data of the site: what programs read, and the same as scripts."""

import json
from hashlib import sha256
from typing import Any

from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.pages import data
from bodycheck.site.submissions.tables import TABLES
from tests.site import submissions
from tests.site.large import large
from tests.site.submissions import CONTACT, FREE, catalogued, ended, run, submission


def files(catalogue: Catalogue) -> dict[str, bytes]:
    return {file.path: file.content for file in data.pages(catalogue)}


def test_a_submission_can_be_read_back_row_by_row() -> None:
    rows = [run(attitude_error=0.1 + 0.2), ended("diverged", 'not "finite" & so on', integrator="RK4")]
    source = submission({"results.csv": rows, "orders.csv": [submissions.order()]})
    found = json.loads(files(catalogued(source))[f"{links.data(source)}.json"])
    for name, table in found["tables"].items():
        for place, row in enumerate(source.tables[name]):
            read = {column: values[place] for column, values in table["columns"].items()}
            assert read == {column: value for column, value in row.items() if column in read}
            assert all(row[column] is None for column in row.keys() - read.keys())
        assert table["rows"] == len(source.tables[name]) == len(table["commands"])
    assert found["header"]["machine"] == source.header.machine


def test_case_files_stand_once_under_their_digest() -> None:
    first, second = submission([run()], day="2026-01-01"), submission([run(), run(case=CONTACT)], day="2026-01-02")
    made = files(catalogued(first, second))
    texts = json.loads(made["data/cases.json"])["cases"]
    assert len(texts) == 2
    for source in (first, second):
        for name, digest in json.loads(made[f"{links.data(source)}.json"])["cases"].items():
            assert texts[digest] == source.cases[name]
            assert sha256(texts[digest].encode()).hexdigest() == digest


def test_the_list_has_what_the_front_page_shows() -> None:
    before = submission([run(attitude_error=1e-3)], day="2026-01-01")
    after = submission([run(attitude_error=2e-3), run(integrator="RK4", attitude_error=1e-9)], day="2026-01-02")
    found = json.loads(files(catalogued(before, after))["data/index.json"])
    assert [one["key"] for one in found["submissions"]] == [before.key, after.key]
    assert found["submissions"][1]["runs"] == [{"engine": "mujoco", "version": "4.0.0", "table": "results.csv", "rows": 2}]
    (cell,) = found["cells"]
    assert cell["verdict"] == "error"
    assert cell["value"] == 2e-3
    assert (cell["row"], cell["best"]) == ([after.key, "results.csv", 0], [after.key, "results.csv", 1])
    assert [change["before"] for change in cell["changes"]] == [[before.key, "results.csv", 0]]
    assert found["scenes"][FREE]["kind"] in found["kinds"]


def test_scripts_have_the_same_as_json_and_cannot_leave_their_element() -> None:
    source = submission([run(), ended("crashed", "<b>&lt;/b>", integrator="RK4")])
    made = files(catalogued(source))
    script = made[f"{links.data(source)}.js"].decode()
    assert script.isascii()
    assert not set("<>&") & set(script)
    begin = f'site.data["{source.key}"]='
    assert script.startswith(begin)
    assert json.loads(script.removeprefix(begin).rstrip(";\n")) == json.loads(made[f"{links.data(source)}.json"])
    assert json.loads(made["data/index.js"].decode().removeprefix("site.index=").rstrip(";\n")) == {
        name: value for name, value in json.loads(made["data/index.json"]).items() if name != "cells"
    }


def test_every_column_of_every_table_has_a_title_and_a_meaning() -> None:
    for table in TABLES.values():
        assert all(column.title and column.meaning for column in table.columns)


def test_the_data_of_ten_thousand_rows_is_small() -> None:
    made = files(large())
    rows = sum(table["rows"] for table in _tables(made))
    assert rows > 10_000
    assert sum(map(len, made.values())) < 1000 * rows


def _tables(made: dict[str, bytes]) -> list[dict[str, Any]]:
    found = [json.loads(content) for path, content in made.items() if path.endswith(".json")]
    return [table for one in found if "key" in one for table in one["tables"].values()]
