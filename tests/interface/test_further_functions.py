"""The functions of ensembles, audits, contact, robots and scripts: what they return is what their commands measure."""

import inspect
import json
import re
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

import bodycheck
from bodycheck.interface.results import Results
from bodycheck.robots.urdf_text import urdf
from bodycheck.running import truths
from bodycheck.studies.audit import study as audit
from tests.support.cases import a_case
from tests.support.commands import bodycheck as command
from tests.support.commands import parameters_of
from tests.support.planted_engines import plant
from tests.support.reading_engines import ENGINES
from tests.support.robot_faults import clean_model

#: A brick that tumbles, of which 16 members differ in their angular velocity.
TUMBLING = a_case(
    "tumbling",
    title="A brick that tumbles",
    body={"shape": "brick", "semi_axes": [0.1, 0.2, 0.3], "mass": 1.0},
    initial={"angular_velocity": [1.0, 2.0, 3.0]},
)
ENSEMBLE = """
[ensemble]
members = 16
seed = 1
[[ensemble.vary]]
key = "initial.angular_velocity.0"
distribution = "uniform"
low = 1.0
high = 2.0
"""

pytestmark = pytest.mark.usefixtures("calls_here")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "tumbling.case.toml"
    path.write_text(TUMBLING + ENSEMBLE, "utf-8")
    return path


def check(results: Results, *tables: str, plotted: bool = True) -> None:
    """What all results have: a short text, a page for notebooks, data frames of their tables, and plots."""
    assert repr(results) == f"<{type(results).__name__}: {results.headline}>"
    assert results._repr_html_().count("<table>") == 1
    assert tuple(results.tables) == tables
    for name in tables:
        frame = results.to_frame(name)
        assert list(frame.columns) == list(results.tables[name].columns)
        assert "Float64" not in {str(kind) for kind in frame.dtypes}, "such numbers are printed as 0.0 if they are small"
    assert len(results.to_frame())
    assert bool(results.plots) == plotted
    with pytest.raises(bodycheck.BadInput, match="there is no table 'nothing'"):
        results.to_frame("nothing")


def test_an_ensemble(file: Path) -> None:
    results = bodycheck.ensemble(bodycheck.load(file), members=8, engine="mujoco", integrator="Euler")
    check(results, "ensemble", "sensitivity")
    assert results.passed
    done = command("ensemble", file, "--members", 8, "--engine", "mujoco", "--integrator", "Euler", "--json")
    assert json.loads(done.stdout)["rows"] == [asdict(row) for row in results.rows]
    with pytest.raises(bodycheck.BadInput, match=re.escape('Invalid value for --members: unable to convert "x" into int.')):
        bodycheck.ensemble(file, members="x")  # type: ignore[arg-type]


def test_contact(tmp_path: Path) -> None:
    options: dict[str, Any] = {"case": "resting-brick", "out": tmp_path}
    results = bodycheck.contact("mujoco", **options)
    check(results, "contact", "contact_settings", "contact_properties", plotted=False)
    assert {row.scene for row in results.rows} == {"resting-brick"}
    with pytest.raises(bodycheck.BadInput, match="there is no engine 'mujocco'"):
        bodycheck.contact("mujocco", case="resting-brick")


