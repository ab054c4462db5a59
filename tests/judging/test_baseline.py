"""Baselines: what has changed is told, and what rounding does is not."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from bodycheck import Case, load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import parse
from bodycheck.errors import BadInput
from bodycheck.judging import judgement
from bodycheck.judging.baselines import baseline, difference, rounding
from bodycheck.judging.baselines.baseline import ALLOWANCE, FIGURES, Baseline
from bodycheck.judging.baselines.difference import Difference
from bodycheck.reference.integration.sensitivity import growth
from bodycheck.results.key import RunKey
from bodycheck.running.plan import plan
from tests.support import campaigns
from tests.support.campaigns import records
from tests.support.commands import Done, bodycheck
from tests.support.processes import calls_here
from tests.support.wording import facts

WHOLE = load("intermediate-axis-flip").text.partition("[[expect]]")[0]
#: Half of it, with nothing expected.
FLIP = parse(WHOLE.replace("duration = 10.0", "duration = 5.0").replace("samples = 1001", "samples = 101"), "flip")

STEP = 0.005
U = 2.0**-53


def saved(path: Path, cases: list[Case], engines: tuple[str, ...] = ("mujoco",), integrators: tuple[str, ...] = ()) -> Path:
    with calls_here():
        results = campaigns.results(plan(cases, records(*engines), integrators, (STEP,)), path.with_suffix(""))
        baseline.save(path, results, judgement.judge(results), jobs=1)
    return path


@pytest.fixture(scope="module")
def flips(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The flip with MuJoCo's Euler and RK4."""
    return saved(tmp_path_factory.mktemp("flips") / "base.parquet", [FLIP], integrators=("Euler", "RK4"))


@pytest.fixture(scope="module")
def base(flips: Path) -> Baseline:
    return baseline.read(flips)


def diff(*arguments: object, **environment: str) -> Done:
    return bodycheck("diff", *arguments, **environment)


def edited(path: Path, to: Path, change: Callable[[pa.Table], pa.Table]) -> Path:
    table = pq.read_table(path)
    pq.write_table(change(table).replace_schema_metadata(table.schema.metadata), to)
    return to


def times(column: str, factor: float) -> Callable[[pa.Table], pa.Table]:
    def change(table: pa.Table) -> pa.Table:
        return table.set_column(table.column_names.index(column), column, pc.multiply(table[column], factor))

    return change


def only(found: Baseline, integrator: str, called: str) -> Baseline:
    """The rows of one integrator, as if they were those of a method of another name."""
    rows = {
        replace(key, method=Method.parse(called, key.method.timestep)): row
        for key, row in found.rows.items()
        if key.method.name == integrator
    }
    return replace(found, rows=rows)


def with_row(found: Baseline, **entries: Any) -> Baseline:
    """With some entries of the row of RK4 replaced."""
    return replace(found, rows={key: row | entries if key.method.name == "RK4" else row for key, row in found.rows.items()})


def test_a_run_against_itself_has_one_line_that_says_so(flips: Path) -> None:
    nothing = "no change in 2 runs beyond rounding and the truth's own error"
    done = diff(flips, flips)
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{nothing}\n", "")
    told = json.loads(diff(flips, flips, "--json").stdout)
    assert "attitude_error" in told.pop("compared")
    counts = {"worse": 0, "failed": 0, "runs": 2}
    assert told == counts | {"changes": [], "versions": {}, "redefined": [], "text": nothing}


def test_a_comparison_of_no_figure_is_no_success(flips: Path, tmp_path: Path) -> None:
    """Both baselines have the same runs, which the engine does not support, so that no figure can have changed."""

    def unsupported(table: pa.Table) -> pa.Table:
        figures = [name for name in table.column_names if name.removesuffix(ALLOWANCE) in FIGURES]
        column = table.column_names.index("status")
        return table.drop_columns(figures).set_column(column, "status", pa.array(["unsupported"] * len(table)))

    nothing = edited(flips, tmp_path / "nothing.parquet", unsupported)
    done = diff(nothing, nothing)
    why = "no run of both baselines has a figure that could be compared"
    assert (done.returncode, done.stdout) == (1, f"nothing was compared: {why}\n")
    assert done.stderr == f"bodycheck: there is no result: not compared: {why}\n"


