"""Many engines and methods in one report: more columns than fit, of which an engine shows its first and its best."""

from typing import Any

import pytest

from bodycheck.judging.judgement import Verdict
from bodycheck.judging.schemes.classes import MethodClass
from bodycheck.reports import notices
from bodycheck.reports.notices import Asked
from bodycheck.reports.runs import markdown_report, matrix
from bodycheck.reports.runs.unsupported import not_supported, with_place
from bodycheck.results.key import RunKey
from tests.support.measured_runs import DRAG, FLIP, SLIDE, ended, matrices_of, ran, refused
from tests.support.wording import facts

#: What a notice on what was not supported may name.
NAMES = (
    *("Not modelled", "Without results", "other reasons", "rotation", "drag", "contact"),
    *("brax", "drake", "exudyn", "mujoco", "newton"),
)

BRICK = "free-brick"


@pytest.fixture
def narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Room for no column, so that a few methods are too many."""
    monkeypatch.setattr(matrix, "MOST_COLUMNS", 0)


def folded(*verdicts: Verdict, **options: Any) -> dict[str, list[str]]:
    """The folded methods of each engine in the only matrix."""
    (found,) = matrices_of(*verdicts, **options)
    names = {column.engine: list[str]() for column in found.columns}
    for column in found.columns:
        names[column.engine] += [column.integrator] if column.folded else []
    return names


def errors(engine: str, **sizes: float) -> list[Verdict]:
    """A run of the flip with each of these methods and attitude errors (rad)."""
    return [ran(FLIP, engine, name, attitude_error=size) for name, size in sizes.items()]


def test_columns_are_methods_and_are_folded_only_where_they_do_not_fit() -> None:
    """Whatever the number of cases is."""
    few = errors("mujoco", **{f"m{place}": 1e-3 for place in range(matrix.MOST_COLUMNS)})
    assert folded(*few) == {"mujoco": []}
    many = [*few, *errors("drake", a=1e-3)]
    assert folded(*many) == {"mujoco": [f"m{place}" for place in range(1, matrix.MOST_COLUMNS)], "drake": []}
    (found,) = matrices_of(*many)
    assert [(engine.columns, engine.shown, engine.methods) for engine in found.engines] == [(12, 1, 11), (1, 1, 0)]
    assert [len(row.cells) for row in found.rows] == [13]


def test_a_row_has_the_step_of_most_of_its_runs_unless_the_matrix_has_one_for_it() -> None:
    slow = [ran(BRICK, integrator=name, timestep=0.01) for name in "ab"]
    (found,) = matrices_of(*(ran(FLIP, integrator=name) for name in "abc"), *slow, ran(BRICK, integrator="c", timestep=0.005))
    assert {row.case: row.timestep for row in found.rows} == {FLIP: 0.002, BRICK: 0.01}
    assert [bool(cell and cell.common) for cell in found.rows[1].cells] == [True, True, False]
    assert found.elsewhere


@pytest.mark.usefixtures("narrow")
def test_an_engine_shows_its_first_method_and_its_best() -> None:
    found = folded(*errors("mujoco", a=1e-2, b=1e-3, c=1e-5, d=1e-4), *errors("drake", e=1e-6, f=1e-3), *errors("dart", g=1.0))
    assert found == {"mujoco": ["b", "d"], "drake": ["f"], "dart": []}


@pytest.mark.usefixtures("narrow")
def test_the_best_method_completes_the_most_cases_and_is_judged_by_its_worst() -> None:
    """Not c, which has no run of the brick, nor d, which is best in one case and bad in the other."""
    even = [
        ran(name, integrator=way, attitude_error=size)
        for name in (FLIP, BRICK)
        for way, size in (("a", 1e-3), ("b", 9e-4), ("e", 1e-2))
    ]
    uneven = [ran(FLIP, integrator="d", attitude_error=1e-9), ran(BRICK, integrator="d", attitude_error=1.0)]
    runs = [*even, ran(FLIP, integrator="c", attitude_error=1e-12), *uneven]
    assert folded(*runs) == {"mujoco": ["e", "c", "d"]}


@pytest.mark.usefixtures("narrow")
def test_a_demonstration_is_not_the_best_of_its_engine() -> None:
    runs = errors("mujoco", a=1e-2, b=1e-6, c=1e-4)
    assert folded(*runs, demonstrations=[runs[1].key.over_cases]) == {"mujoco": ["b"]}


@pytest.mark.usefixtures("narrow")
def test_failed_runs_in_folded_columns_are_counted() -> None:
    runs = errors("mujoco", a=1e-2, b=1e-6, c=1e-4, d=1e-3)
    (found,) = matrices_of(*runs[:2], ended(runs[2], False, "no"), runs[3])
    assert [(engine.methods, engine.failed) for engine in found.engines] == [(2, 1)]


@pytest.mark.usefixtures("narrow")
def test_markdown_folds_them_too() -> None:
    (found,) = matrices_of(*errors("mujoco", a=1e-2, b=1e-3, c=1e-5))
    text, _, rest = markdown_report._matrix(found).partition("<details><summary>1 more method</summary>")
    assert "| Case | mujoco a | mujoco c |" in text
    assert f"| {FLIP} | 0.01 | 1e-5 |" in text
    assert f"| {FLIP} | 0.001 |" in rest


def test_a_method_is_marked_that_is_the_same_algorithm_as_one_before() -> None:
    same = MethodClass((RunKey.of_method("mujoco", "a"), RunKey.of_method("drake", "c")), 1e-15)
    runs = [*errors("mujoco", a=1e-2, b=1e-3), *errors("drake", c=1e-2)]
    (found,) = matrices_of(*runs, classes={"flight": (same,), "plane": (MethodClass(same.methods[::-1], 0.0),)})
    assert [column.same_as for column in found.columns] == ["", "", "mujoco a"]
    assert "| drake c (= mujoco a) |" in markdown_report._matrix(found)


def test_what_engines_do_not_model_is_told_in_one_line() -> None:
    refusals = [
        *(
            refused(SLIDE, name, f"{name} 1 does not model contact, friction", way)
            for name in ("brax", "exudyn")
            for way in "ab"
        ),
        refused(DRAG, "newton", "newton 1 does not model drag"),
        refused(DRAG, "mujoco@3.17.0", "mujoco 1 does not model rotation"),
    ]
    (told,) = not_supported([*refusals, ran(SLIDE), ran(DRAG)])
    assert facts(told, *NAMES, "mujoco@3.17.0") == [
        *("Not modelled", "rotation", "mujoco@3.17.0", "drag", "newton", "contact", "brax", "exudyn"),
    ]
    assert not_supported([ran(SLIDE)]) == ()


def test_other_reasons_are_told_by_kind_of_scene_with_the_runs_that_they_concern() -> None:
    slides = [refused(SLIDE, "mujoco", f"the friction is {place}", f"i{place}") for place in range(5)]
    drag = refused(DRAG, "drake", "no such model")
    first, second = not_supported([*slides, ran(SLIDE), drag])
    assert facts(first, *NAMES, "no such model") == ["Without results", "drag", "drake", "no such model"]
    each = [word for place in "012" for word in ("mujoco", "1", "6", f"the friction is {place}")]
    assert facts(second, *NAMES, *(f"the friction is {place}" for place in range(5))) == [
        *("Without results", "contact", *each, "2", "other reasons"),
    ]


def test_where_only_cases_are_known_an_engine_that_refuses_all_runs_of_some_is_named_alone() -> None:
    """As in studies, whose rows do not have the kind of the scene."""
    asked = [
        Asked(case, "brax", "1", f"brax 1 does not model {lack}")
        for case, lack in (("a", "drag"), ("b", "drag"), ("c", "contact"))
    ]
    (several,) = notices.not_supported([*asked, Asked("d", "brax", "1", "")])
    assert facts(several, *NAMES) == ["Not modelled", "drag", "brax", "contact", "brax"]
    (some,) = notices.not_supported([*asked[:1], Asked("a", "brax", "1", "")])
    assert facts(some, *NAMES) == ["Not modelled", "drag", "brax", "1", "2"]


@pytest.mark.parametrize(("passed", "seen"), [(None, 1), (True, 1), (False, 2)])
def test_unsupported_runs_have_a_place_in_tables_only_where_they_failed(passed: bool | None, seen: int) -> None:
    runs = [ran(FLIP), ended(refused(FLIP, "brax", "no"), passed)]
    assert len(with_place(runs)) == seen
