"""What a case expects: limits, ranges, orders, statuses, and discrepancies that are known for a while."""

from datetime import date

import pytest

from bodycheck import Case, CaseFaults, load, simulate
from bodycheck.adapters import registry
from bodycheck.casefile.case import parse, parse_stored
from bodycheck.casefile.expectation import Limit
from bodycheck.casefile.values import MAX_EXPECTATIONS
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from tests.support.truths import truth_for_runs
from tests.support.wording import facts

DAY = date(2027, 1, 1)
BEGINNING = load("free-brick").text.partition("[[expect]]")[0]
METHOD = '[[expect]]\nengine = "mujoco"\nintegrator = "{integrator}"\ntimestep = 0.01\n'


def expecting(*lines: str, integrator: str = "Euler") -> Case:
    return parse(BEGINNING + METHOD.format(integrator=integrator) + "\n".join(lines), "free-brick")


def judged(case: Case, integrator: str = "Euler", today: date = DAY) -> Verdict:
    return judgement.verdict(case, truth_for_runs(case, 0.01), simulate(case, "mujoco", integrator, 0.01), today=today)


@pytest.fixture(scope="module")
def measured() -> float:
    """The attitude error of MuJoCo's Euler on the free brick at 10 ms."""
    discrepancy = judged(expecting('status = "ok"')).discrepancy
    assert discrepancy is not None
    return discrepancy.maxima()["attitude_error"]


@pytest.mark.parametrize(("least", "most", "passed"), [(0.9, 1.1, True), (1.1, 2.0, False), (0.5, 0.9, False)])
def test_a_figure_must_be_in_its_range(measured: float, least: float, most: float, passed: bool) -> None:
    """A known defect that vanishes is news too."""
    case = expecting(f"attitude_error = {{at_least = {least * measured}, at_most = {most * measured}}}")
    verdict = judged(case)
    assert verdict.passed is passed
    if not passed:
        assert f"attitude_error is {measured:.4g} rad, expected at least" in verdict.reason
        assert "worst at t = " in verdict.reason
        assert "the truth's own error is" in verdict.reason


def test_a_range_may_be_open(measured: float) -> None:
    assert judged(expecting(f"attitude_error = {{at_least = {measured * 0.9}}}")).passed is True
    assert judged(expecting(f"attitude_error = {{at_most = {measured * 0.9}}}")).passed is False
    (expectation,) = expecting("order = 4").expectations
    assert expectation.limits == (Limit("order", 3.75, 4.25),)


def test_a_status_may_be_expected() -> None:
    assert judged(expecting('status = "ok"')).passed is True
    wrong = judged(expecting('status = "diverged"'))
    assert (wrong.passed, facts(wrong.reason, "status", "ok", "expected", "diverged")) == (
        False,
        ["status", "ok", "expected", "diverged"],
    )
    # At some turns a step.
    fast = BEGINNING.replace("10.0]", "1000.0]")
    assert fast != BEGINNING
    text = '[[expect]]\nengine = "mujoco"\nintegrator = "Euler"\ntimestep = 0.01\nstatus = "diverged"\n'
    verdict = judged(parse(fast + text, "fast"))
    assert (verdict.outcome.status, verdict.passed) == ("diverged", True)
    assert verdict.reason, "why it diverged is told all the same"