def test_a_run_made_again_has_not_changed(base: Baseline, tmp_path: Path) -> None:
    again = baseline.read(saved(tmp_path / "again.parquet", [FLIP], integrators=("Euler", "RK4")))
    assert difference.diff(base, again).changes == ()
    assert set(again.rows) == set(base.rows)


def test_an_allowance_is_what_the_motion_makes_of_rounding(base: Baseline) -> None:
    """No more than the variational equations make of it, so that an error of 1e-8 rad is still seen to grow."""
    (row,) = [row for key, row in base.rows.items() if key.method.name == "RK4"]
    carried = growth(FLIP.scene, FLIP.instants).of_any.max()
    rounded = U * np.sqrt(row["steps"]) * carried
    linear = U * row["steps"] * 10.0 * FLIP.duration  # of the angle that is turned, at 10 rad/s
    allowed = row["attitude_error" + ALLOWANCE]
    # The nudges are of position, velocity, attitude and rates at once; both terms are allowed `MARGIN` times.
    assert rounding.MARGIN * linear < allowed < rounding.MARGIN * (2 * rounded + 1.1 * linear) + row["truth_error"]
    assert allowed < row["attitude_error"]


def test_what_got_worse_is_told_in_one_sentence_and_fails(base: Baseline) -> None:
    worse = difference.diff(only(base, "RK4", "RK4"), only(base, "Euler", "RK4"))
    (attitude,) = [change for change in worse.changes if change.what == "attitude_error"]
    assert (attitude.direction, attitude.base, attitude.now) == (
        "worse",
        *(row["attitude_error"] for name in ("RK4", "Euler") for key, row in base.rows.items() if key.method.name == name),
    )
    figures = [f"{number:.3g}" for number in (attitude.base, attitude.now, attitude.now / attitude.base)]
    run = ["mujoco RK4", "intermediate-axis-flip", "0.005"]
    assert facts(attitude.text, *run[:2], "attitude_error", "times worse") == [*run, "attitude_error", *figures, "times worse"]
    assert facts(worse.text, *run[:2], "worse")[:5] == ["1", "worse", *run]
    better = difference.diff(only(base, "Euler", "RK4"), only(base, "RK4", "RK4"))
    assert {change.direction for change in better.changes} == {"better"}
    assert better.worse == ()


def test_exit_codes(flips: Path, tmp_path: Path) -> None:
    larger = edited(flips, tmp_path / "larger.parquet", times("attitude_error", 1.5))
    worse = diff(flips, larger)
    assert worse.returncode == 1
    assert "1.5 times worse" in worse.stdout.splitlines()[-1]
    worst = worse.stdout.splitlines()[-1].removeprefix("runs: 2 worse; ")
    assert [line.split()[1:3] for line in worse.stdout.splitlines()[1:3]] == [["mujoco", "Euler"], ["mujoco", "RK4"]]
    tolerated = diff(flips, larger, "--fail-on", "attitude_error:60%")
    names = ("nothing", "attitude_error")
    assert (tolerated.returncode, facts(tolerated.stdout.splitlines()[-1], *names)) == (0, [*names, "60"])
    beyond = diff(flips, larger, "--fail-on", "attitude_error:40%")
    first, last = beyond.stdout.splitlines()[-2:]
    assert (beyond.returncode, first) == (1, worse.stdout.splitlines()[-1])
    assert facts(last, "not", "attitude_error")[:4] == ["2", "not", "attitude_error", "40"]
    assert last.endswith(f"; {worst}")
    better = diff(larger, flips)
    assert better.returncode == 0
    assert "1.5 times better" in better.stdout
    told = json.loads(diff(flips, larger, "--json").stdout)
    assert (told["worse"], {change["what"] for change in told["changes"]}) == (2, {"attitude_error"})
    in_workflow = diff(flips, larger, GITHUB_ACTIONS="true")
    assert in_workflow.stderr.startswith("::error title=bodycheck diff::")
    assert facts(in_workflow.stderr.partition("diff::")[2], "worse", "mujoco")[:3] == ["2", "worse", "mujoco"]


