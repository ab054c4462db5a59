"""`bodycheck report`: reports made again from saved results, of one set or of several, and folders that hold none."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bodycheck.commands.saved import EXTREMES, RECOMMEND
from bodycheck.errors import BadInput
from bodycheck.judging import result_set
from bodycheck.reports.lines import assign
from bodycheck.running.key import RunKey
from bodycheck.running.store import RECORDS
from tests.support import journals, saved_results
from tests.support.saved_results import REPORT, TABLES, call

Record = dict[str, Any]

KINDS = ("run", "tradeoff", "recommend", "extremes", "ablate")


@pytest.fixture(scope="session")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with results of runs and of each study, as the commands wrote them."""
    return saved_results.made(tmp_path_factory, *KINDS)


@pytest.fixture
def copy(saved: Path, tmp_path: Path) -> Callable[..., Path]:
    """Makes a copy of results, under another name, changed as records of its journal and as its text are."""

    def made(kind: str, name: str = "", records: Callable[[Record], Record | None] | None = None) -> Path:
        folder = tmp_path / (name or kind)
        shutil.copytree(saved / kind, folder)
        if records is not None:
            edit(folder / RECORDS, records)
        return folder

    return made


def edit(path: Path, change: Callable[[Record], Record | None]) -> None:
    """Change the records of a journal; None leaves one out."""
    header, *records, footer = journals.records(path)
    kept = [new for record in records if (new := change(record)) is not None]
    begin = change(header)
    assert begin is not None
    journals.write(path, [begin, *kept, {**footer, "records": len(kept)}])


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def markdown(folder: Path) -> str:
    return (folder / "report.md").read_text()


def changed(records: Callable[[Record], bool], **values: Any) -> Callable[[Record], Record]:
    return lambda record: record | values if records(record) else record


def is_run(record: Record, **values: Any) -> bool:
    return record["record"] == "run" and all(record[name] == value for name, value in values.items())


def move(folder: Path, by: float, along: str = "x", integrator: str = "RK4", timestep: float = 0.01) -> None:
    """Move the body of the spin by some metres in the stored trajectory of a run of MuJoCo."""
    path = folder / "trajectories" / "spin" / f"mujoco-{integrator}-{timestep!r}s.parquet"
    table = pq.read_table(path)
    moved = pa.array(table[along].to_numpy() + by)
    pq.write_table(table.set_column(table.column_names.index(along), along, moved), path)


@pytest.mark.parametrize("kind", KINDS)
def test_a_report_that_is_made_again_is_the_first_one_to_the_last_byte(kind: str, copy: Callable[..., Path]) -> None:
    folder = copy(kind)
    first = contents(folder)
    assert {*REPORT} <= first.keys()
    for name in (*REPORT, *TABLES):
        (folder / name).unlink(missing_ok=True)
    assert call("report", folder) == (1 if kind == "run" else 0)
    assert contents(folder) == first


def test_a_study_of_an_earlier_version_says_which_of_its_figures_had_another_definition(copy: Callable[..., Path]) -> None:
    def earlier(record: Record) -> Record:
        return {name: value for name, value in record.items() if name != "revisions"}

    now, before = copy("tradeoff", "now"), copy("tradeoff", "before", earlier)
    for folder in (now, before):
        assert call("report", folder) == 0
    told = r"The numbers of energy\_drift have another definition (relative to the initial energy, with a potential"
    assert told in markdown(before)
    assert "another definition" not in markdown(now)
    # The figures of runs are computed again from the trajectories.
    runs = copy("run", "runs", earlier)
    assert call("report", runs) == 1
    assert "another definition" not in markdown(runs)


def test_it_goes_where_it_is_asked_to_with_a_junit_file(saved: Path, tmp_path: Path) -> None:
    before = contents(saved / "run")
    out = tmp_path / "deep" / "out"
    assert call("report", saved / "run", "--out", out, "--junit", tmp_path / "junit.xml") == 1
    assert {path.name for path in out.iterdir()} == {*REPORT, *TABLES}
    assert (out / "report.html").read_bytes() == before["report.html"]
    assert (tmp_path / "junit.xml").read_bytes() == (saved / "junit.xml").read_bytes()
    assert contents(saved / "run") == before