def test_a_known_discrepancy_is_green_until_its_day_and_told_either_way(measured: float) -> None:
    broken, held = (
        expecting(f"attitude_error = {limit}", 'known = "https://example.org/7"', 'until = "2027-06-01"')
        for limit in (measured / 2, measured * 2)
    )
    tolerated = judged(broken, today=date(2027, 6, 1))
    assert (tolerated.passed, tolerated.known) == (True, True)
    words = ("known", "2027-06-01", "https://example.org/7", "attitude_error", "no longer tolerated", "holds")
    assert facts(tolerated.reason, *words)[:4] == ["known", "2027-06-01", "https://example.org/7", "attitude_error"]
    over = judged(broken, today=date(2027, 6, 2))
    assert over.passed is False
    assert facts(over.reason, *words)[:4] == ["no longer tolerated", "2027-06-01", "https://example.org/7", "attitude_error"]
    mended = judged(held, today=date(2030, 1, 1))
    assert (mended.passed, facts(mended.reason, *words)) == (True, ["known", "https://example.org/7", "holds"])


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        (["attitude_error = {at_least = 2.0, at_most = 1.0}"], "expect[1].attitude_error: at_least is larger than at_most"),
        (["attitude_error = {}"], "contains no limit; allowed: at_least, at_most"),
        (["attitude_error = {at_last = 1.0}"], "unknown key; allowed: at_least, at_most"),
        (["attitude_error = {at_least = -1.0}"], "expect[1].attitude_error.at_least: read -1.0"),
        (["attitude_error = -1.0"], "expect[1].attitude_error: read -1.0"),
        (['attitude_error = "small"'], "expect[1].attitude_error: read 'small'"),
        (
            ['status = "diverged"', "attitude_error = 1.0"],
            "the status diverged has no errors to limit; give status alone",
        ),
        (['status = "broken"'], "expect[1].status: read 'broken'"),
        (["attitude_error = 1.0", 'known = "x"'], "expect[1].until: is missing; known requires it"),
        (["attitude_error = 1.0", 'until = "2027-06-01"'], "expect[1].known: is missing; until requires it"),
        (["attitude_error = 1.0", 'known = "x"', 'until = "June"'], 'should be a date such as "2027-06-01"'),
        (["attitude_error = 3.1415926535897932"], "expect[1].attitude_error: read 3.141592653589793; this limit cannot fail"),
        (["tilt = {at_least = 1.0, at_most = 4.0}"], "expect[1].tilt.at_most: read 4.0; this limit cannot fail"),
        (["stop_time_error = 10.1"], "no run has more than 10.005 s; allowed: less than 10.005 s"),
        (["energy_drift = {at_least = 0}"], "expect[1].energy_drift.at_least: read 0; this limit cannot fail"),
        ([], "contains no expectation; give at least one of status, position_error"),
    ],
)
def test_what_cannot_be_expected_is_refused(lines: list[str], fault: str) -> None:
    with pytest.raises(CaseFaults) as caught:
        expecting(*lines)
    assert fault in str(caught.value)
    assert len(caught.value.faults) == 1


def test_the_order_of_a_method_with_an_accuracy_cannot_be_expected() -> None:
    method = 'engine = "drake"\nintegrator = "runge_kutta3:accuracy=1e-6"\ntimestep = 0.01\n'
    with pytest.raises(CaseFaults) as caught:
        parse(f"{BEGINNING}[[expect]]\n{method}order = 3\n", "case")
    assert "expect[1].order: read 3; a method with an accuracy chooses its steps" in str(caught.value)


def test_limits_below_the_most_possible_are_accepted() -> None:
    lines = ("attitude_error = 3.14159", "tilt = {at_least = 0, at_most = 3}", "stop_time_error = 10", "energy_drift = 7.0")
    (expectation,) = expecting(*lines, "order = {at_least = 0}").expectations
    assert len(expectation.limits) == 5


OTHER = 'attitude_error = 1.0\n[[expect]]\nengine = "{}"\ntimestep = {}\nintegrator = "Euler"\nstatus = "ok"'


@pytest.mark.parametrize("text", ["attitude_error = 4.2", OTHER.format("gone", 0.1), OTHER.format("mujoco", 20.0)])
def test_stored_results_may_expect_what_cannot_be_checked(text: str) -> None:
    """Those of earlier versions, and of machines that have other engines."""
    text = METHOD.format(integrator="Euler") + text
    with pytest.raises(CaseFaults):
        parse(BEGINNING + text, "f")
    assert parse_stored(BEGINNING + text, "f").expectations


def test_an_engine_that_nobody_knows_is_a_fault_and_a_version_is_none() -> None:
    text = BEGINNING + METHOD.format(integrator="Euler") + "attitude_error = 1.0\n"
    with pytest.raises(CaseFaults) as caught:
        parse(text.replace('"mujoco"', '"mujocco"'), "f")
    (fault,) = caught.value.faults
    assert (fault.key, fault.position) == ("expect[1].engine", (BEGINNING.count("\n") + 2, 1))
    known = ", ".join(registry.names())
    assert fault.message == f"read 'mujocco'; there is no such engine; allowed: {known}; did you mean 'mujoco'?"
    (expectation,) = parse(text.replace('"mujoco"', '"mujoco@3.17.0"'), "f").expectations
    assert expectation.engine == "mujoco@3.17.0"


def test_only_as_many_expectations_are_checked_as_a_file_may_have() -> None:
    """A file of a quarter of a million bytes may hold tens of thousands of tables, each of which would be looked at."""
    text = METHOD.format(integrator="Euler").replace('"mujoco"', '"mujocco"') + "attitude_error = 1.0\n"
    with pytest.raises(CaseFaults) as caught:
        parse(BEGINNING + text * (MAX_EXPECTATIONS + 500), "f")
    # A hundred faults are told; the others are those of the allowed tables, and that there are too many of them.
    assert caught.value.faults[-1].message == f"{MAX_EXPECTATIONS + 1 - 100} more faults"
