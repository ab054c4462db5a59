"""`bodycheck report`: reports made again from saved results, of one set or of several, and folders that hold none."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow.parquet as pq
import pytest

from bodycheck.errors import BadInput
from bodycheck.results.store import RECORDS
from bodycheck.studies.extremes.rows import RECORDS as EXTREMES
from bodycheck.studies.recommend.rows import RECORDS as RECOMMEND
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
            journals.edit(folder / RECORDS, records)
        return folder

    return made


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def markdown(folder: Path) -> str:
    return (folder / "report.md").read_text()


#: What has no part in a report: engines, and what runs them.
BANNED = ("mujoco", "pinocchio", "bodycheck.adapters.registry", "bodycheck.running.simulation", "bodycheck.processes.pool")

#: Makes reports where nothing of that can be imported, and tells what is imported of adapters.
AGAIN = f"""
import json, sys
sys.modules.update(dict.fromkeys({BANNED}))
from bodycheck.commands.command_line import app
options = {{"exit_on_error": False, "print_error": False, "result_action": "return_value"}}
codes = [app(["report", folder], **options) for folder in sys.argv[1:]]
print(json.dumps([codes, [name for name in sys.modules if name.startswith("bodycheck.adapters.")]]))
"""


@pytest.fixture(scope="module")
def again(saved: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, int], list[str]]:
    """A folder with copies of all results whose reports and tables were removed and made again in a process without engines,
    the exit codes of the commands, and the modules of adapters that were imported.
    """
    place = tmp_path_factory.mktemp("again")
    for kind in KINDS:
        shutil.copytree(saved / kind, place / kind)
        for name in (*REPORT, *TABLES):
            (place / kind / name).unlink(missing_ok=True)
    command = [sys.executable, "-c", AGAIN, *(str(place / kind) for kind in KINDS)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    codes, imported = json.loads(done.stdout.splitlines()[-1])
    return place, dict(zip(KINDS, codes, strict=True)), imported


@pytest.mark.parametrize("kind", KINDS)
def test_a_report_that_is_made_again_is_the_first_one_to_the_last_byte(
    kind: str, saved: Path, again: tuple[Path, dict[str, int], list[str]]
) -> None:
    place, codes, _ = again
    assert {*REPORT} <= contents(saved / kind).keys()
    assert codes[kind] == (1 if kind == "run" else 0)
    assert contents(place / kind) == contents(saved / kind)


def test_no_engine_is_needed_and_nothing_is_simulated(again: tuple[Path, dict[str, int], list[str]]) -> None:
    assert set(again[2]) == {
        "bodycheck.adapters.contract",
        "bodycheck.adapters.control_laws",
        "bodycheck.adapters.driving",
        "bodycheck.adapters.engine_name",
        "bodycheck.adapters.engine_record",
        "bodycheck.adapters.method",
        "bodycheck.adapters.roles",
        "bodycheck.adapters.scheduling",
        *(name for name in BANNED if "adapters" in name),
    }


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
        ("run", spoil(RECORDS, '", "integrator"', '", "integrated"'), "'integrator'"),
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
