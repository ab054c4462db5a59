"""The search for settings, on planted errors whose best setting is known."""

import math
from collections.abc import Mapping, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.adapters.contract import Engine, Integrator, Method, Option, Range, choice
from bodycheck.studies.contact.search import FINER, FLOOR, HOPELESS, Errors, promising, score, search, variations

OPTIONS = {
    "cone": choice("elliptic", "pyramidal"),
    "ratio": Option("a number above 0", numbers=((Range(0.0, above=True),),)),
    "flat": choice("on", kinds=frozenset({"plane"})),
    "model": choice("planar"),
}
ENGINE = Engine(
    name="toy",
    distribution="toy",
    version="1",
    integrators=(
        Integrator("euler", options=OPTIONS),
        Integrator("heun", options=OPTIONS),
        Integrator("never", options=OPTIONS, refuses={"contact": "does not touch"}),
        Integrator("flying", kinds=frozenset({"flight"}), options=OPTIONS),
    ),
    models=frozenset(),
    variants={"contact": ("euler:cone=elliptic,ratio=3",)},
)
START = Method.parse("euler", 0.004)


def factor(method: Method, best: Mapping[str, str]) -> float:
    """The errors of a method: each choice that is the best one halves them, and so does each halving of the step."""
    right = sum((method.integrator if key == "integrator" else method.option(key)) == value for key, value in best.items())
    return 0.5**right * method.timestep / START.timestep


def searched(best: Mapping[str, str], start: Method = START) -> tuple[Method, Mapping[Method, float]]:
    def measure(methods: Sequence[Method]) -> dict[Method, Errors]:
        return {method: {"slide": factor(method, best), "roll": 3 * factor(method, best)} for method in methods}

    found = search(ENGINE, "contact", (start,), measure)
    return found.method, found.scores


@given(
    st.sampled_from(["euler", "heun"]),
    st.sampled_from(["elliptic", "pyramidal"]),
    st.sampled_from(["0.01", "0.1", "1", "10", "100"]),
)
def test_independent_choices_are_all_found_together(integrator: str, cone: str, ratio: str) -> None:
    best, scores = searched({"integrator": integrator, "cone": cone, "ratio": ratio})
    assert (best.integrator, best.option("cone"), best.option("ratio")) == (integrator, cone, ratio)
    assert best.timestep == FINER * START.timestep
    assert scores[best] == min(scores.values())
    assert math.isclose(scores[START], 1)


def test_only_what_the_engine_offers_and_what_is_a_setting_of_contacts_is_tried() -> None:
    tried = [method.name for _, method in variations(ENGINE, "contact", START)]
    assert tried == [
        "heun",
        "euler:cone=elliptic",
        "euler:cone=pyramidal",
        *(f"euler:ratio={number}" for number in ("0.01", "0.1", "1", "10", "100")),
        "euler:cone=elliptic,ratio=3",
    ]
    assert "euler" in {method.name for _, method in variations(ENGINE, "contact", Method.parse("euler:cone=elliptic", 0.004))}


def test_a_listed_method_with_several_choices_can_be_the_best() -> None:
    assert searched({"ratio": "3", "cone": "elliptic"})[0].name == "euler:cone=elliptic,ratio=3"


def test_a_method_that_fails_in_a_scene_of_the_start_is_never_the_best() -> None:
    def measure(methods: Sequence[Method]) -> dict[Method, Errors]:
        return {method: {"slide": 1.0} | ({} if method.options else {"roll": 1.0}) for method in methods}

    found = search(ENGINE, "contact", (START,), measure)
    assert found.method == START
    assert math.isinf(found.scores[Method.parse("euler:cone=elliptic", START.timestep)])


def test_without_a_scene_that_the_start_completes_nothing_is_searched() -> None:
    found = search(ENGINE, "contact", (START,), lambda methods: {method: {} for method in methods})
    assert (found.method, dict(found.scores)) == (START, {START: 1.0})


def test_rounding_at_rest_does_not_decide() -> None:
    assert score({"rest": 1e-16, "slide": 1e-3}, {"rest": 1e-12, "slide": 1e-3}) == 1
    assert score({"rest": FLOOR / 10}, {"rest": 10 * FLOOR}) == pytest.approx(0.1)
    assert math.isinf(score({"rest": math.inf}, {"rest": 1.0}))


def test_what_is_much_worse_in_the_first_scenes_is_not_worth_the_others() -> None:
    start = {"roll": 1e-3, "slide": 2e-3}
    assert promising({"roll": HOPELESS * 1e-3}, {"roll": 1e-3})
    assert not promising({"roll": 1.1 * HOPELESS * 1e-3}, {"roll": 1e-3})
    # What is worse in one scene may be better in another by as much.
    assert promising({"roll": 10 * HOPELESS * 1e-3, "slide": 0.1 * 2e-3}, start)
    assert not promising({"roll": 1e-4}, start), "it does not complete a scene that the start completes"
    assert promising({}, {}), "there is nothing to compare with yet"
