"""Reports of several folders: what has changed between them."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pandas as pd
import pytest

from bodycheck.judging import result_set
from bodycheck.reports.lines import assign
from bodycheck.results.key import RunKey
from bodycheck.results.store import RECORDS
from tests.support import journals, saved_results
from tests.support.saved_results import call, move
from tests.support.wording import facts

#: What the finding on the runs in common may name.
COMPARED = ("before", "after", "to the last bit", "rounding", "same status")

Record = dict[str, Any]


@pytest.fixture
def copy(tmp_path_factory: pytest.TempPathFactory, tmp_path: Path) -> Callable[..., Path]:
    """Makes a copy of the results of runs, under another name, changed as the records of its journal are."""
    saved = saved_results.made(tmp_path_factory, "run")

    def made(name: str, records: Callable[[Record], Record | None] | None = None) -> Path:
        folder = tmp_path / name
        shutil.copytree(saved / "run", folder)
        if records is not None:
            journals.edit(folder / RECORDS, records)
        return folder

    return made


def markdown(folder: Path) -> str:
    return (folder / "report.md").read_text()


def is_run(record: Record, **values: Any) -> bool:
    return record["record"] == "run" and all(record[name] == value for name, value in values.items())


def compared(*folders: Path) -> tuple[str, Record]:
    """The text and the document of a report of several folders."""
    out = folders[0].parent / "compared"
    call("report", *folders, "--out", out)
    return markdown(out), json.loads((out / "results.json").read_text())


def finding(document: Record, subject: str) -> str:
    return "\n".join(found["text"] for found in document["findings"] if found["subject"] == subject)


def test_results_that_are_the_same_agree_to_the_last_bit(copy: Callable[..., Path]) -> None:
    text, document = compared(copy("before"), copy("after"))
    completed = [run for run in document["runs"] if run["status"] == "ok" and run["set"] == "before"]
    runs = len(document["runs"]) // 2
    assert document["headline"] == f"No difference in {runs} common runs"
    names = ("before", "after", "same versions", "same machine")
    assert facts(document["findings"][0]["text"], *names) == list(names)
    assert facts(document["findings"][1]["text"], *COMPARED)[3:10] == [
        *(str(len(completed)), "to the last bit", "0", "rounding", "0"),
        *(str(runs - len(completed)), "same status"),
    ]
    assert not any(finding(document, subject) for subject in ("Changed", "Status", "In one only"))
    assert "mujoco Euler 10 ms (before)" in text


def test_changes_are_told_with_their_numbers_the_largest_first(copy: Callable[..., Path]) -> None:
    before, after = copy("before"), copy("after")
    move(after, 0.25)
    move(after, 1e-4, timestep=0.005)
    move(after, 2e-15, along="z", integrator="Euler")  # a roundoff of z, of which a hundred steps may make more
    _, document = compared(before, after)
    rows = {(run["set"], run["integrator"], run["timestep"]): run for run in document["runs"] if run["case"] == "spin"}
    assert document["headline"].startswith("2 of ")
    largest, smaller = finding(document, "Changed").splitlines()
    names = ("spin", "position error", "mujoco RK4")
    assert [facts(text, *names)[:4] for text in (largest, smaller)] == [[*names, "10"], [*names, "5"]]
    assert facts(largest)[-1] == "0.25"
    assert rows["after", "Euler", 0.01]["position_error"] != rows["before", "Euler", 0.01]["position_error"]
    told = facts(document["findings"][1]["text"], *COMPARED, "worse", "better")
    assert told[4:12] == ["to the last bit", "1", "rounding", "2", "2", "worse", "0", "better"]
    assert any("nudged" in notice for notice in document["notices"])
    assert [found["case"] for found in document["findings"] if found["subject"] == "Changed"] == ["spin", "spin"]


def test_two_releases_of_an_engine_are_compared_with_each_other(copy: Callable[..., Path]) -> None:
    """The command names an engine in an environment of its own with its release: mujoco@3.2.0."""

    def earlier(record: Record) -> Record:
        if record["record"] == "header":
            engines = {"mujoco@3.2.0" if name == "mujoco" else name: "3.2.0" for name in record["engines"]}
            return record | {"engines": engines}
        return record | {"engine": "mujoco@3.2.0"} if record["record"] == "run" and record["engine"] == "mujoco" else record

    before, after = copy("before", earlier), copy("after")
    for file in before.glob("trajectories/*/mujoco-*"):
        file.rename(file.with_name(file.name.replace("mujoco-", "mujoco%403.2.0-")))
    move(after, 0.25)
    _, document = compared(before, after)
    runs = sum(run["set"] == "after" for run in document["runs"])
    assert document["headline"] == f"1 of {runs} common runs differs"
    assert finding(document, "In one only") == ""
    assert "mujoco@" not in finding(document, "Sets") + finding(document, "Changed")
    assert facts(finding(document, "Changed"), "spin", "mujoco RK4")[:3] == ["spin", "mujoco RK4", "10"]


def test_a_run_that_ends_otherwise_or_is_in_one_set_only_is_told_of(copy: Callable[..., Path]) -> None:
    def change(record: Record) -> Record | None:
        if record["record"] == "run" and is_run(record, case="spin", integrator="RK4", timestep=0.01):
            return record | {"status": "crashed", "reason": "it died"}
        return None if record["record"] == "run" and is_run(record, case="slide", integrator="RK4") else record

    _, document = compared(copy("before"), copy("after", change))
    names = ("spin", "mujoco RK4", "ok", "crashed", "it died", "before", "after")
    assert facts(finding(document, "Status"), *names) == ["spin", "mujoco RK4", "10", "ok", "crashed", "it died"]
    assert facts(finding(document, "In one only"), *names) == ["2", "before", "mujoco RK4"]


def test_an_engine_may_have_runs_in_the_first_set_only(copy: Callable[..., Path]) -> None:
    def without(record: Record) -> Record | None:
        return None if record["record"] == "run" and record["engine"] == "raising" else record

    text, document = compared(copy("before"), copy("after", without))
    runs = [(run["set"], run["timestep"]) for run in document["runs"] if run["engine"] == "raising" and run["case"] == "spin"]
    assert runs == [("before", 0.01), ("before", 0.005)]
    assert facts(finding(document, "In one only"), "before", "after", "raising closed-form")[:3] == [
        "4",
        "before",
        "raising closed-form",
    ]
    (head,) = {line for line in text.splitlines() if line.startswith("| Case |") and "raising" in line}
    columns = [cell.strip() for cell in head.split("|")]
    assert "raising closed-form after" not in columns
    (spin,) = [
        line.split("|") for line in text.splitlines() if line.startswith("| spin |") and line.count("|") == head.count("|")
    ]
    assert spin[columns.index("raising closed-form before")].strip() == "✗ crashed, ✗ crashed (5 ms)"


def test_versions_and_machines_are_told(copy: Callable[..., Path]) -> None:
    def elsewhere(record: Record) -> Record:
        if record["record"] == "header":
            versions = record["engines"] | {"mujoco": "0.0.1"}
            return record | {"engines": versions, "machine": record["machine"] | {"processor": "abacus"}}
        return record | {"wall_time": 100.0} if record.get("wall_time") else record

    before = copy("before")
    text, document = compared(before, copy("after", elsewhere))
    was = json.loads((before / RECORDS).read_text().splitlines()[0])
    assert f"mujoco 0.0.1 instead of {was['engines']['mujoco']}" in document["findings"][0]["text"]
    assert f"processor abacus instead of {was['machine']['processor']}" in document["findings"][0]["text"]
    assert f"mujoco {was['engines']['mujoco']} (before), 0.0.1 (after)" in text


def test_no_finding_is_made_of_times_that_were_measured_once_beside_other_runs(copy: Callable[..., Path]) -> None:
    def slower(record: Record) -> Record:
        return record | {"wall_time": 3 * record["wall_time"]} if is_run(record, engine="mujoco", integrator="RK4") else record

    _, document = compared(copy("before"), copy("after", slower))
    assert finding(document, "Cost") == ""
    assert not any("slower" in found["text"] or "A step takes" in found["text"] for found in document["findings"])


def test_another_case_of_the_same_name_is_not_compared(copy: Callable[..., Path]) -> None:
    def heavier(record: Record) -> Record:
        if record["record"] != "header":
            return record
        texts = [
            case
            | {"text": case["text"].replace("mass = 1.0", "mass = 2.0") + ("# a comment\n" if case["name"] == "slide" else "")}
            if case["name"] == "spin"
            else case | {"text": case["text"] + "# a comment\n"}
            for case in record["cases"]
        ]
        return record | {"cases": texts}

    before, after = copy("before"), copy("after", heavier)
    move(after, 0.25)
    text, document = compared(before, after)
    names = ("spin", "slide", "before", "after", "body.mass")
    told = [facts(notice, *names) for notice in document["notices"]]
    assert ["spin", "before", "after", "body.mass", "1.0", "2.0"] in told
    assert ["slide", "before", "after"] in told
    assert finding(document, "Changed") == ""
    slides = sum(run["case"] == "slide" and run["set"] == "before" for run in document["runs"])
    assert facts(document["findings"][1]["text"], "before", "after")[:3] == [str(slides), "before", "after"]
    for number, label in ((1, "before"), (2, "after")):
        assert f"spin@\u2060{number}" in text
        assert f"A sphere that spins and falls ({label})" in text
    assert finding(document, "In one only") == ""


def test_tables_and_junit_tell_sets_apart(copy: Callable[..., Path], tmp_path: Path) -> None:
    out, first = tmp_path / "out", copy("before")
    call("report", first, copy("after"), "--out", out, "--junit", tmp_path / "junit.xml")
    alone = pd.read_csv(first / "results.csv")
    for frame in (pd.read_csv(out / "results.csv"), pd.read_parquet(out / "results.parquet")):
        assert list(frame.columns) == ["set", *alone.columns]
        assert list(frame["set"]) == ["before"] * len(alone) + ["after"] * len(alone)
    origins = pd.read_csv(out / "attribution.csv")
    assert origins.columns[0] == "set"
    assert set(origins["set"]) == {"before", "after"}
    names = [(test.get("classname"), test.get("name")) for test in ElementTree.parse(tmp_path / "junit.xml").iter("testcase")]
    assert len(set(names)) == len(names)


def test_labels_are_the_shortest_ends_of_paths_that_differ(tmp_path: Path) -> None:
    assert result_set.labels([tmp_path / "a"]) == [""]
    assert result_set.labels([tmp_path / "a", tmp_path / "b"]) == ["a", "b"]
    assert result_set.labels([tmp_path / "3.1" / "out", tmp_path / "3.2" / "out"]) == ["3.1/out", "3.2/out"]


def test_sets_keep_the_hue_of_an_engine_and_are_drawn_apart() -> None:
    methods = [(engine, f"i{k}", step) for engine in ("mujoco", "pinocchio") for k in range(8) for step in (0.002, 0.001)]
    lines = assign(RunKey.of_method(*method, label) for method in methods for label in ("before", "between", "after"))
    assert len({(line.colour, line.dash, line.width) for line in lines.values()}) == len(lines)
    alone = assign(RunKey.of_method(*method) for method in methods)
    for method in methods:
        before, between, after = (lines[RunKey.of_method(*method, label)] for label in ("before", "between", "after"))
        one = alone[RunKey.of_method(*method)]
        assert (after.colour, after.width) == (one.colour, one.width)
        assert before.dash == between.dash == after.dash == one.dash
        assert before.width > 1.5 * between.width / 1.2 > after.width
        assert before.label == f"{one.label} (before)"
