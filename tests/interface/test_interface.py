"""The Python interface: what the commands measure, with their texts for bad arguments, for data frames and notebooks."""

import gc
import inspect
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import FrozenInstanceError, replace
from pathlib import Path
from typing import Any

import pytest

import bodycheck
from bodycheck import ExtremesResults, RecommendResults, RunResults, TradeoffResults
from bodycheck.casefile.case import parse
from bodycheck.interface.results import Results
from bodycheck.judging import judgement
from bodycheck.results import store
from bodycheck.studies import cost
from tests.support.cases import a_case
from tests.support.commands import bodycheck as command
from tests.support.commands import parameters_of
from tests.support.processes import calls_here

#: A brick that tumbles for half a second, for all functions; its axes give a map of four runs, and two limits, to a method.
TUMBLING = a_case(
    "tumbling",
    title="A brick that tumbles",
    body={"shape": "brick", "semi_axes": [0.1, 0.2, 0.3], "mass": 1.0},
    initial={"angular_velocity": [1.0, 2.0, 3.0]},
    extremes={"spin": [5.0, 50.0], "timestep": [0.01, 0.002]},
)

#: The steps of the runs (s), of which a method of order 1 has errors in proportion to the step.
STEPS = (0.02, 0.01)


@pytest.fixture(scope="module", autouse=True)
def _processes() -> Iterator[None]:
    """Calls are made here, and costs are measured roughly: nothing that is said of them needs their digits."""
    with calls_here(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(cost, "MIN_TIMING_S", cost.MIN_TIMING_S / 50)
        yield


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cases") / "tumbling.case.toml"
    path.write_text(TUMBLING, "utf-8")
    return path


@pytest.fixture(scope="module")
def ran(file: Path) -> RunResults:
    return bodycheck.run(file, engine="mujoco", integrator=["Euler", "RK4"], timestep=STEPS)


@pytest.fixture(scope="module")
def traded(file: Path) -> TradeoffResults:
    return bodycheck.tradeoff([bodycheck.load(file)], engine="mujoco", integrator="Euler", timestep=[0.02, 0.01])


@pytest.fixture(scope="module")
def advised(file: Path) -> RecommendResults:
    return bodycheck.recommend(str(file), error=1e-3, engine=["mujoco"], integrator=["RK4", "Euler"])


@pytest.fixture(scope="module")
def pushed(file: Path) -> ExtremesResults:
    return bodycheck.extremes(file, engine="mujoco", integrator="RK4")


@pytest.fixture(scope="module")
def all_results(
    ran: RunResults, traded: TradeoffResults, advised: RecommendResults, pushed: ExtremesResults
) -> tuple[Results, ...]:
    return ran, traded, advised, pushed


def test_a_loop_over_steps_takes_three_lines(file: Path) -> None:
    errors = {}
    for step in STEPS:
        errors[step] = (
            bodycheck.run(file, engine="mujoco", integrator="Euler", timestep=step).to_frame()["attitude_error"].max()
        )
    # Euler's method is of order 1, and the next term of the error is a few per cent at these steps.
    assert errors[STEPS[0]] / errors[STEPS[1]] == pytest.approx(2, rel=0.1)


def test_a_run_is_what_simulate_and_compare_say(ran: RunResults, file: Path) -> None:
    case = bodycheck.load(file)
    frame = ran.to_frame().set_index(["integrator", "timestep"])
    assert len(frame) == 4
    for (integrator, timestep), row in frame.iterrows():
        run = bodycheck.simulate(case, "mujoco", integrator, timestep)
        # The truth is the same function of the same instants, so that errors agree to the last bit.
        assert row["attitude_error"] == bodycheck.compare(bodycheck.truth(case), run).maxima()["attitude_error"]


def test_what_is_written_is_what_the_command_writes(file: Path, tmp_path: Path) -> None:
    options = ("--engine", "mujoco", "--integrator", "RK4", "--timestep", "0.01")
    command("run", file, *options, "--out", tmp_path / "command")
    found = bodycheck.run(file, engine="mujoco", integrator="RK4", timestep=0.01, out=tmp_path / "python", jobs=1)
    names = {path.name for path in (tmp_path / "command").iterdir()}
    assert {path.name for path in (tmp_path / "python").iterdir()} == names
    stored = store.read(tmp_path / "python")
    assert stored.complete
    assert stored.header["command"] == [f"bodycheck.run('{file}', engine=('mujoco',), integrator=('RK4',), timestep=(0.01,))"]
    told, measured = (judgement.records(judgement.judge(store.read(tmp_path / name))) for name in ("command", "python"))
    timed = ("wall_time", "time_per_step", "realtime_factor")
    assert [{**row, **dict.fromkeys(timed)} for row in told] == [{**row, **dict.fromkeys(timed)} for row in measured]
    assert found.passed


def test_every_result_has_tables_with_units_and_plots(all_results: tuple[Results, ...]) -> None:
    for results in all_results:
        assert repr(results) == f"<{type(results).__name__}: {results.headline}>"
        assert "\n" not in repr(results)
        page = results._repr_html_()
        assert page.count("<table>") == page.count("</table>") == 1
        for name in results.tables:
            frame = results.to_frame(name)
            assert len(frame), name
            assert set(frame.attrs["units"]) <= set(frame.columns), name
        assert results.plots, results
        picture, size = results.plot()._repr_png_()
        assert picture.startswith(b"\x89PNG")
        assert 500 < size["width"] < 2000
        with pytest.raises(bodycheck.BadInput, match="there is no table 'nothing'; there are: "):
            results.to_frame("nothing")
        with pytest.raises(bodycheck.BadInput, match="there is no plot of 'nothing'; there are: "):
            results.plot("nothing")
        with pytest.raises(bodycheck.BadInput, match="there is no plot of the case 'nobody'; there are: "):
            results.plot(case="nobody")


def test_units(ran: RunResults, traded: TradeoffResults, advised: RecommendResults, pushed: ExtremesResults) -> None:
    assert ran.to_frame().attrs["units"]["attitude_error"] == "rad"
    units = traded.to_frame().attrs["units"]
    assert (units["cost"], units["position_error"], units["timestep"]) == ("s/s", "m", "s")
    assert advised.to_frame("steps").attrs["units"]["error"] == "rad"
    assert pushed.to_frame("limits").attrs["units"]["spin_times_step"] == "rad"


def test_what_studies_return_is_what_they_measured(
    traded: TradeoffResults, advised: RecommendResults, pushed: ExtremesResults
) -> None:
    frame = traded.to_frame()
    assert (frame["timestep"] * frame["cost"]).tolist() == pytest.approx(frame["time_per_step"].tolist())
    assert list(traded.to_frame("orders")["quantity"]) == [order.quantity for order in traded.orders]
    assert advised.best is advised.answers[0]
    assert advised.best is not None
    assert advised.best.error is not None
    assert advised.best.error <= 1e-3
    steps = advised.to_frame("steps")
    assert advised.best.error in set(steps["error"])
    assert len(steps) == sum(answer.steps for answer in advised.answers)
    assert [(row.value, row.timestep) for row in pushed.rows] == [(5.0, 0.01), (5.0, 0.002), (50.0, 0.01), (50.0, 0.002)]
    assert [limit.spin for limit in pushed.limits] == [5.0, 50.0]


def test_a_plot_is_saved(advised: RecommendResults, tmp_path: Path) -> None:
    for ending, start in ((".svg", b"<svg"), (".png", b"\x89PNG"), (".json", b"{")):
        advised.plot("attitude").save(tmp_path / f"plot{ending}")
        assert (tmp_path / f"plot{ending}").read_bytes().startswith(start)
    with pytest.raises(
        bodycheck.BadInput, match=re.escape("read '.gif' as the ending of the file; allowed: .svg, .png, .json")
    ):
        advised.plot().save(tmp_path / "plot.gif")


def test_a_page_quotes_names() -> None:
    from bodycheck.interface.results import shown

    page = shown("<b>", ["<script>"], [{"<i>": "<u>", "x": None}], ["<i>", "x"], {})
    assert not re.search("<(script|i|u)>", page)
    assert page.count("<b>") == 1  # its own
    many = shown("many", [], [{"x": 1.0}] * 100, ["x"], {"x": "m"})
    assert "88 more rows" in many
    assert "<th>x m</th>" in many


def test_states_are_read_as_long_as_the_results_exist(file: Path) -> None:
    found = bodycheck.run(file, engine="mujoco", integrator="RK4", timestep=0.01)
    folder = found.found.results.folder
    assert found.verdicts[0].run.outcome.trajectory.t[-1] == 0.5  # type: ignore[union-attr]  # it completed
    assert folder.is_dir()
    del found
    gc.collect()
    assert not folder.exists()


def test_results_are_frozen(all_results: tuple[Results, ...]) -> None:
    for results in all_results:
        with pytest.raises(FrozenInstanceError):
            results.found = None  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("function", "arguments", "options"),
    [
        (bodycheck.run, ["fre-brick"], {}),
        (bodycheck.run, ["free-brick"], {"engine": "mujocco"}),
        (bodycheck.run, ["free-brick"], {"integrator": "RK5"}),
        (bodycheck.run, ["free-brick"], {"timestep": 0}),
        (bodycheck.run, ["free-brick"], {"timestep": "abc"}),
        (bodycheck.run, ["free-brick"], {"jobs": 0}),
        (bodycheck.run, ["free-brick"], {"jobs": "x"}),
        (bodycheck.tradeoff, ["free-brick"], {"timestep": 11.0}),
        (bodycheck.tradeoff, ["free-brick"], {"batch": 0}),
        (bodycheck.tradeoff, ["free-brick"], {"batch": "10,x"}),
        (bodycheck.tradeoff, ["free-brick"], {"batch": 10**9}),
        (bodycheck.extremes, ["dumbell"], {}),
        (bodycheck.recommend, ["free-brick"], {"error": -1}),
        (bodycheck.recommend, ["free-brick"], {"error": "x"}),
        (bodycheck.recommend, ["free-brick"], {"error": 1e-3, "quantity": "atitude"}),
        (bodycheck.recommend, ["free-brick"], {"error": 1e-3, "reuse": "/nowhere"}),
    ],
)
def test_bad_arguments_raise_with_the_texts_of_the_command_line(
    function: Callable[..., object], arguments: list[str], options: dict[str, Any]
) -> None:
    words = [f"--{name}={value}" for name, value in options.items()]
    refused = command(function.__name__, *arguments, *words)
    assert refused.returncode == 2
    with pytest.raises(bodycheck.BadInput) as raised:
        function(*arguments, **options)
    assert str(raised.value).strip() in refused.stderr


