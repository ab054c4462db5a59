"""tradeoff and recommend search over the accuracies of methods with error control, with a miniature engine."""

from pathlib import Path

import pytest

from bodycheck import Case, compare, simulate, truth
from bodycheck.adapters.method import Method
from bodycheck.casefile.case import parse
from bodycheck.files.temporary import temporary_folder
from bodycheck.judging import judgement
from bodycheck.running import campaign, named
from bodycheck.running.named import Named, decide, of_search
from bodycheck.studies import cost
from bodycheck.studies.recommend import study as recommending
from bodycheck.studies.recommend import wording
from bodycheck.studies.recommend.page import present
from bodycheck.studies.timesteps import ACCURACIES, FINE_ACCURACIES
from bodycheck.studies.tradeoff import page, study
from bodycheck.studies.tradeoff.measurements import measured, method_of
from tests.support import campaigns
from tests.support.cases import a_case
from tests.support.processes import calls_here

SPELLING = "bs3:accuracy=3e-5"


@pytest.fixture
def case(miniatures: Path, monkeypatch: pytest.MonkeyPatch) -> Case:
    """Half a second of a flip, whose costs are measured roughly."""
    monkeypatch.setattr(cost, "MIN_TIMING_S", cost.MIN_TIMING_S / 20)
    monkeypatch.setattr(cost, "ROUNDS", 2)
    text = a_case(
        "flip",
        body={"shape": "brick", "semi_axes": [0.05, 0.1, 0.2], "mass": 1.0},
        initial={"angular_velocity": [0.1, 20.0, 0.1]},
        run={"duration": 0.5, "samples": 11},
    )
    return parse(text, "flip")


@pytest.mark.slow
def test_tradeoff_searches_over_accuracies_and_observes_orders_against_steps(case: Case, tmp_path: Path) -> None:
    records = campaigns.records("adaptive")
    tasks = study.plan([case], records, [SPELLING, "bs3:accuracy=1e-2"], [])
    assert [task.method.accuracy for task in tasks] == list(ACCURACIES)
    assert {task.method.timestep for task in tasks} == {case.duration / 10}
    named.check_planned(Named(integrator=(SPELLING,)), records, [(task.engine, task.method) for task in tasks])
    results = campaigns.results(tasks[2:7], tmp_path)
    verdicts = judgement.judge(results)
    with calls_here():
        rows = study.price(results, verdicts, records)
    orders = {order.quantity: order for order in study.orders(results, verdicts, records)}
    assert orders["attitude"].integrator == "bs3:accuracy=any"
    assert orders["attitude"].claimed == 3
    # The error of a step is kept equal and not its length, and the fewest steps are not yet asymptotic.
    assert orders["attitude"].order == pytest.approx(3, abs=0.4)
    assert len({method_of(row) for row in rows}) == 1
    points = measured(rows, "attitude")
    assert [point.setting for point in points][:2] == ["an accuracy of 0.0001", "an accuracy of 1e-5"]
    for point, row in zip(points, rows, strict=True):
        assert point.step == pytest.approx(case.duration / row["steps_taken"], rel=1e-12)
        assert row["wall_time"] == pytest.approx(row["cost"] * case.duration, rel=1e-12)
        assert row["evaluations"] == pytest.approx(4, abs=2)
    report = page.present(results.header, rows, list(orders.values()), {})
    assert "bs3:accuracy=any" in str(report)
    assert not decide(Named(integrator=(SPELLING,)), of_search(rows, (SPELLING,))).lost
    assert decide(Named(integrator=("plain",)), of_search(rows, ("plain",))).lost


def test_recommend_answers_with_an_accuracy_whose_method_repeats_the_error(case: Case) -> None:
    records = campaigns.records("adaptive")
    planned = recommending.prepare(case, records, [SPELLING], "attitude", 1e-4)
    head = campaign.header(["bodycheck", "recommend"], records, {})
    with calls_here(), temporary_folder() as folder, recommending.results(planned, folder, head, 1) as recommendation:
        (answer,) = recommendation.answers
        method = Method.parse(answer.integrator, answer.timestep or 0.0)
        assert answer.reached
        assert method.accuracy in FINE_ACCURACIES
        assert method.timestep == case.duration / 10
        again = compare(truth(case), simulate(case, "adaptive", answer.integrator)).maxima()["attitude_error"]
        assert again == answer.error
        assert again <= 1e-4
        # The next two larger accuracies break the limit: the answer keeps a neighbour between itself and the last of them.
        errors = recommendation.asked.errors(recommendation.probes)
        number = wording.number_of(recommendation, answer)
        assert errors[number - 1] <= 1e-4
        assert errors[number - 2] > 1e-4
        assert wording.headline(recommendation).startswith(f"adaptive {answer.integrator} with steps of at most 0.05 s: ")
        assert "with accuracies from " in wording.margin(recommendation)
        assert f"With an accuracy of {FINE_ACCURACIES[number - 3]:g}, it is" in wording.margin(recommendation)
        assert "over the accuracy" in str(present(head, recommendation))
