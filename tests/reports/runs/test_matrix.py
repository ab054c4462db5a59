"""The matrix of a report and the verdict above it: each run once, by the figure that its kind of scene is told by."""

from types import SimpleNamespace
from typing import Any

import pytest

from bodycheck import load
from bodycheck.adapters.contract import Method
from bodycheck.casefile.expectation import Expectation
from bodycheck.judging.judgement import Breach, Judged, Verdict
from bodycheck.reference.requirements import requirements
from bodycheck.reports.lines import assign, paled
from bodycheck.reports.runs import markdown_report
from bodycheck.reports.runs.demonstrations import demonstrated
from bodycheck.reports.runs.findings import findings, measured
from bodycheck.reports.runs.kinds import KINDS, kind_of
from bodycheck.reports.runs.matrix import Matrix, decade
from bodycheck.reports.runs.summary import broken, expectation_status, headline, tally
from bodycheck.results.outcome import Diverged
from tests.support.cases import OF_ONE_BODY
from tests.support.measured_runs import DRAG, FLIGHT, FLIP, SLIDE, ended, matrices_of, ran
from tests.support.wording import facts


@pytest.mark.parametrize("name", OF_ONE_BODY)
def test_a_kind_follows_from_what_a_scene_requires(name: str) -> None:
    scene = load(name).scene
    needs, kind = requirements(scene), kind_of(scene)
    assert (kind.name == "contact") == needs.contact
    assert (kind.name == "drag") == (needs.drag and not needs.contact)
    assert (kind.quantity == "attitude_error") == (kind.name == "turning")
    assert (kind.name != "translation") or needs.rotation == "none"


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        *[("pendulum-large", "mechanism"), ("slider-all", "sliding"), ("cart-pole", "mechanism")],
        *[("gripped-block-holds", "contact"), ("stack-of-ten", "contact")],
    ],
)
def test_mechanisms_are_told_apart_by_whether_bodies_touch_and_whether_any_turns(name: str, kind: str) -> None:
    assert kind_of(load(name).scene).name == kind


def test_every_kind_has_its_figure_and_only_its_methods() -> None:
    found = matrices_of(
        ran(SLIDE, "pinocchio", "admm"), ran(FLIP), ran(FLIGHT, integrator="RK4"), ran(DRAG, integrator="Euler:drag=fluid")
    )
    assert [matrix.kind for matrix in found] == [kind for kind in KINDS if kind.name not in ("mechanism", "sliding")]
    assert [[column.integrator for column in matrix.columns] for matrix in found] == [
        ["Euler"],
        ["RK4"],
        ["Euler:drag=fluid"],
        ["admm"],
    ]
    texts = [cell.common.text for matrix in found for row in matrix.rows for cell in row.cells if cell and cell.common]
    assert texts == [number_of("attitude_error"), *[number_of("position_error")] * 3]


def number_of(name: str) -> str:
    return {"attitude_error": "0.0003", "position_error": "0.02"}[name]


def test_other_time_steps_stand_in_the_same_cell() -> None:
    steps = (0.001, 0.002, 0.01)
    runs = [ran(FLIP, timestep=step, attitude_error=step) for step in steps]
    (matrix,) = matrices_of(*runs, ran("free-brick"), ran(FLIP, "pinocchio", "rk4", 0.005, attitude_error=1e-8))
    assert matrix.timestep == 0.002
    assert [(column.engine, column.integrator) for column in matrix.columns] == [("mujoco", "Euler"), ("pinocchio", "rk4")]
    euler, rk4 = matrix.rows[0].cells
    assert euler is not None
    assert rk4 is not None
    assert [(figure.timestep, figure.text) for figure in euler.figures] == [(0.002, "0.002"), (0.01, "0.01"), (0.001, "0.001")]
    assert rk4.common is None
    assert [(figure.timestep, figure.decade) for figure in rk4.others] == [(0.005, -8)]
    assert matrix.rows[1].cells[1] is None
    text = markdown_report._matrix(matrix)
    assert "| 0.002, 0.01 (10 ms), 0.001 (1 ms) | 1e-8 (5 ms) |" in text


