"""The truths of a case for all time steps come from one computation, and are what each would be on its own."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import load
from bodycheck.casefile.robots import loading
from bodycheck.reference import truth
from bodycheck.reference.bounds import NAMES
from bodycheck.reference.certified import Certificate
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.mechanisms.hybrid.deciding import add_criticals
from bodycheck.reference.mechanisms.link_states import Critical
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.running import truths
from bodycheck.running.tasks import Question, answer
from tests.support.cases import shortened
from tests.support.driven_hinge import hinge
from tests.support.truths import truth_for_runs

#: Steps whose multiples are hardly ever the same instants, and of which some do not divide the duration.
STEPS = (0.01, 0.0033, 0.0007)

#: One of each kind of motion: elliptic functions, drag, integrated slides on an area and on corners, a slide in closed form.
KINDS = ("intermediate-axis-flip", "football-drag", "curling-disk", "curling-brick-corners", "sliding-brick")


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The numbers of instants at which truths are computed from now on."""
    counts: list[int] = []
    compute = truth.truth

    def counted(scene: Any, times: Any) -> Truth:
        counts.append(len(times))
        return compute(scene, times)

    monkeypatch.setattr(truth, "truth", counted)
    return counts


@pytest.mark.parametrize("name", KINDS)
def test_truths_that_are_computed_together_are_those_of_each_time_step(name: str, computed: list[int]) -> None:
    case = load(name)
    together = truths.of_runs(case, STEPS)
    assert len(computed) == 1
    for timestep in STEPS:
        alone = truth_for_runs(case, timestep)
        part = together[timestep]
        for states in ("t", "position", "quaternion", "velocity", "angular_velocity"):
            np.testing.assert_array_equal(getattr(part.trajectory, states), getattr(alone.trajectory, states))
        for bound in NAMES:
            # Of a slide in closed form, the witness's quadrature ends at the last instant, so that the rounding errors that it
            # measures are others: a few of the 16 roundings that the bound has anyway.
            rtol = 0.25 if name == "sliding-brick" else 1e-12
            np.testing.assert_allclose(getattr(part.bounds, bound), getattr(alone.bounds, bound), rtol=rtol, atol=0)
        assert (part.stop, part.witnesses, part.model) == (alone.stop, alone.witnesses, alone.model)


def test_a_truth_that_ends_before_the_stop_has_none() -> None:
    case = load("sliding-brick")
    whole = truths.truth(case)
    assert whole.stop is not None
    before, after = (whole.at(whole.trajectory.t[chosen]) for chosen in (case.instants < whole.stop.time, case.instants >= 0.5))
    assert (before.stop, after.stop) == (None, whole.stop)


def test_a_thousand_time_steps_take_one_computation(computed: list[int]) -> None:
    case = shortened(load("curling-brick"), 0.5, 11)
    steps = [0.02 / count for count in range(1, 1001)]
    (batch,) = truths.batches(case, [*steps, *steps])
    assert batch == tuple(steps)
    found = truths.of_runs(case, batch)
    assert list(found) == steps
    assert len(computed) == 1


def test_a_batch_has_no_more_instants_than_memory_allows() -> None:
    case = shortened(load("free-brick"), 1.0, 100_001)
    steps = [1e-5 * count for count in range(1, 51)]
    batches = truths.batches(case, steps)
    assert [step for batch in batches for step in batch] == steps
    assert all(len(batch) == truths.MAX_INSTANTS // 100_001 for batch in batches[:-1])


def test_long_truths_come_first() -> None:
    """First closed loops, then many bodies; cases that are alike keep their order."""
    names = ["free-brick", "chain-3", "slider-crank", "chain-20", "projectile"]
    ordered = sorted(map(load, names), key=truths.effort, reverse=True)
    assert [case.name for case in ordered] == ["slider-crank", "chain-20", "chain-3", "free-brick", "projectile"]


#: Two arms with dry friction, of which one follows the other.
DRY = """<mujoco><option gravity="0 0 0"/><worldbody>
<body><joint name="j" axis="0 1 0" frictionloss="0.2"/><geom size="0.1" pos="0.3 0 0"/></body>
<body pos="0 3 0"><joint name="l" axis="0 1 0" frictionloss="0.1"/><geom size="0.1" pos="0.3 0 0"/></body>
</worldbody><equality><joint joint1="l" joint2="j"/></equality></mujoco>"""


def test_the_reason_of_a_robot_without_truth_names_the_option_that_gives_it_one(tmp_path: Path) -> None:
    (tmp_path / "robot.xml").write_text(DRY)
    refused = answer(Question(loading.load(tmp_path / "robot.xml"), None, certified=False))
    assert isinstance(refused, NoTruth)
    assert refused.reason.endswith(
        'there may be a truth without dry friction: --ignore friction, or ignore = ["friction"] in [model] of a case'
    )
    smooth = loading.load(tmp_path / "robot.xml", ignore=["friction"])
    assert isinstance(answer(Question(smooth, None, certified=False)), Truth)


@pytest.mark.parametrize(("friction", "cause"), [(0.1, "dry friction"), (0.0, "stops")])
def test_rest_that_rounding_leaves_undecided_names_what_holds_the_joint(friction: float, cause: str) -> None:
    mechanism = hinge()
    mechanism = replace(mechanism, joints=(replace(mechanism.joints[0], friction=friction),))
    rest = Critical(0.5, 0, "rest", True, 1e-20)
    errors = {"error": np.zeros(2), "position_error": np.zeros(2)}
    with pytest.raises(OutOfReach, match=r"whether the joint pin stays at rest at t = 0\.5 s") as refused:
        add_criticals(mechanism, np.array([0.0, 1.0]), [rest], np.full(2, 1e-16), 1.0, errors)
    assert refused.value.cause == cause


def test_a_proof_ends_at_the_limit_and_says_until_when() -> None:
    """The limit of a question reaches the proof, which then encloses the motion until an earlier instant."""
    pytest.importorskip("flint")
    pytest.importorskip("heyoka")
    case = load("sensor-pendulum")
    whole, short = (answer(Question(case, None, True, limit)) for limit in (1000.0, 1e-9))
    assert isinstance(whole, Certificate)
    assert isinstance(short, Certificate)
    assert whole.enclosure is not None
    assert short.enclosure is not None
    assert whole.enclosure.until is None
    assert short.enclosure.until is not None
    assert 0 < short.enclosure.until < case.duration