@pytest.mark.parametrize(
    ("cases", "options", "message"),
    [
        (3, {}, "Invalid value for CASE: read 3; allowed: a name, a path or what bodycheck.load returns, or several."),
        ([3], {}, "Invalid value for CASE: read 3; allowed: a name, a path or what bodycheck.load returns."),
        ("free-brick", {"engine": 3}, "Invalid value for --engine: read 3; allowed: a text, or several."),
        ("free-brick", {"integrator": [None]}, "Invalid value for --integrator: read None; allowed: a text."),
        ("free-brick", {"timestep": [True]}, 'Invalid value for --timestep: unable to convert "True" into float.'),
        ("free-brick", {"out": 3}, 'Invalid value for --out: unable to convert "3" into Path.'),
    ],
)
def test_what_a_command_line_cannot_say_is_refused_too(cases: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(bodycheck.BadInput, match=re.escape(message)):
        bodycheck.run(cases, **options)


def test_cases_that_were_changed_or_share_a_name_are_refused(file: Path) -> None:
    case = bodycheck.load(file)
    with pytest.raises(bodycheck.BadInput, match="tumbling: was changed after it was loaded"):
        bodycheck.run(replace(case, duration=0.4), engine="mujoco")
    other = parse(TUMBLING.replace("mass = 1.0", "mass = 2.0"), "other")
    with pytest.raises(bodycheck.BadInput, match="another of these cases also has the name 'tumbling'"):
        bodycheck.run([case, other], engine="mujoco")


def test_single_runs_refuse_what_they_cannot_use() -> None:
    case = bodycheck.load("free-brick")
    with pytest.raises(bodycheck.BadInput, match='Invalid value for --timestep: unable to convert "abc" into float'):
        bodycheck.simulate(case, "mujoco", "RK4", "abc")  # type: ignore[arg-type]
    with pytest.raises(bodycheck.BadInput, match="Invalid value for --integrator: read None"):
        bodycheck.simulate(case, "mujoco", None)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="read 3 as the case"):
        bodycheck.load(3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=re.escape("read 3 as the truth; allowed: what bodycheck.truth returns")):
        bodycheck.compare(3, 4)  # type: ignore[arg-type]


def test_functions_have_the_options_of_their_commands() -> None:
    """Those that are left out are about the terminal, are given by what a function returns, or are options of load."""
    from bodycheck.commands.command_line import COMMANDS

    shown = {"json", "table", "view", "quiet", "figures", "save", "junit", "without"}  # a function has `ignore` alone
    commands = {one.__name__: parameters_of(one) for one in COMMANDS if inspect.isfunction(one)}
    for function in (bodycheck.run, bodycheck.tradeoff, bodycheck.recommend, bodycheck.extremes):
        own = inspect.signature(function).parameters
        assert own.keys() == commands[function.__name__].keys() - shown
        for name, parameter in own.items():
            if name != "cases":
                assert parameter.default == commands[function.__name__][name].default, name
                assert name == "case" or parameter.kind is inspect.Parameter.KEYWORD_ONLY


def test_public_names_are_found_and_import_little() -> None:
    assert set(bodycheck.__all__) <= set(dir(bodycheck))
    assert all(getattr(bodycheck, name) for name in bodycheck.__all__)
    assert "importlib" not in dir(bodycheck)
    heavy = ("numpy", "pandas", "pydantic", "scipy")
    code = f"import sys, bodycheck; dir(bodycheck); print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
