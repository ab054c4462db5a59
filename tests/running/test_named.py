"""Everything that is named is measured, or the command fails: the refusals before anything runs, and the decision after it."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from bodycheck.adapters.contract import Engine, Integrator
from bodycheck.adapters.method import Method, choice
from bodycheck.errors import BadInput
from bodycheck.running.named import Named, check, check_planned, decide
from tests.support.cases import a_case, expecting
from tests.support.commands import bodycheck

FLIGHT, PLANE = frozenset({"flight"}), frozenset({"plane"})

RECORDS = {
    "one": Engine(
        *("one", "one", "1.0"),
        (Integrator("Euler", kinds=FLIGHT, options={"cone": choice("round", "flat")}), Integrator("RK4", kinds=FLIGHT)),
        frozenset(),
    ),
    "two": Engine("two", "two", "1.0", (Integrator("euler", kinds=PLANE), Integrator("rk4", kinds=FLIGHT)), frozenset()),
}


@pytest.mark.parametrize(
    ("engines", "integrators", "told"),
    [
        (("one", "two"), ("RK4",), "two: no integrator RK4; it has euler, rk4; did you mean 'rk4'?"),
        (("two", "one"), ("RK4",), "two: no integrator RK4; it has euler, rk4; did you mean 'rk4'?"),
        (("one", "two"), ("RK4", "Heun"), "two: no integrator RK4 or Heun; it has euler, rk4; did you mean 'rk4'?"),
        (
            ("one", "two"),
            ("Euler:cone=flta", "rk4"),
            "one Euler:cone=flta: read 'flta'; allowed: round or flat; did you mean 'flat'?",
        ),
        (("one", "two"), ("Euler:pads=4", "rk4"), "one Euler has no option 'pads'; allowed: cone"),
        (("one",), ("midpoint",), ""),
        (("one", "two"), ("RK4", "rk4"), ""),
        (("one", "two"), ("Euler:cone=flat", "euler"), ""),
        ((), ("RK4",), ""),
        (("one", "two"), (), ""),
        (("broken", "one"), ("RK4",), ""),
    ],
)
def test_a_named_engine_has_one_of_the_named_methods(engines: tuple[str, ...], integrators: tuple[str, ...], told: str) -> None:
    named = Named(engine=engines, integrator=integrators)
    if not told:
        check(named, RECORDS)
        return
    with pytest.raises(BadInput) as refused:
        check(named, RECORDS)
    assert str(refused.value) == told


@pytest.mark.parametrize(
    ("named", "told"),
    [
        (
            Named(engine=("one", "two"), integrator=("RK4", "euler")),
            "two: nothing to run with RK4, euler: it has no such method",
        ),
        (
            Named(engine=("one",), integrator=("RK4", "euler")),
            "euler: nothing to run: no engine has this method for the scenes",
        ),
        (Named(engine=("two",)), "two: nothing to run: it has no such method"),
        (Named(engine=("one",), integrator=("RK4",)), ""),
        (Named(engine=("broken", "one")), ""),
        (Named(integrator=("RK4",)), ""),
        (Named(), ""),
    ],
)
def test_a_name_without_a_planned_run_is_refused(named: Named, told: str) -> None:
    planned = [("one", Method.parse("RK4:model=small", 0.01))]
    if not told:
        check_planned(named, RECORDS, planned)
        return
    with pytest.raises(BadInput) as refused:
        check_planned(named, RECORDS, planned)
    assert str(refused.value).startswith(told)


def row(engine: str, integrator: str, status: str = "ok", reason: str = "", **more: Any) -> Mapping[str, Any]:
    return {"engine": engine, "integrator": integrator, "status": status, "reason": reason, **more}


UNSUPPORTED = row("two", "rk4", "unsupported", "two does not model drag")


@pytest.mark.parametrize(
    ("named", "rows", "lost"),
    [
        (Named(engine=("one",)), [row("one", "RK4"), UNSUPPORTED], []),
        (Named(engine=("one", "two")), [row("one", "RK4"), UNSUPPORTED, row("two", "rk4")], []),
        (
            Named(engine=("one", "two")),
            [row("one", "RK4"), UNSUPPORTED],
            ["there is no result of the engine two, which is named: unsupported: two does not model drag"],
        ),
        (
            Named(integrator=("RK4", "rk4")),
            [row("one", "RK4"), UNSUPPORTED, UNSUPPORTED, row("two", "rk4", "diverged", "energy")],
            [
                "there is no result of the integrator rk4, which is named: unsupported: two does not model drag "
                "(2 of 3 rows; the others for other reasons)"
            ],
        ),
        (Named(engine=("two",)), [], ["there is no result of the engine two, which is named: it fails"]),
        (Named(engine=("two",)), [row("two", "rk4", "diverged", "it does", passed=True)], []),
        (Named(integrator=("Euler:pads=04,cone=flat",)), [row("one", "Euler:cone=flat,pads=4")], []),
        (
            Named(version=("3.0", "4.0")),
            [row("one", "RK4", version="3.0"), row("one", "RK4", "unobtainable", "no such release", version="4.0")],
            ["there is no result of the version 4.0, which is named: unobtainable: no such release"],
        ),
        (
            Named(batch=(1, 100)),
            [row("one", "RK4", batch=1)],
            ["there is no result of the batch 100, which is named: nothing was run"],
        ),
        (Named(), [UNSUPPORTED], ["there is no result: unsupported: two does not model drag"]),
        (Named(), [], ["there is no result: nothing was run"]),
        (Named(), [{"height": 1.0}], []),
    ],
)
def test_a_name_needs_one_result(named: Named, rows: list[Mapping[str, Any]], lost: list[str]) -> None:
    decision = decide(named, rows, missing={"two": "it fails"})
    assert list(decision.lost) == lost
    assert decision.code == bool(lost)


def test_unsupported_rows_among_others_are_counted_and_are_no_failure() -> None:
    decision = decide(Named(), [row("one", "RK4"), UNSUPPORTED, UNSUPPORTED])
    assert (decision.code, decision.unsupported) == (0, "2 of 3 rows are unsupported, for example: two does not model drag")
    assert decide(Named(), [row("one", "RK4")], failed=True).code == 1
    assert decide(Named(engine=("one",)), [row("one", "RK4", "frozen")], measured=("frozen",)).code == 0


RK4_ALONE = ("--engine", "mujoco", "--engine", "pinocchio", "--integrator", "RK4")


@pytest.mark.parametrize(
    "words",
    [
        ("run", "CASE", *RK4_ALONE),
        ("run", "CASE", *RK4_ALONE, "--timestep", "0.01", "--json"),
        ("tradeoff", "CASE", *RK4_ALONE, "--timestep", "0.01", "--timestep", "0.02"),
        ("recommend", "CASE", "--error", "1e-3", *RK4_ALONE),
        ("extremes", "CASE", *RK4_ALONE),
        ("ablate", "CASE", *RK4_ALONE),
        ("ensemble", "ensemble-of-bricks", *RK4_ALONE),
        ("expect", "CASE", *RK4_ALONE),
        ("contact", "mujoco", "pinocchio", "--integrator", "RK4"),
        ("audit", "mujoco", "pinocchio", "--integrator", "RK4"),
    ],
)
def test_every_command_refuses_a_named_engine_without_the_method(tmp_path: Path, words: tuple[str, ...]) -> None:
    case = tmp_path / "spin.case.toml"
    case.write_text(a_case(extremes={"spin": [1.0]}))
    done = bodycheck(*(str(case) if word == "CASE" else word for word in words), folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("pinocchio: no integrator RK4; it has semi-implicit-euler, ")
    assert done.stderr.endswith("; did you mean 'rk4'?\n")
    assert [path.name for path in tmp_path.iterdir()] == ["spin.case.toml"]


def test_a_named_engine_without_a_result_fails_and_unsupported_rows_are_counted(calls_here: None, tmp_path: Path) -> None:
    """There is no truth of drag on a plane, and the other case is a free flight."""
    flight, plane = tmp_path / "flight.case.toml", tmp_path / "plane.case.toml"
    flight.write_text(a_case("flight"))
    slide = {"gravity": 9.81, "plane": {"friction": 0.5}, "drag": {"quadratic": 0.1}}
    plane.write_text(a_case("plane", initial={}, scene=slide))
    method = ("--engine", "mujoco", "--integrator", "Euler", "--timestep", "0.01")
    alone = bodycheck("run", plane, *method)
    assert alone.returncode == 1
    reason = "the reference does not model drag on a body that slides"
    assert alone.stderr.splitlines() == [
        f"bodycheck: there is no result of the engine mujoco, which is named: unsupported: {reason}",
        f"bodycheck: there is no result of the integrator Euler, which is named: unsupported: {reason}",
    ]
    both = bodycheck("run", flight, plane, *method)
    assert (both.returncode, both.stderr) == (0, "")
    assert both.stdout.splitlines()[-1].startswith("1 run unsupported. ")
    printed = bodycheck("run", flight, plane, *method, "--json")
    assert len(json.loads(printed.stdout)) == 2
    assert printed.stderr == f"1 of 2 rows is unsupported, for example: {reason}.\n"


def test_an_expected_status_is_a_result(calls_here: None, miniatures: Path, tmp_path: Path) -> None:
    case = tmp_path / "spin.case.toml"
    case.write_text(a_case(expect=[expecting("raising", "closed-form", 0.1, status="crashed")]))
    assert bodycheck("run", case, "--engine", "raising", "--timestep", "0.1").returncode == 0
    case.write_text(a_case())
    assert bodycheck("run", case, "--engine", "raising", "--timestep", "0.1").returncode == 1


def test_a_case_without_any_run_is_told(calls_here: None, tmp_path: Path) -> None:
    """The law of friction is of a plane, and the other case is a free flight."""
    case = tmp_path / "flight.case.toml"
    case.write_text(a_case("flight"))
    done = bodycheck("run", "sliding-brick", case, "--integrator", "law-force", "--timestep", "0.01", "--jobs", "1")
    assert done.returncode == 0
    assert done.stderr.splitlines()[0] == "bodycheck: not run, since no engine has a method for the scene: flight"


@pytest.mark.parametrize("error", ["1", "2.5", "inf", "nan"])
def test_an_error_that_a_relative_figure_always_keeps_is_refused(error: str) -> None:
    done = bodycheck("recommend", "free-brick", "--quantity", "energy", "--error", error)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"--error {error}: must be ")
