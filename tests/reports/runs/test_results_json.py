"""results.json holds what the other tables do, and its schema describes it and nothing else."""

import json
import shutil
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from bodycheck.figures import columns
from bodycheck.judging import judgement
from bodycheck.reports.runs import results_json
from bodycheck.results import store
from bodycheck.results.header import DESCRIPTIONS
from tests.support import ROOT, saved_results
from tests.support.saved_results import call

Document = dict[str, Any]

#: The columns that every row has after those of `judgement.COLUMNS`, and those that not every row has.
ALWAYS = {column.name for column in (*columns.CASE_COLUMNS, *columns.METHOD_COLUMNS)}
OPTIONAL = {
    "set",
    *columns.FURTHER,
    *(column.name for column in (*columns.LIMIT_COLUMNS, *columns.DEPARTURE_COLUMNS, *columns.ENGINE_COLUMNS)),
}


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return saved_results.made(tmp_path_factory, "run") / "run"


@pytest.fixture(scope="module")
def document(folder: Path) -> Document:
    found = json.loads((folder / "results.json").read_text())
    assert isinstance(found, dict)
    return found


@pytest.fixture(scope="module")
def schema() -> Document:
    found = json.loads(results_json.schema())
    Draft202012Validator.check_schema(found)
    assert isinstance(found, dict)
    return found


def faults(schema: Document, document: Any) -> list[str]:
    return [error.message for error in Draft202012Validator(schema).iter_errors(document)]


def objects(value: Any) -> Iterator[Document]:
    """Every object in a document."""
    if isinstance(value, dict):
        yield value
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from objects(inner)


def test_real_results_fit_the_schema_whatever_became_of_them(document: Document, schema: Document) -> None:
    assert faults(schema, document) == []
    assert {run["status"] for run in document["runs"]} == {"ok", "unsupported", "crashed", "diverged"}
    assert {run["passed"] for run in document["runs"]} == {False, None}
    assert document["complete"]


def test_several_sets_fit_it_too(folder: Path, tmp_path: Path, schema: Document) -> None:
    other = tmp_path / "other"
    other.symlink_to(folder)
    copied = Path(shutil.copytree(folder, tmp_path / "copied"))
    call("report", other, copied, "--out", tmp_path / "out")
    document = json.loads((tmp_path / "out" / "results.json").read_text())
    assert faults(schema, document) == []
    assert [one["label"] for one in document["sets"]] == [folder.name, "copied"]
    assert {run["set"] for run in document["runs"]} == {folder.name, "copied"}


def test_its_runs_are_what_the_command_prints(document: Document, schema: Document, folder: Path) -> None:
    printed = json.loads(json.dumps(judgement.records(judgement.judge(store.read(folder)))))
    assert printed == document["runs"]
    runs = {"$schema": schema["$schema"], "$defs": schema["$defs"], "$ref": "#/$defs/runs"}
    assert faults(runs, printed) == []
    assert faults(runs, [printed[0] | {"surprise": 1}])


def test_it_says_what_the_report_says(document: Document, folder: Path) -> None:
    text = (folder / "report.md").read_text()
    assert f"# bodycheck: {document['headline']}" in text
    assert document["findings"]
    (one,) = document["sets"]
    header = json.loads((folder / "run.jsonl").read_text().splitlines()[0])
    assert one["header"] == {name: header[name] for name in DESCRIPTIONS}
    assert [case["name"] for case in one["cases"]] == ["spin", "slide"]
    assert one["label"] == ""


def test_the_schema_is_strict(document: Document, schema: Document) -> None:
    """Nothing may be added to any object, and nothing be taken from one, but for columns that not every run has."""
    (one,) = document["sets"]
    few = {"runs": document["runs"][:1], "findings": document["findings"][:1], "sets": [one | {"cases": one["cases"][:1]}]}
    small = deepcopy(document | few)
    free = ("machine", "packages", "engines", "missing")  # names of whatever there is
    own = small["sets"][0]
    for value in (small, own, own["header"], own["cases"][0], small["findings"][0], small["runs"][0]):
        value["surprise"] = 1
        assert faults(schema, small)
        del value["surprise"]
        for name in list(value):
            kept = value.pop(name)
            assert bool(faults(schema, small)) == (name not in OPTIONAL), name
            value[name] = kept
    for name in free:
        own["header"][name]["surprise"] = "1"
    assert faults(schema, small) == []


@pytest.mark.parametrize(
    ("status", "name", "value"),
    [
        ("ok", "position_error", None),
        ("ok", "position_error", -1.0),
        ("ok", "position_error", "1"),
        ("ok", "steps", 1.5),
        ("ok", "timestep", 0.0),
        ("ok", "passed", "yes"),
        ("ok", "status", "well"),
        ("ok", "engine", None),
        ("crashed", "position_error", 0.0),
        ("unsupported", "steps", 3),
        ("diverged", "energy_error", 0.0),
        ("ok", "kind", None),
        ("crashed", "position_error_margin", 2.0),
    ],
)
def test_the_schema_refuses(status: str, name: str, value: object, document: Document, schema: Document) -> None:
    changed = deepcopy(document)
    next(run for run in changed["runs"] if run["status"] == status)[name] = value
    assert faults(schema, changed)


def test_every_column_is_described_with_its_unit(schema: Document) -> None:
    described = schema["$defs"]["run"]["properties"]
    assert list(described) == list(columns.COLUMNS)
    assert {*judgement.COLUMNS, *ALWAYS, *OPTIONAL} == set(described)
    for name, column in columns.COLUMNS.items():
        text = described[name]["description"]
        if column.kind in ("number", "integer"):
            assert text.endswith(f" Unit: {column.unit or column.counts or 'relative'}.")
        else:
            assert "Unit:" not in text
    units = {"position_error": "m", "attitude_error": "rad", "creep": "m/s", "stop_time_error": "s", "energy_drift": "relative"}
    for name, unit in units.items():
        assert described[name]["description"].endswith(f"Unit: {unit}.")


def test_everything_in_the_schema_is_described(schema: Document) -> None:
    for value in objects(schema):
        for name, inner in value.get("properties", {}).items() if "additionalProperties" in value else ():
            assert "description" in inner or "$ref" in inner, name


def test_the_schema_that_is_shipped_is_that_of_the_columns() -> None:
    """`bodycheck schema results > reports/results.schema.json` renews it."""
    assert (ROOT / "reports" / "results.schema.json").read_text("utf-8") == results_json.schema()


def test_the_command_prints_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert call("schema", "results") == 0
    assert capsys.readouterr().out == results_json.schema()