def statuses(found: Difference) -> list[tuple[str, Any, Any, str]]:
    return [(change.what, change.base, change.now, change.direction) for change in found.changes]


def test_statuses_and_runs_that_come_and_go(base: Baseline) -> None:
    diverged, unsupported = (with_row(base, status=status) for status in ("diverged", "unsupported"))
    assert statuses(difference.diff(base, diverged)) == [("status", "ok", "diverged", "worse")]
    assert statuses(difference.diff(diverged, base)) == [("status", "diverged", "ok", "better")]
    assert statuses(difference.diff(base, unsupported)) == [("status", "ok", "unsupported", "worse")]
    assert statuses(difference.diff(diverged, unsupported)) == [("status", "diverged", "unsupported", "better")]
    fewer = only(base, "Euler", "Euler")
    gone, new = difference.diff(base, fewer), difference.diff(fewer, base)
    assert statuses(gone) == [("run", "ok", None, "worse")]
    names = ("mujoco RK4", "intermediate-axis-flip", "not run")
    assert facts(gone.changes[0].text, *names) == ["mujoco RK4", "intermediate-axis-flip", "0.005", "not run"]
    assert statuses(new) == [("run", None, "ok", "new")]
    assert new.worse == ()


def test_a_load_is_right_where_it_is_one_weight(base: Baseline) -> None:
    loads = [with_row(base, mean_load=load, mean_load_allowance=1e-9) for load in (0.5, 0.9, 1.1)]
    assert statuses(difference.diff(loads[0], loads[1])) == [("mean_load", 0.5, 0.9, "better")]
    assert statuses(difference.diff(loads[1], loads[0])) == [("mean_load", 0.9, 0.5, "worse")]


def test_a_small_change_is_told_with_the_digits_it_takes(base: Baseline) -> None:
    one, other = (with_row(base, energy_drift=value, energy_drift_allowance=1e-15) for value in (0.25, 0.25 + 1e-10))
    (change,) = difference.diff(one, other).changes
    names = ("energy_drift", "worse")
    assert facts(change.text, *names)[-5:] == ["energy_drift", "0.25", "0.2500000001", "worse", "4e-10"]
    (change,) = difference.diff(with_row(base, energy_drift=0.0, energy_drift_allowance=1e-15), one).changes
    assert facts(change.text, *names)[-4:] == ["energy_drift", "0", "0.25", "worse"]


def test_figures_of_another_definition_are_named_and_not_compared(flips: Path, base: Baseline, tmp_path: Path) -> None:
    assert base.revisions == {"energy_drift": 2, "energy_error": 2}
    assert difference.diff(base, base).redefined == ()
    earlier = replace(with_row(base, energy_drift=0.0, energy_drift_allowance=0.0), revisions={})
    for found in (difference.diff(earlier, base), difference.diff(base, earlier)):
        assert found.changes == ()
        assert found.redefined == ("energy_drift",)  # a flip without drag has no energy error
        assert difference.as_json(found)["redefined"] == ["energy_drift"]
    changed = with_row(earlier, status="crashed")
    assert statuses(difference.diff(changed, base)) == [("status", "crashed", "ok", "better")]
    # Files of earlier versions have no revisions.
    table = pq.read_table(flips)
    told = json.loads(table.schema.metadata[baseline.METADATA])
    del told["revisions"]
    old = tmp_path / "old.parquet"
    pq.write_table(table.replace_schema_metadata({baseline.METADATA: json.dumps(told)}), old)
    assert baseline.read(old).revisions == {}
    done = bodycheck("diff", old, flips)
    assert done.returncode == 0
    redefined, same = done.stdout.splitlines()
    assert facts(redefined, "not compared", "energy_drift") == ["not compared", "energy_drift"]
    assert facts(same, "no change", "rounding") == ["no change", "2", "rounding"]


def test_versions_are_named(base: Baseline) -> None:
    older = replace(base, header={**base.header, "engines": {"mujoco": "3.2.0"}})
    now = base.header["engines"]["mujoco"]
    assert difference.diff(older, with_row(base, status="crashed")).text.endswith(f"; mujoco 3.2.0 → {now}")
    assert difference.diff(older, base).changes == ()


