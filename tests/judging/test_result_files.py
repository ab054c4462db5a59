"""Tables of results say where they come from and what is expected: in CSV, Parquet and JSON alike."""

import json
import math
from hashlib import sha256
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow.parquet as pq
import pytest

from bodycheck.adapters.method import Method
from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.figures.columns import COLUMNS
from bodycheck.judging import judgement
from bodycheck.judging.discrepancy import Summary
from bodycheck.judging.margins import Margin, margins
from bodycheck.results import store
from bodycheck.results.header import DESCRIPTIONS
from tests.support import saved_results

#: The limits that the cases of these results set.
LIMITS = {"position_error": 1e-9, "velocity_error": 1e-9}


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return saved_results.made(tmp_path_factory, "run") / "run"


def limited(**limits: tuple[float | None, float | None]) -> Expectation:
    return Expectation("mujoco", Method.parse("Euler", 0.01), tuple(Limit(name, *ends) for name, ends in limits.items()))


def test_limits_and_margins_are_those_of_the_case_in_every_format(folder: Path) -> None:
    csv, parquet = pd.read_csv(folder / "results.csv"), pd.read_parquet(folder / "results.parquet")
    runs = json.loads((folder / "results.json").read_text())["runs"]
    added = ["kind", "tags", *(name + end for name in LIMITS for end in ("_limit", "_margin"))]
    added += ["steps_taken", "steps_rejected", "evaluations", "role", "contact_terms"]
    assert list(csv.columns[-11:]) == list(parquet.columns[-11:]) == list(runs[0])[-11:] == added
    expected = [run for run in runs if run["position_error_limit"] is not None]
    assert {(run["case"], run["integrator"], run["timestep"], run["status"]) for run in expected} == {
        ("spin", "Euler", 0.01, "ok")
    }
    for run in expected:
        for name, limit in LIMITS.items():
            assert run[f"{name}_limit"] == limit
            assert run[f"{name}_margin"] == limit / run[name]
        assert (run["position_error_margin"] < 1) == (run["position_error"] > 1e-9)
    roles = pd.read_csv(folder / "results.csv", keep_default_na=False)["role"]
    assert list(roles) == list(parquet["role"]) == [run["role"] for run in runs]
    for name in added[2:-2]:
        assert [value if value == value else None for value in csv[name]] == [run[name] for run in runs]
        assert [None if pd.isna(value) else value for value in parquet[name]] == [run[name] for run in runs]
    assert dict(zip(csv.case, csv.kind, strict=True)) == {"spin": "turning", "slide": "contact"}
    assert set(csv[csv.case == "spin"].tags) == {"short"}


def test_a_file_beside_csv_and_the_schema_of_parquet_say_where_they_come_from(folder: Path) -> None:
    beside = json.loads((folder / "results.csv-metadata.json").read_text())
    assert beside["url"] == "results.csv"
    assert beside["@context"][0] == "http://www.w3.org/ns/csvw"
    schema = pq.read_schema(folder / "results.parquet")
    (origin,) = beside["notes"]
    assert json.loads(schema.metadata[b"bodycheck"]) == [origin]
    header = store.read(folder).header
    assert {name: origin[name] for name in DESCRIPTIONS} == {name: header[name] for name in DESCRIPTIONS}  # type: ignore[literal-required]
    cases = {path.name.removesuffix(".case.toml"): path for path in folder.parent.glob("*.case.toml")}
    assert origin["cases_sha256"] == {name: sha256(cases[name].read_bytes()).hexdigest() for name in ("spin", "slide")}
    described = {column["name"]: column for column in beside["tableSchema"]["columns"]}
    assert list(described) == schema.names == list(pd.read_csv(folder / "results.csv").columns)
    for name in schema.names:
        unit = COLUMNS[name].unit or COLUMNS[name].counts
        metadata = schema.field(name).metadata
        assert described[name].get("schema:unitText", "") == unit
        assert metadata.get(b"unit", b"").decode() == unit
        assert metadata[b"description"].decode() == described[name]["dc:description"] == COLUMNS[name].told


def test_every_csv_of_a_study_has_a_file_beside_it(tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = saved_results.made(tmp_path_factory, "extremes") / "extremes"
    tables = {path.name for path in folder.glob("*.csv")}
    assert tables == {"extremes.csv", "limits.csv"}
    for name in tables:
        found: dict[str, Any] = json.loads((folder / f"{name}-metadata.json").read_text())
        assert [column["name"] for column in found["tableSchema"]["columns"]] == list(pd.read_csv(folder / name).columns)
        assert list(found["notes"][0]["cases_sha256"]) == ["spin"]


def test_a_margin_is_the_limit_divided_by_the_figure() -> None:
    summary = Summary({"position_error": 0.5, "attitude_error": 0.0, "mean_load": 0.8}, {})
    one = limited(position_error=(None, 2.0), attitude_error=(None, 1e-3), mean_load=(0.9, None))
    two = limited(position_error=(0.1, 1.0), order=(3.75, 4.25), tilt=(None, 1.0))
    position, attitude, load = margins([one, two], summary)
    assert position == Margin("position_error", 0.1, 1.0, 0.5)  # the narrowest of two ranges
    assert (position.limit, position.factor, position.room) == (1.0, 2.0, 2.0)
    assert (attitude.factor, attitude.room) == (None, math.inf)
    assert attitude.columns() == {"attitude_error_limit": 1e-3}
    assert load.factor == pytest.approx(0.9 / 0.8)
    assert load.room == pytest.approx(0.8 / 0.9)  # less than its least value, so that it has left its range
    assert margins([one], None) == ()


def test_records_have_no_limit_where_no_run_is_expected_to_keep_any(folder: Path) -> None:
    verdicts = [verdict for verdict in judgement.judge(store.read(folder)) if verdict.run.case == "slide"]
    assert not any(name.endswith(("_limit", "_margin")) for row in judgement.records(verdicts) for name in row)
