"""The aliases `default` and `recommended`: the methods behind them, their time steps, and what is refused or left out."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from bodycheck import load, simulate
from bodycheck.adapters import registry, roles
from bodycheck.adapters.contract import ACCURACY, KINDS, Engine, Integrator, Kind, Method, Role, Usage
from bodycheck.adapters.registry import fault_of
from bodycheck.casefile.case import parse
from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.errors import BadInput
from bodycheck.running.named import Named, check, check_planned, decide
from bodycheck.running.plan import Task, plan, plan_with_roles
from bodycheck.running.roles import lacking, method_in_role, roles_of
from bodycheck.studies.audit import study as audit
from bodycheck.studies.extremes import study as extremes
from bodycheck.studies.recommend import study as recommend
from bodycheck.studies.tradeoff import study as tradeoff
from tests.support.cases import a_case, expecting, shortened
from tests.support.commands import bodycheck
from tests.support.planted_engines import plant

FLIP = replace(load("intermediate-axis-flip"), expectations=())
PENDULUM = replace(load("double-pendulum"), expectations=())
PAGE = "https://example.org/first-steps"
FLIGHT: frozenset[Kind] = frozenset({"flight"})


def an_engine(name: str, methods: Mapping[Role, Usage], kinds: frozenset[Kind] = FLIGHT, **more: Any) -> Engine:
    """The record of an engine with these methods in its roles, for these kinds of scene."""
    return Engine(
        *(name, name, "1.0"),
        (Integrator("euler"), Integrator("rk3", options={"accuracy": ACCURACY})),
        frozenset(),
        roles={role: dict.fromkeys(kinds, usage) for role, usage in methods.items()},
        **more,
    )


EULER = Usage("euler", 0.005, PAGE)
CONTROLLED = Usage("rk3:accuracy=1e-6", None, PAGE)
TWO = an_engine("two", {"default": EULER, "recommended": CONTROLLED}, KINDS, largest_step=0.1)
ONE = an_engine("one", {"default": EULER})
BOTH = an_engine("both", {"default": EULER, "recommended": EULER})
LIBRARY = an_engine("library", {})
RECORDS = {record.name: record for record in (TWO, ONE, BOTH, LIBRARY)}


def methods(tasks: tuple[Task, ...], engine: str = "two") -> list[tuple[str, float]]:
    return [(task.method.name, task.method.timestep) for task in tasks if task.engine == engine]


def test_an_alias_is_one_method_of_each_engine_with_its_own_step() -> None:
    assert methods(plan([FLIP], RECORDS, ("default",), ())) == [("euler", 0.005)]
    assert {task.engine for task in plan([FLIP], RECORDS, ("default",), ())} == {"two", "one", "both"}
    assert methods(plan([FLIP], RECORDS, ("recommended",), ())) == [("rk3:accuracy=1e-6", 0.1)]
    both = plan([FLIP], RECORDS, ("recommended", "default"), ())
    assert methods(both) == [("euler", 0.005), ("rk3:accuracy=1e-6", 0.1)]
    assert methods(both, "both") == [("euler", 0.005)]
    beside = plan([FLIP], {"two": TWO}, ("euler", "default"), ())
    assert methods(beside) == [("euler", 0.002), ("euler", 0.005)]


def test_a_method_with_error_control_has_the_largest_step_of_its_engine_or_the_sampling_interval() -> None:
    unlimited = replace(TWO, largest_step=None)
    assert methods(plan([shortened(FLIP, 1.0, 11)], {"two": unlimited}, ("recommended",), ())) == [("rk3:accuracy=1e-6", 0.1)]
    assert methods(plan([shortened(FLIP, 0.05, 11)], {"two": TWO}, ("recommended",), ())) == [("rk3:accuracy=1e-6", 0.05)]


def test_only_where_nothing_is_named_are_the_methods_of_roles_run_too() -> None:
    offered = [("euler", 0.002), ("rk3", 0.002)]
    assert methods(plan_with_roles([FLIP], RECORDS, (), ())) == [*offered, ("euler", 0.005), ("rk3:accuracy=1e-6", 0.1)]
    assert methods(plan([FLIP], RECORDS, (), ())) == offered
    assert methods(plan_with_roles([FLIP], RECORDS, ("rk3",), ())) == [("rk3", 0.002)]
    assert methods(plan_with_roles([FLIP], RECORDS, (), (0.01,))) == [("euler", 0.01), ("rk3", 0.01)]
    # A step that is longer than the case is left out where nobody has asked for it, and refused where somebody has.
    short = shortened(FLIP, 0.004, 3)
    assert methods(plan_with_roles([short], {"one": ONE}, (), ()), "one") == offered
    with pytest.raises(BadInput, match=r"time step 0\.005 s: must be positive, at most its duration"):
        plan([short], {"one": ONE}, ("default",), ())


def test_the_step_of_a_robot_file_is_that_of_engines_that_read_it() -> None:
    reads = an_engine("reads", {"default": replace(EULER, reads_timestep=True)}, KINDS)
    case = replace(PENDULUM, timestep=0.0125)
    assert methods(plan([case], {"reads": reads, "two": TWO}, ("default",), ()), "reads") == [("euler", 0.0125)]
    assert methods(plan([case], {"reads": reads, "two": TWO}, ("default",), ())) == [("euler", 0.005)]
    assert methods(plan([PENDULUM], {"reads": reads}, ("default",), ()), "reads") == [("euler", 0.005)]
    assert roles_of(reads, case, Method.parse("euler", 0.0125)) == "default"
    assert roles_of(reads, case, Method.parse("euler", 0.005)) == ""


def test_the_roles_of_a_method_depend_on_its_step() -> None:
    assert roles_of(TWO, FLIP, Method.parse("euler", 0.005)) == "default"
    assert roles_of(TWO, FLIP, Method.parse("euler", 0.002)) == ""
    assert roles_of(TWO, FLIP, Method.parse("rk3:accuracy=1e-06", 0.1)) == "recommended"
    assert roles_of(BOTH, FLIP, Method.parse("euler", 0.005)) == "default, recommended"
    assert roles_of(ONE, PENDULUM, Method.parse("euler", 0.005)) == ""


def test_expectations_of_the_method_and_step_of_an_alias_are_checked() -> None:
    limits = (Limit("attitude_error", None, 1.0),)
    same = Expectation("two", Method.parse("euler", 0.005), (Limit("order", 0.75, 1.25),))
    case = replace(FLIP, expectations=(same, Expectation("two", Method.parse("euler", 0.001), limits)))
    steps = [timestep for _, timestep in methods(plan([case], {"two": TWO}, ("default",), ()))]
    assert steps == [0.005, 0.0025, 0.00125]


@pytest.mark.parametrize(
    "refuse",
    [
        lambda: plan([FLIP], RECORDS, ("euler", "default"), (0.001,)),
        lambda: tradeoff.plan([FLIP], RECORDS, ("default",), (0.001,)),
        lambda: audit.prepare(RECORDS, ("default",), 0.001),
        lambda: simulate(FLIP, "mujoco", "default", 0.001),
    ],
)
def test_a_time_step_beside_an_alias_is_refused(refuse: Any) -> None:
    with pytest.raises(BadInput, match=r"--timestep 0\.001 beside --integrator default: this method has its own time step"):
        refuse()


def test_engines_without_a_method_are_left_out_with_a_sentence_and_refused_where_they_are_named() -> None:
    told = list(lacking([FLIP], RECORDS, ("default", "recommended")))
    assert told == [
        "one has no recommended method: its documentation recommends none, or its adapter names none",
        "library has no default method: it has no stepper of its own, or its adapter names none",
        "library has no recommended method: its documentation recommends none, or its adapter names none",
    ]
    assert list(lacking([FLIP, PENDULUM], {"one": ONE}, ("default",))) == ["one has no default method for mechanisms"]
    check(Named(engine=("one", "two"), integrator=("default",)), RECORDS)
    with pytest.raises(BadInput, match="--integrator recommended: one has no recommended method"):
        check(Named(engine=("one", "two"), integrator=("default", "recommended")), RECORDS)
    with pytest.raises(BadInput, match="--integrator default: library has no default method"):
        plan([FLIP], {"library": LIBRARY}, ("default",), ())
    named = Named(engine=("one", "two"), integrator=("default",))
    pairs = [(task.engine, task.method) for task in plan([PENDULUM], {"one": ONE, "two": TWO}, ("default",), ())]
    with pytest.raises(BadInput, match="one: nothing to run with default"):
        check_planned(named, RECORDS, pairs)
    with pytest.raises(BadInput, match="--integrator recommended: nothing to run"):
        check_planned(Named(integrator=("default", "recommended")), RECORDS, pairs)


@pytest.mark.parametrize(("spelling", "meant"), [("defualt", "default"), ("recomended", "recommended")])
def test_a_misspelled_alias_is_told_what_it_may_mean(spelling: str, meant: str) -> None:
    with pytest.raises(BadInput, match=f"did you mean '{meant}'"):
        plan([FLIP], RECORDS, (spelling,), ())


def test_a_row_with_the_method_of_an_alias_is_its_result() -> None:
    row = {"engine": "two", "integrator": "euler", "status": "ok"}
    assert not decide(Named(integrator=("default",)), [row], records=RECORDS).lost
    assert not decide(Named(integrator=("default",)), [row | {"integrator": "x", "role": "default, recommended"}]).lost
    (lost,) = decide(Named(integrator=("default",)), [row | {"status": "diverged"}], records=RECORDS).lost
    assert lost == "there is no result of the integrator default, which is named: diverged"


def test_studies_about_steps_take_the_method_of_an_alias_and_others_its_step() -> None:
    records = {"two": TWO}
    assert {name for name, _ in methods(tradeoff.plan([FLIP], records, ("default",), ()))} == {"euler"}
    (search,) = recommend.prepare(FLIP, records, ("recommended",), "attitude", 0.1).searches
    assert search.method == Method.parse("rk3:accuracy=1e-6", 0.1).over_accuracies
    (planned,) = audit.prepare(records, ("euler", "default"), None).methods
    assert planned.method == Method.parse("euler", 0.005)
    case = parse(a_case(extremes={"timestep": [0.01], "mass": [2.0], "steps": [100]}), "f")
    trials = extremes.prepare([case], records, ("default",)).trials
    steps = {trial.point.axis: trial.method.timestep for trial in trials}
    assert steps == {"timestep": 0.01, "mass": 0.005, "steps": 0.002}


@pytest.mark.parametrize(
    ("record", "fault"),
    [
        (replace(TWO, integrators=(Integrator("default"),), roles={}), "an integrator is named default, which stands for"),
        (replace(TWO, roles={"usual": {}}), "its roles have the key 'usual'; allowed: default, recommended"),  # type: ignore[dict-item]
        (
            an_engine("e", {"default": replace(EULER, method="heun")}),
            "its default method for flight is 'heun': e has no",
        ),
        (an_engine("e", {"default": replace(EULER, timestep=None)}), "is euler without a time step"),
        (an_engine("e", {"default": replace(EULER, timestep=-1.0)}), "has the time step -1.0, not a positive number"),
        (an_engine("e", {"default": replace(EULER, page="manual.pdf")}), "cites 'manual.pdf', not an address"),
        (
            replace(ONE, integrators=(Integrator("euler", kinds=frozenset({"drag"})),)),
            "its default method for flight is euler, but one has no integrator 'euler' for this scene",
        ),
    ],
)
def test_a_record_with_a_wrong_role_is_refused(record: Engine, fault: str) -> None:
    with pytest.raises(AssertionError, match=fault):
        raise AssertionError(fault_of(record))
    assert fault_of(TWO) is None


def test_methods_of_roles_are_told_in_words() -> None:
    assert roles.in_words(TWO, "default") == "euler 0.005 s"
    assert roles.in_words(TWO, "recommended") == "rk3:accuracy=1e-6 at most 0.1 s"
    assert roles.in_words(replace(TWO, largest_step=None), "recommended").endswith("at most the sampling interval")
    several: Mapping[Role, Mapping[Kind, Usage]] = {"default": {"flight": EULER, "drag": EULER, "mechanism": CONTROLLED}}
    assert roles.in_words(replace(TWO, roles=several), "default") == (
        "euler 0.005 s (drag, flight); rk3:accuracy=1e-6 at most 0.1 s (mechanism)"
    )
    assert roles.in_words(LIBRARY, "default") == ""
    assert roles.pages(TWO) == (PAGE,)


def test_mujoco_has_both_and_pinocchio_neither() -> None:
    mujoco, pinocchio = (registry.load(name).engine for name in ("mujoco", "pinocchio"))
    assert method_in_role(mujoco, FLIP, "default") == Method.parse("Euler", 0.002)
    assert method_in_role(mujoco, FLIP, "recommended") == Method.parse("implicitfast", 0.002)
    assert pinocchio.roles == {}
    run = simulate(shortened(FLIP, 0.1, 3), "mujoco", "recommended")
    assert (run.method.name, run.method.timestep, run.role) == ("implicitfast", 0.002, "recommended")


def test_an_expectation_of_an_alias_is_refused_with_its_place(tmp_path: Path) -> None:
    path = tmp_path / "spin.case.toml"
    path.write_text(a_case(expect=[expecting("mujoco", "default", 0.002, attitude_error=1.0)]), "utf-8")
    done = bodycheck("validate", path)
    assert done.returncode == 2
    line = path.read_text("utf-8").splitlines().index('integrator = "default"') + 1
    assert f"{path}:{line}:1: expect[1].integrator: read 'default'" in done.stdout + done.stderr
    assert "allowed: the spelling and the time step of the method" in done.stdout + done.stderr


MODEL = """
<mujoco>{option}<worldbody><body name="arm"><joint name="hinge" axis="0 1 0"/>
<inertial pos="0 0 -0.5" mass="1" diaginertia="0.1 0.1 0.1"/></body></worldbody></mujoco>
"""
OF_A_MODEL = """
format = 2
name = "arm"
title = "An arm"
[model]
file = "arm.xml"
[scene]
gravity = 9.81
[run]
duration = 0.1
samples = 3
"""


def test_the_default_of_mujoco_has_the_step_of_its_file(tmp_path: Path) -> None:
    path = tmp_path / "arm.case.toml"
    path.write_text(OF_A_MODEL, "utf-8")
    (tmp_path / "arm.xml").write_text(MODEL.format(option='<option timestep="0.005"/><option integrator="RK4"/>'), "utf-8")
    case = load(path)
    assert case.timestep == 0.005
    assert parse(case.text, "arm").timestep == 0.005
    (task,) = plan([case], {"mujoco": registry.load("mujoco").engine}, ("default",), ())
    assert task.method == Method.parse("Euler", 0.005)
    (tmp_path / "arm.xml").write_text(MODEL.format(option=""), "utf-8")
    assert load(path).timestep is None
    (tmp_path / "arm.xml").write_text(MODEL.format(option='<option timestep="-1"/>'), "utf-8")
    with pytest.raises(BadInput, match=r"<option timestep>.*allowed: a positive number"):
        load(path)


def test_the_command_runs_aliases_and_leaves_out_a_library_with_one_line(tmp_path: Path) -> None:
    path = tmp_path / "spin.case.toml"
    path.write_text(a_case(), "utf-8")
    done = bodycheck("run", path, "--integrator", "default", "--integrator", "recommended", "--json")
    (line,) = [line for line in done.stderr.splitlines() if "pinocchio has no default method" in line]
    assert line.startswith("bodycheck: left out: ")
    rows = [(row["integrator"], list(row)[-1], row["role"]) for row in json.loads(done.stdout) if row["engine"] == "mujoco"]
    assert rows == [("Euler", "role", "default"), ("implicitfast", "role", "recommended")]
    refused = bodycheck("run", path, "--engine", "pinocchio", "--integrator", "default")
    assert refused.returncode == 2
    assert "--integrator default: pinocchio has no default method" in refused.stderr


DYING = """
import os
from dataclasses import replace
from bodycheck.adapters.contract import Usage
usual = Usage("step", 0.01, "https://example.org")
engine = replace(RECORD, models=frozenset({"rotation"}), roles={"default": {"flight": usual}, "recommended": {"flight": usual}})

def prepare(scenes, method):
    os._exit(3)
"""


def test_a_run_whose_process_dies_has_its_role(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plant(tmp_path / "planted", {"dying": DYING})
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(tmp_path / "planted")
    path = tmp_path / "spin.case.toml"
    path.write_text(a_case(), "utf-8")
    done = bodycheck("run", path, "--engine", "dying", "--integrator", "default", "--json")
    (row,) = json.loads(done.stdout)
    assert (row["status"], row["timestep"], row["role"]) == ("crashed", 0.01, "default, recommended")
    assert (done.returncode, "there is no result of the integrator default" in done.stderr) == (1, True)