def test_no_change_is_made_of_times_per_step(flips: Path, base: Baseline, tmp_path: Path) -> None:
    assert not [name for row in base.rows.values() for name in row if name.startswith("time_per_step_")]
    slower = edited(flips, tmp_path / "slower.parquet", times("time_per_step", 100.0))
    # Baselines of earlier versions have the times of the nudged runs too.
    table = pq.read_table(slower)
    for name in ("time_per_step_low", "time_per_step_high"):
        table = table.append_column(name, pc.multiply(table["time_per_step"], 1.0))
    pq.write_table(table, slower)
    assert diff(flips, slower).stdout.startswith("no change in 2 runs")


def test_the_worst_change_comes_first(base: Baseline) -> None:
    allowed = {"attitude_error_allowance": 1e-9, "energy_drift_allowance": 1e-9}
    before = with_row(base, attitude_error=1e-3, energy_drift=0.0, position_error=1e-3, **allowed)
    after = with_row(before, attitude_error=5e-3, energy_drift=2e-9, position_error=2e-3)
    figures = [change.what for change in difference.diff(before, after).changes]
    # From 0 to twice the allowance is no more than a factor of 2, though the quotient is infinite.
    assert figures == ["attitude_error", *sorted(figures[1:], key=["energy_drift", "position_error"].index)]
    euler = {key: row | {"status": "crashed"} if key.method.name == "Euler" else row for key, row in after.rows.items()}
    assert difference.diff(before, replace(after, rows=euler)).changes[0].what == "status"
    gone = {key: row for key, row in after.rows.items() if key.method.name == "RK4"}
    assert difference.diff(before, replace(after, rows=gone)).changes[0].what == "run"


def fails(base: Baseline, now: Baseline, *asked: str) -> list[str]:
    return [change.what for change in difference.failing(difference.diff(base, now), difference.tolerances_of(asked))]


def test_named_figures_fail_beyond_their_fraction_alone(base: Baseline) -> None:
    (row,) = [row for key, row in base.rows.items() if key.method.name == "RK4"]
    worse = with_row(base, attitude_error=1.2 * row["attitude_error"], energy_drift=3.0 * row["energy_drift"])
    assert sorted(fails(base, worse)) == ["attitude_error", "energy_drift"]
    assert fails(base, worse, "attitude_error:10%") == ["attitude_error"]
    assert fails(base, worse, "attitude_error:25%") == []
    assert fails(base, worse, "attitude_error:25%", "energy_drift:199%") == ["energy_drift"]
    assert fails(worse, base, "attitude_error:0%") == []
    # What is not a figure is never tolerated.
    assert fails(base, with_row(worse, status="diverged"), "attitude_error:1000%") == ["status"]
    assert fails(base, only(base, "RK4", "RK4"), "attitude_error:1000%") == ["run"]
    from_nothing = with_row(base, attitude_error=0.0, attitude_error_allowance=1e-12)
    assert fails(from_nothing, base, "attitude_error:1000%") == ["attitude_error"]