def test_no_engine_is_needed_and_nothing_is_simulated(saved: Path, tmp_path: Path) -> None:
    banned = ("mujoco", "pinocchio", "bodycheck.adapters.registry", "bodycheck.running.simulation", "bodycheck.running.pool")
    code = (
        f"import sys\nsys.modules.update(dict.fromkeys({banned}))\n"
        "from bodycheck.commands.command_line import app\n"
        f"for kind in {KINDS}:\n"
        "    words = ['report', f'{sys.argv[1]}/{kind}', '--out', f'{sys.argv[2]}/{kind}']\n"
        "    app(words, exit_on_error=False, print_error=False, result_action='return_value')\n"
        "print([name for name in sys.modules if name.startswith('bodycheck.adapters.')])"
    )
    done = subprocess.run([sys.executable, "-c", code, saved, tmp_path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert set(eval(done.stdout)) == {
        "bodycheck.adapters.contract",
        "bodycheck.adapters.engine_name",
        "bodycheck.adapters.method",
        "bodycheck.adapters.options",
        *(n for n in banned if "adapters" in n),
    }
    for kind in KINDS:
        assert (tmp_path / kind / "report.html").read_bytes() == (saved / kind / "report.html").read_bytes()


def test_what_was_interrupted_is_reported_as_that(copy: Callable[..., Path], capsys: pytest.CaptureFixture[str]) -> None:
    folder = copy("run")
    lines = (folder / RECORDS).read_text().splitlines(keepends=True)
    (folder / RECORDS).write_text("".join(lines[:-3]))
    assert call("report", folder) == 2
    assert f"interrupted; the report contains the runs before the interruption: {folder}" in capsys.readouterr().err
    assert markdown(folder).startswith("# bodycheck: Interrupted. ")
    assert json.loads((folder / "results.json").read_text())["complete"] is False
    assert len(pd.read_csv(folder / "results.csv")) == sum('"record": "run"' in line for line in lines[:-3])


def spoil(name: str, old: str, new: str) -> Callable[[Path], None]:
    def spoiled(folder: Path) -> None:
        text = (folder / name).read_text()
        assert old in text
        if name.endswith(".jsonl"):
            journals.spoil(folder / name, lambda text: text.replace(old, new, 1))
        else:
            (folder / name).write_text(text.replace(old, new, 1))

    return spoiled


def cut(name: str, line: int) -> Callable[[Path], None]:
    def spoiled(folder: Path) -> None:
        lines = (folder / name).read_text().splitlines(keepends=True)
        del lines[line]
        (folder / name).write_text("".join(lines))

    return spoiled


def lose_a_trajectory(folder: Path) -> None:
    next(folder.glob("trajectories/spin/mujoco-*")).unlink()


def halve_a_trajectory(folder: Path) -> None:
    path = next(folder.glob("trajectories/spin/truth-*"))
    path.write_bytes(path.read_bytes()[:200])


def lose_a_column(folder: Path) -> None:
    path = next(folder.glob("trajectories/spin/mujoco-*"))
    pq.write_table(pq.read_table(path).drop_columns("qw"), path)


@pytest.mark.parametrize(
    ("kind", "damage", "words"),
    [
        ("run", lambda folder: shutil.rmtree(folder), "there is no such folder"),
        ("run", lambda folder: (folder / RECORDS).unlink(), "not a folder of results"),
        ("run", lambda folder: shutil.copy(folder / RECORDS, folder / EXTREMES), "exactly one of them"),
        ("run", spoil(RECORDS, '"status"', "status"), "not a journal"),
        ("run", spoil(RECORDS, '"format": 1', '"format": 7'), "its format is 7, not 1"),
        ("run", spoil(RECORDS, '"integrator"', '"integrated"'), "'integrator'"),
        ("run", spoil(RECORDS, '"machine"', '"mill"'), "'machine'"),
        ("run", spoil(RECORDS, "mass = 1.0", "mass = -1.0"), "body.mass"),
        ("run", spoil(RECORDS, '"status": "ok"', '"status": "well"'), "'well'"),
        ("run", cut(RECORDS, 3), "but its footer counts"),
        ("run", lose_a_trajectory, "cannot be read"),
        ("run", halve_a_trajectory, "cannot be read"),
        ("run", lose_a_column, "cannot be read"),
        ("tradeoff", cut(RECORDS, -1), "the study was interrupted"),
        ("tradeoff", cut("tradeoff.csv", 2), "does not list the same runs"),
        ("tradeoff", cut("tradeoff.csv", 0), "damaged"),
        ("tradeoff", spoil("orders.csv", "order_low", "low"), "damaged"),
        ("tradeoff", lambda folder: (folder / "orders.csv").unlink(), "orders.csv"),
        ("ablate", spoil("ablation.csv", "0.01,", "0.07,"), "does not list the same runs"),
        ("ablate", spoil("ablation.csv", ",relative_cost_low", ",low"), "'relative_cost_low'"),
        (
            "ablate",
            lambda folder: shutil.copy(folder / "ablation.csv", folder / "tradeoff.csv"),
            "only one can belong to these results",
        ),
        ("extremes", cut(EXTREMES, -1), "the study was interrupted"),
        ("extremes", cut("extremes.csv", 1), "does not list the same runs"),
        ("extremes", spoil("limits.csv", "spin_times_step", "turn"), "damaged"),
        ("recommend", cut(RECOMMEND, -1), "the study was interrupted"),
        ("recommend", spoil(RECOMMEND, "position_error", "place_error"), "damaged"),
        ("recommend", cut("recommend.csv", 1), "does not list the same methods"),
        ("recommend", spoil("steps.csv", "timestep", "step"), "damaged"),
    ],
)
def test_what_is_no_whole_folder_of_results_is_refused(
    kind: str, damage: Callable[[Path], None], words: str, copy: Callable[..., Path], tmp_path: Path
) -> None:
    folder = copy(kind)
    damage(folder)
    with pytest.raises(BadInput) as refused:
        call("report", folder, "--out", tmp_path / "out")
    assert words in str(refused.value)
    assert str(folder) in str(refused.value)
    assert not (tmp_path / "out" / "report.html").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("report",), "at least one folder"),
        (("report", "run", "copy"), "give --out"),
        (("report", "run", "copy/../run", "--out", "new"), "is given twice"),
        (("report", "run", "copy", "--out", "copy"), "its own report must not be overwritten"),
        (("report", "run", "tradeoff", "--out", "new"), "tradeoff: contains a study"),
        (("report", "tradeoff", "ablate", "--out", "new"), "tradeoff: contains a study"),
        (("report", "ablate", "--junit", "junit.xml"), "contains a study"),
        (("report", "run", "--junit", "nowhere/junit.xml"), "there is no folder nowhere"),
        (("report", "run/run.jsonl"), "is not a folder"),
        (("report", "run", "--out", "copy/run.jsonl"), "the folder cannot be made"),
        (("run", "--figures", "svg"), "--figures svg: needs --out"),
        (("tradeoff", "--figures", "png"), "--figures png: needs --out"),
        (("extremes", "--figures", "png"), "--figures png: needs --out"),
        (("ablate", "--figures", "png"), "--figures png: needs --out"),
    ],
)
def test_bad_usage_is_refused(
    words: tuple[str, ...], said: str, copy: Callable[..., Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for kind in ("run", "tradeoff", "ablate"):
        copy(kind)
    copy("run", "copy")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput, match=said):
        call(*words)
    assert not Path("new", "report.html").exists()


def compared(*folders: Path) -> tuple[str, Record]:
    """The text and the document of a report of several folders."""
    out = folders[0].parent / "compared"
    call("report", *folders, "--out", out)
    return markdown(out), json.loads((out / "results.json").read_text())


def finding(document: Record, subject: str) -> str:
    return "\n".join(found["text"] for found in document["findings"] if found["subject"] == subject)


def test_results_that_are_the_same_agree_to_the_last_bit(copy: Callable[..., Path]) -> None:
    text, document = compared(copy("run", "before"), copy("run", "after"))
    completed = [run for run in document["runs"] if run["status"] == "ok" and run["set"] == "before"]
    runs = len(document["runs"]) // 2
    assert document["headline"] == f"No difference in {runs} common runs"
    assert document["findings"][0]["text"] == "before and after were made with the same versions on the same machine."
    assert f"{len(completed)} agree in every number to the last bit, 0 agree within" in document["findings"][1]["text"]
    assert f"and 0 differ. {runs - len(completed)} ended with the same status" in document["findings"][1]["text"]
    assert not any(finding(document, subject) for subject in ("Changed", "Status", "In one only"))
    assert "mujoco Euler 10 ms (before)" in text


def test_changes_are_told_with_their_numbers_the_largest_first(copy: Callable[..., Path]) -> None:
    before, after = copy("run", "before"), copy("run", "after")
    move(after, 0.25)
    move(after, 1e-4, timestep=0.005)
    move(after, 2e-15, along="z", integrator="Euler")  # a roundoff of z, of which a hundred steps may make more
    _, document = compared(before, after)
    rows = {(run["set"], run["integrator"], run["timestep"]): run for run in document["runs"] if run["case"] == "spin"}
    assert document["headline"].startswith("2 of ")
    largest, smaller = finding(document, "Changed").splitlines()
    assert largest.startswith("In spin, the position error of mujoco RK4 at 10 ms changed from ")
    assert largest.endswith(" to 0.25 m.")
    assert smaller.startswith("In spin, the position error of mujoco RK4 at 5 ms changed from ")
    assert rows["after", "Euler", 0.01]["position_error"] != rows["before", "Euler", 0.01]["position_error"]
    assert ", 1 agrees within the truth's own error and rounding, and 2 differ." in document["findings"][1]["text"]
    assert "larger in 2 and smaller in 0" in document["findings"][1]["text"]
    assert "no run was repeated from nudged initial states" in document["findings"][1]["text"]
    assert [found["case"] for found in document["findings"] if found["subject"] == "Changed"] == ["spin", "spin"]


def test_a_run_that_ends_otherwise_or_is_in_one_set_only_is_told_of(copy: Callable[..., Path]) -> None:
    def change(record: Record) -> Record | None:
        if record["record"] == "run" and is_run(record, case="spin", integrator="RK4", timestep=0.01):
            return record | {"status": "crashed", "reason": "it died"}
        return None if record["record"] == "run" and is_run(record, case="slide", integrator="RK4") else record

    _, document = compared(copy("run", "before"), copy("run", "after", change))
    assert finding(document, "Status") == "In spin, the status of mujoco RK4 at 10 ms changed from ok to crashed (it died)."
    assert finding(document, "In one only") == "2 runs are only in before: mujoco RK4 (2)."


def test_versions_and_machines_are_told(copy: Callable[..., Path]) -> None:
    def elsewhere(record: Record) -> Record:
        if record["record"] == "header":
            versions = record["engines"] | {"mujoco": "0.0.1"}
            return record | {"engines": versions, "machine": record["machine"] | {"processor": "abacus"}}
        return record | {"wall_time": 100.0} if record.get("wall_time") else record

    before = copy("run", "before")
    text, document = compared(before, copy("run", "after", elsewhere))
    was = json.loads((before / RECORDS).read_text().splitlines()[0])
    assert f"mujoco 0.0.1 instead of {was['engines']['mujoco']}" in document["findings"][0]["text"]
    assert f"processor abacus instead of {was['machine']['processor']}" in document["findings"][0]["text"]
    assert f"mujoco {was['engines']['mujoco']} (before), 0.0.1 (after)" in text


def test_no_finding_is_made_of_times_that_were_measured_once_beside_other_runs(copy: Callable[..., Path]) -> None:
    def slower(record: Record) -> Record:
        return record | {"wall_time": 3 * record["wall_time"]} if is_run(record, engine="mujoco", integrator="RK4") else record

    _, document = compared(copy("run", "before"), copy("run", "after", slower))
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

    before, after = copy("run", "before"), copy("run", "after", heavier)
    move(after, 0.25)
    text, document = compared(before, after)
    assert any("The case spin differs between before and after: body.mass 1.0 → 2.0." in told for told in document["notices"])
    alike = "The file of slide differs between before and after, but not in anything that affects the physics."
    assert alike in document["notices"]
    assert finding(document, "Changed") == ""
    slides = sum(run["case"] == "slide" and run["set"] == "before" for run in document["runs"])
    assert f"before and after have {slides} runs in common." in document["findings"][1]["text"]
    for number, label in ((1, "before"), (2, "after")):
        assert f"spin@\u2060{number}" in text
        assert f"A sphere that spins and falls ({label})" in text
    assert finding(document, "In one only") == ""


def test_tables_and_junit_tell_sets_apart(copy: Callable[..., Path], tmp_path: Path) -> None:
    out, first = tmp_path / "out", copy("run", "before")
    call("report", first, copy("run", "after"), "--out", out, "--junit", tmp_path / "junit.xml")
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