def test_every_run_is_in_one_cell() -> None:
    runs = [
        ran(name, integrator=f"i{place % 3}", timestep=0.001 * (1 + place % 2)) for name in OF_ONE_BODY for place in range(6)
    ]
    found = matrices_of(*runs)
    cells = [cell for matrix in found for row in matrix.rows for cell in row.cells if cell is not None]
    assert sum(len(cell.figures) for cell in cells) == len(runs)
    assert sorted(row.case for matrix in found for row in matrix.rows) == sorted(OF_ONE_BODY)


def test_what_failed_and_what_is_within_the_truths_own_error_is_marked() -> None:
    gone = Diverged("not a number")
    (matrix,) = matrices_of(
        ended(ran(FLIP, integrator="a"), False, "no"),
        ended(ran(FLIP, integrator="b"), False, "not a number", outcome=gone, discrepancy=None),
        ran(FLIP, integrator="c", attitude_error=1e-15),
        ran(FLIP, integrator="d"),
    )
    figures = [figure for cell in matrix.rows[0].cells if cell for figure in cell.figures]
    assert [figure.failed for figure in figures] == [True, True, False, False]
    assert [figure.text for figure in figures] == ["0.0003", "diverged", "≤ 1e-14", "0.0003"]
    assert [figure.decade for figure in figures] == [-4, None, None, -4]
    assert figures[1].meaning == "at 2 ms: not a number"


def test_a_position_within_the_truths_own_error_is_marked_too() -> None:
    within = ran(FLIGHT, integrator="a", position_error=2e-14, truth_position_error=3e-14)
    (matrix,) = matrices_of(within, ran(FLIGHT, integrator="b", position_error=4e-14, truth_position_error=3e-14))
    figures = [figure for cell in matrix.rows[0].cells if cell for figure in cell.figures]
    assert [(figure.text, figure.decade) for figure in figures] == [("≤ 3e-14", None), ("4e-14", -12)]
    assert figures[0].meaning == "at 2 ms: within the truth's own error (3e-14 m)"


def test_findings_leave_out_what_is_within_the_truths_own_error() -> None:
    """A truth that is off by a millimetre, as no truth is: only what exceeds its bounds is told."""
    uncertain = {"truth_position_error": 1e-3, "truth_angular_momentum_error": 1e-5}
    runs = [
        ran(FLIP, integrator="a", position_error=1e-4, angular_momentum_drift=1e-6, **uncertain),
        ran(FLIP, integrator="b", position_error=5e-4, angular_momentum_drift=2e-6, **uncertain),
    ]

    def told(*verdicts: Verdict) -> dict[str, str]:
        lines = assign(verdict.key.over_cases for verdict in verdicts)
        return {finding.subject: finding.text for finding in findings(measured(verdicts, lines), (), lines)}

    assert "Angular momentum" not in told(*runs)
    beyond = told(*runs, ran(FLIP, integrator="c", position_error=2.0, angular_momentum_drift=1e-4, **uncertain))
    assert facts(beyond["Angular momentum"], "mujoco c")[:2] == ["0.01", "mujoco c"]


def test_an_engine_spans_its_columns_in_its_colour() -> None:
    (matrix,) = matrices_of(ran(FLIP, "pinocchio", "x"), ran(FLIP, integrator="a"), ran(FLIP, integrator="b"))
    assert [(own.engine, own.columns) for own in matrix.engines] == [("pinocchio", 1), ("mujoco", 2)]
    assert {own.engine: own.colour for own in matrix.engines} == {"pinocchio": "#d55e00", "mujoco": "#0072b2"}


def told(matrix: Matrix) -> list[tuple[str, int, str]]:
    """Each engine with the number of its columns and its colour."""
    return [(own.engine, own.columns, own.colour) for own in matrix.engines]