def test_a_named_figure_that_is_not_compared_is_no_success(base: Baseline) -> None:
    with pytest.raises(BadInput, match=r"--fail-on energy_error: no run of both baselines has it; allowed: .*attitude_error"):
        fails(base, base, "energy_error:10%")
    with pytest.raises(BadInput, match="--fail-on energy_drift: its definition has changed"):
        fails(replace(base, revisions={}), base, "energy_drift:10%")


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (["attitude:10%"], "no figure 'attitude'; did you mean 'attitude_error'"),
        (["attitude_error"], "allowed: the figure and a percentage"),
        (["attitude_error:10"], "allowed: the figure and a percentage of at least 0, for example attitude_error:10%"),
        (["attitude_error:nan%"], "allowed: the figure and a percentage"),
        (["attitude_error:-1%"], "allowed: the figure and a percentage"),
        (["attitude_error:1%", "attitude_error:2%"], "is given twice"),
    ],
)
def test_a_tolerance_that_says_nothing_is_refused(asked: list[str], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        difference.tolerances_of(asked)


def test_another_case_of_the_same_name_is_refused(base: Baseline, flips: Path, tmp_path: Path) -> None:
    text = FLIP.text
    assert baseline.identity(FLIP) == base.cases[FLIP.name]
    told_otherwise = text.replace("title = ", "# to be read\ntitle = ").partition("[[expect]]")[0]
    assert baseline.identity(parse(told_otherwise, "flip")) == baseline.identity(FLIP)
    heavier = parse(text.replace("mass = 1.0", "mass = 2.0"), "flip")
    assert baseline.identity(heavier) != baseline.identity(FLIP)
    told = "the case itself has changed, save a new baseline: intermediate-axis-flip"
    other = replace(base, cases={FLIP.name: baseline.identity(heavier)}, keys={FLIP.name: baseline.keys(heavier)})
    with pytest.raises(BadInput, match=rf"^{told} \(body.mass 1.0 → 2.0\)$"):
        difference.diff(base, other)
    # Files of earlier versions do not say what the keys were.
    with pytest.raises(BadInput, match=f"^{told}$"):
        difference.diff(replace(base, keys={}), other)


def not_baselines(folder: Path) -> Iterator[Path]:
    yield folder / "missing.parquet"
    (folder / "text.parquet").write_text("no table")
    yield folder / "text.parquet"
    pq.write_table(pa.table({"case": ["a"]}), folder / "table.parquet")
    yield folder / "table.parquet"
    told = {baseline.METADATA: b'{"format": 99, "header": {}, "cases": {}}'}
    pq.write_table(pa.table({"case": ["a"]}).replace_schema_metadata(told), folder / "later.parquet")
    yield folder / "later.parquet"
    yield folder


def test_what_is_no_baseline_is_refused(flips: Path, tmp_path: Path) -> None:
    for path in not_baselines(tmp_path):
        with pytest.raises(BadInput, match="not a baseline of `bodycheck run --save`"):
            baseline.read(path)
    done = diff(flips, tmp_path / "missing.parquet")
    assert (done.returncode, done.stdout) == (2, "")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("attitude_error", "x"),
        ("attitude_error_allowance", [1.0]),
        ("status", b"ok"),
        ("timestep", np.nan),
    ],
)
def test_a_baseline_with_a_value_that_no_run_has_is_refused(flips: Path, tmp_path: Path, column: str, value: object) -> None:
    table = pq.read_table(flips)
    assert column in table.column_names
    changed = table.set_column(table.column_names.index(column), column, pa.array([value] * len(table)))
    pq.write_table(changed, tmp_path / "changed.parquet")
    with pytest.raises(BadInput, match=f"not a baseline of `bodycheck run --save`: '?{column}"):
        baseline.read(tmp_path / "changed.parquet")


@pytest.mark.parametrize("change", [{"header": {"engines": "x"}}, {"cases": {"spin": 1}}, {"cases": 1}])
def test_a_baseline_with_other_metadata_is_refused(flips: Path, tmp_path: Path, change: dict[str, object]) -> None:
    table = pq.read_table(flips)
    told = json.loads(table.schema.metadata[baseline.METADATA])
    for name, value in change.items():
        told[name] = told[name] | value if name == "header" and isinstance(value, dict) else value
    pq.write_table(table.replace_schema_metadata({baseline.METADATA: json.dumps(told)}), tmp_path / "changed.parquet")
    with pytest.raises(BadInput, match=r"'(header', 'engines|cases)'.*: Input should be a valid"):
        baseline.read(tmp_path / "changed.parquet")


def test_run_saves(calls_here: None, tmp_path: Path) -> None:
    def run(*arguments: object) -> Done:
        return bodycheck("run", "projectile", "--engine", "mujoco", "--integrator", "RK4", *arguments)

    done = run("--save", tmp_path / "base.parquet")
    assert done.returncode == 0, done.stderr
    found = baseline.read(tmp_path / "base.parquet")
    assert set(found.rows) == {RunKey("projectile", "mujoco", Method.parse("RK4", 0.002))}
    assert found.header["engines"] == {"mujoco": registry.load("mujoco").engine.version}
    assert found.header["machine"]["processor"]
    nowhere = run("--save", tmp_path / "nowhere" / "base.parquet")
    assert (nowhere.returncode, nowhere.stdout) == (2, "")
    assert "--save" in nowhere.stderr