def test_audit(miniatures: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = dict(list(audit.PROBES.items())[:1])
    monkeypatch.setattr(audit, "PROBES", kept)
    results = bodycheck.audit("drifting", integrator="closed-form")
    check(results, "audit", "classes", plotted=False)
    assert {row.engine for row in results.rows} == {"drifting"}
    with pytest.raises(bodycheck.BadInput, match="--timestep"):
        bodycheck.audit("drifting", timestep="x")  # type: ignore[arg-type]


def test_parity(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plant(tmp_path / "planted", ENGINES)
    monkeypatch.syspath_prepend(tmp_path / "planted")
    file = tmp_path / "arm.urdf"
    file.write_text(urdf(clean_model()), "utf-8")
    results = bodycheck.parity(file, engine="faithful", states=4, out=tmp_path / "out")
    check(results, "parity", plotted=False)
    assert results.agrees
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"parity.csv", "report.html"}
    assert not bodycheck.parity([str(file)], engine=["faithful", "heavy"], states=4).agrees
    with pytest.raises(bodycheck.BadInput, match=re.escape("--states 0: must be at least 1")):
        bodycheck.parity(file, states=0)
    with pytest.raises(bodycheck.BadInput, match=re.escape("--tolerance 0.0: must be greater than 0")):
        bodycheck.parity(file, tolerance=0.0)
    with pytest.raises(bodycheck.BadInput, match=re.escape("--motion -1.0: must be from 0 to")):
        bodycheck.parity(file, motion=-1.0)
    with pytest.raises(bodycheck.BadInput, match="give at least one file of a robot"):
        bodycheck.parity([])


def test_export_needs_no_truth(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("truth", "of_runs", "certify"):
        monkeypatch.setattr(truths, name, None)
    script = bodycheck.export(file, engine="mujoco", integrator="RK4", out=tmp_path / "script.py")
    assert script == (tmp_path / "script.py").read_text("utf-8")
    done = command("export", file, "--engine", "mujoco", "--integrator", "RK4")
    assert (done.returncode, done.stdout) == (0, script)
    with pytest.raises(bodycheck.BadInput, match="there is no engine 'mujocco'"):
        bodycheck.export(file, engine="mujocco")


@pytest.mark.parametrize(
    ("function", "left_out"),
    [
        # A share, a cluster and the case file of one member are matters of the command line.
        (bodycheck.ensemble, {"member", "write", "dask", "shard"}),
        # `bodycheck.parity` compares robots; environments are removed by the command.
        (bodycheck.releases, {"model", "remove"}),
        (bodycheck.audit, set()),
        (bodycheck.contact, set()),
        (bodycheck.parity, set()),
        (bodycheck.export, set()),
    ],
)
def test_functions_have_the_options_of_their_commands(function: Callable[..., object], left_out: set[str]) -> None:
    from bodycheck.commands.command_line import COMMANDS

    shown = {"json", "table", "view", "quiet", "figures", "save", "junit"}
    (options,) = (parameters_of(one) for one in COMMANDS if inspect.isfunction(one) and one.__name__ == function.__name__)
    own = inspect.signature(function).parameters
    assert own.keys() == options.keys() - shown - left_out
    for name, parameter in own.items():
        if options[name].kind is inspect.Parameter.KEYWORD_ONLY:
            assert parameter.default == options[name].default, name
            assert parameter.kind is inspect.Parameter.KEYWORD_ONLY


def test_small_numbers_are_printed_as_they_are(file: Path) -> None:
    results = bodycheck.run(file, engine="mujoco", integrator=["Euler", "RK4"], timestep=0.002)
    frame = results.to_frame()
    small = frame["attitude_error"].min()
    assert 0 < small < 1e-8
    errors, whole = frame[["attitude_error"]], results.to_frame("results")
    for printed in (str(errors), errors.to_html(), whole.to_string()):
        assert re.search(r"\de-1?\d", printed), printed
    assert f"{small:.4g}" in results._repr_html_()


def test_public_names_alone_are_listed_and_a_truth_has_a_short_text(file: Path) -> None:
    assert dir(bodycheck) == sorted(bodycheck.__all__)
    assert set(bodycheck.HOMES) == set(bodycheck.__all__) - {"__version__"}
    for name in ("double-pendulum-in-space", str(file)):
        case = bodycheck.load(name)
        text = repr(bodycheck.truth(case))
        assert re.fullmatch(r"<Truth: .*, \d+ instants to [\d.]+ s, error at most [\de.-]+ rad>", text), text
        assert len(text) < 150