def test_an_engine_has_the_colour_of_its_last_set_of_results() -> None:
    """One engine is in the first set alone, one in the last alone, and one in both."""
    runs = [
        *(ran(FLIP, "drake", "x", label="first"), ran(FLIP, label="first")),
        *(ran(FLIP, label="last"), ran(FLIP, "pinocchio", "y", label="last")),
    ]
    (matrix,) = matrices_of(*runs)
    first, last = paled("#009e73", 1), "#d55e00"
    assert told(matrix) == [("drake", 1, first), ("mujoco", 2, "#0072b2"), ("pinocchio", 1, last)]
    (alone,) = matrices_of(ran(FLIP, "drake", "x", label="first"), ran(FLIGHT, label="last"))[:1]
    assert told(alone) == [("drake", 1, first)]


@pytest.mark.parametrize(
    ("error", "expected"), [(0.0, -12), (1e-300, -12), (1e-12, -12), (9.99e-6, -6), (0.5, -1), (1.0, 0), (217.0, 0)]
)
def test_decades(error: float, expected: int) -> None:
    assert decade(error) == expected


def test_a_known_discrepancy_is_not_said_to_hold() -> None:
    expectation = Expectation("mujoco", Method.parse("Euler", 0.002))
    known = Judged(expectation, (Breach("attitude_error", "1 rad", "at most 0.1 rad"),), True, "known until then")
    held = Judged(expectation, (), True, "")
    verdicts = [ended(ran(FLIP), True, judged=(held,)), ended(ran(FLIGHT), True, "known until then", judged=(known,))]
    assert [expectation_status(verdict) for verdict in verdicts] == ["held", "known"]
    complete: Any = SimpleNamespace(complete=True, unchecked=())
    assert facts(headline(complete, verdicts), "None", "failed", "known") == ["None", "2", "failed", "1", "1", "known"]
    assert dict(tally(verdicts))["known discrepancies"] == 1
    assert facts(headline(complete, verdicts[:1]), "None", "failed", "known") == ["None", "1", "failed", "1"]


def test_what_failed_is_told_with_the_first_of_it() -> None:
    runs = [ended(ran(name), False, "attitude_error is 1 rad") for name in (FLIP, FLIGHT)]
    lines = assign(verdict.key.over_cases for verdict in runs)
    assert broken([ran(FLIP)], lines) is None
    alone, both = broken(runs[:1], lines), broken(runs, lines)
    assert alone is not None
    assert both is not None
    first = ["mujoco Euler", FLIP, "expectation broken", "attitude_error", "1"]
    names = ("mujoco Euler", FLIP, FLIGHT, "expectation broken", "attitude_error")
    assert facts(alone.text, *names) == first
    assert facts(both.text, *names) == ["2", "2", *first]


def test_findings_are_about_demonstrations_only_where_nothing_else_was_run() -> None:
    runs = [
        ran(FLIP, "pinocchio", "naive:model=a", angular_momentum_drift=0.5),
        *(ran(FLIP, integrator=name, angular_momentum_drift=drift) for name, drift in (("a", 1e-3), ("b", 1e-6))),
    ]
    header: Any = {"demonstrations": {"pinocchio": {"naive": "what goes wrong"}}}

    def told(*verdicts: Verdict) -> str:
        lines = assign(verdict.key.over_cases for verdict in verdicts)
        return str([one.text for one in findings(measured(verdicts, lines), (), lines, demonstrated(header, lines))])

    assert "naive" not in told(*runs)
    assert "mujoco a" in told(*runs)
    assert "50 % with pinocchio naive" in told(runs[0])


def test_rounding_is_not_compared_between_engines() -> None:
    """Errors of rounding alone differ between engines whose schemes are one."""
    verdicts = [
        ran(name, engine, attitude_error=error)
        for engine, rounding in (("mujoco", 7e-13), ("pinocchio", 2e-13))
        for name, error in ((FLIP, 2.1), ("free-brick", rounding))
    ]
    lines = assign(verdict.key.over_cases for verdict in verdicts)
    told = {finding.subject: finding.text for finding in findings(measured(verdicts, lines), (), lines)}
    names = ("mujoco Euler", "pinocchio Euler", "attitude", "position", "all cases")
    assert facts(told["Alike"], *names)[:5] == list(names)
