"""Members of an ensemble that are judged together: their rows are those of runs that are judged alone, to the last bit."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import date

import numpy as np
import pytest

from bodycheck import Case, Truth, load
from bodycheck.adapters.contract import Method
from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.figures.columns import FIGURES
from bodycheck.figures.definition import Comparison
from bodycheck.judging import members
from bodycheck.judging.judgement import verdict
from bodycheck.judging.members import Columns, judged, one_by_one
from bodycheck.processes.failures import Crashed
from bodycheck.reference.flight.flights import Flights, flights
from bodycheck.reference.scenes import Scenes, vary
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import NoTruth
from bodycheck.results.outcome import Completed, Diverged, Outcome, Run
from bodycheck.running import simulation
from bodycheck.running.members.blocks import Flown, NormError, fly
from tests.support.cases import shortened
from tests.support.members import assert_same_row, rows_of, together, truths_alone

BASE = shortened(load("mujoco-free-body"), 0.5, 11)
METHODS = [Method.parse("Euler", 0.01), Method.parse("RK4", 0.01)]
TIMES = simulation.sampling_times(BASE.instants, 0.01)
TODAY = date(2030, 1, 1)
COUNT = 50


@dataclass(frozen=True)
class Drawn:
    """Members with their truths, alone and together."""

    scenes: Scenes
    cases: list[Case]
    truths: list[Truth]
    flights: Flights


@pytest.fixture(scope="module")
def drawn() -> Drawn:
    """Members of which some rest, some fall from rest, and some do not turn or do not fly."""
    random = np.random.default_rng(5)
    spin, velocity, gravity = random.normal(0, 4, (COUNT, 3)), random.normal(0, 3, (COUNT, 3)), random.uniform(0, 10, COUNT)
    spin[:6], velocity[3:9], gravity[5:12] = 0.0, 0.0, 0.0
    scenes = vary(
        BASE.scene,
        {
            "mass": random.uniform(0.1, 5, COUNT),
            "semi_axes": random.uniform(0.02, 0.5, (COUNT, 3)),
            "position": random.normal(0, 2, (COUNT, 3)),
            "quaternion": random.normal(0, 1, (COUNT, 4)),
            "velocity": velocity,
            "angular_velocity": spin,
            "gravity": gravity,
        },
    )
    cases = [replace(BASE, name=f"mujoco-free-body-{place}", scene=scenes.scene(place)) for place in range(COUNT)]
    truths = truths_alone(scenes, TIMES)
    return Drawn(scenes, cases, truths, together(truths))


@pytest.fixture(autouse=True)
def several_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer members are computed at once than there are."""
    monkeypatch.setattr(members, "AT_ONCE", 20)


def alone(drawn: Drawn, runs: Sequence[Run], expectations: Sequence[Expectation]) -> list[dict[str, object]]:
    """The rows of runs that are judged one by one."""
    judging = zip(drawn.cases, drawn.truths, runs, strict=True)
    return [
        verdict(replace(case, expectations=tuple(expectations)), exact, run, today=TODAY).row() for case, exact, run in judging
    ]


def assert_same(columns: Columns, rows: Sequence[dict[str, object]]) -> None:
    for place, row in enumerate(rows):
        assert_same_row(columns, place, row)


def test_every_series_of_many_members_is_that_of_each(drawn: Drawn) -> None:
    """Here the runs are the truths of other members, so that all errors are large."""

    @dataclass(frozen=True)
    class Exact:
        scene: Scenes
        trajectory: object
        bounds: object
        stop: None = None

    others = together([*drawn.truths[1:], drawn.truths[0]]).trajectory
    norms = np.linspace(0, 1e-7, COUNT)
    many = Comparison(Exact(drawn.scenes, drawn.flights.trajectory, drawn.flights.bounds), others, None, norms)  # type: ignore[arg-type]
    computed = {name: figure.compute(many) for name, figure in FIGURES.items()}
    assert sum(values is not None for values in computed.values()) >= 14
    for place, (exact, other) in enumerate(zip(drawn.truths, [*drawn.truths[1:], drawn.truths[0]], strict=True)):
        one = Comparison(exact, other.trajectory, None, float(norms[place]))
        for name, figure in FIGURES.items():
            value, values = figure.compute(one), computed[name]
            assert (value is None) == (values is None), name
            if values is not None:
                np.testing.assert_array_equal(values[place], value, err_msg=name)  # type: ignore[index]


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_the_rows_of_members_are_those_of_single_runs(drawn: Drawn, method: Method) -> None:
    runs = [simulation.run(case, "mujoco", method) for case in drawn.cases]
    flown = fly("mujoco", method, drawn.scenes, TIMES, [case.name for case in drawn.cases])
    assert not flown.ended
    columns = judged(drawn.scenes, drawn.flights, flown, method, (), TODAY)
    assert_same(columns, alone(drawn, runs, ()))
    assert set(columns["status"]) == {"ok"}
    assert {name for name, values in columns.items() if name in FIGURES and not np.isnan(values.astype(float)).all()} >= {
        *("position_error", "velocity_error", "attitude_error", "angular_velocity_error", "energy_drift"),
        *("rotational_energy_drift", "angular_momentum_drift", "truth_error", "truth_energy_error", "quaternion_norm_error"),
    }
    wrong = float(np.median(columns["attitude_error"].astype(float)))
    drift = float(np.median(columns["energy_drift"].astype(float)))

    def expected(*limits: Limit, **more: object) -> Expectation:
        return Expectation("mujoco", method, limits, **more)  # type: ignore[arg-type]

    half = expected(Limit("attitude_error", None, wrong), Limit("energy_drift", drift / 2, drift))
    for expectations in (
        [half],
        [half, expected(Limit("truth_energy_error", None, 1.0), Limit("quaternion_norm_error", None, 0.0))],
        [replace(half, known="a reference", until=date(2029, 1, 1), version="0.1")],
        [replace(half, known="a reference", until=date(2031, 1, 1))],
        [expected(Limit("order", 0.75, None), Limit("creep", None, 1.0))],
        [expected(status="diverged")],
        [half, replace(half, engine="another")],
        [replace(half, method=method.at(0.02))],
    ):
        columns = judged(drawn.scenes, drawn.flights, flown, method, expectations, TODAY)
        assert_same(columns, alone(drawn, runs, expectations))
        if expectations == [half]:
            assert 0 < (columns["passed"] == True).sum() < COUNT  # noqa: E712 - the column has objects


def test_truths_of_many_give_the_figures_that_truths_alone_give(drawn: Drawn) -> None:
    """Both are within their bounds of the exact motion, so that errors are within the bounds of each other."""
    flown = fly("mujoco", METHODS[0], drawn.scenes, TIMES)
    many = judged(drawn.scenes, flights(drawn.scenes, TIMES), flown, METHODS[0], (), TODAY)
    each = judged(drawn.scenes, drawn.flights, flown, METHODS[0], (), TODAY)
    for figure in FIGURES.values():
        if figure.bounded_by and not np.isnan(each[figure.name]).all():
            bound = 2 * (many[figure.bounded_by] + each[figure.bounded_by])  # twice, as drifts are of two instants
            assert (np.abs(many[figure.name] - each[figure.name]) <= bound).all(), figure.name
            assert (many[figure.name] > 1e3 * bound).any() or figure.name == "velocity_error", figure.name


def planted(drawn: Drawn) -> tuple[Array, dict[int, str]]:
    """The exact states of members, those of some with a fault, and the statuses that these faults lead to, by their places."""
    rows = rows_of(drawn.flights.trajectory)
    scenes, faults = drawn.scenes, {}
    for place in range(20, 30):
        assert drawn.scenes.velocity[place].all()
    rows[20, 5, 0], faults[20] = np.nan, "diverged"
    rows[21, 3, 8], faults[21] = np.inf, "diverged"
    rows[22, 4, 4], faults[22] = np.nan, "diverged"
    rows[23, 6, 7:10] *= 1e3
    faults[23] = "diverged"
    rows[24, :, 3:7] *= 1 + 2e-6
    faults[24] = "crashed"
    rows[25, :, 0] += 1.0
    faults[25] = "crashed"
    rows[26, 0, 10:] *= 1.1
    faults[26] = "crashed"
    rows[27], faults[27] = rows[27, 0], "diverged"
    rows[28, -1, 10:], faults[28] = 1e200, "diverged"
    # Within 1 % of the largest possible energy, from which on a run has diverged, and just beyond it.
    for place, part, status in ((29, 0.995, "ok"), (30, 1.005, "diverged")):
        moments = scenes.moments[place]
        speed = np.linalg.norm(scenes.velocity[place]) + scenes.gravity[place] * drawn.truths[place].trajectory.t[-1]
        momentum = np.linalg.norm(moments * scenes.angular_velocity[place])
        most = scenes.mass[place] * speed**2 / 2 + momentum**2 / (2 * moments.min())
        rows[place, 5, 10:] = 0.0
        rows[place, 5, 7:10] = (np.sqrt(2 * part * 100 * most / scenes.mass[place]), 0.0, 0.0)
        faults[place] = status
    # Beyond the tolerances of an attitude and of the start by little, and within them by little.
    for place, off, status in ((31, 0.995e-6, "ok"), (32, 1.005e-6, "crashed")):
        rows[place, 7, 3:7] *= 1 + off
        faults[place] = status
    for place, off, status in ((33, 0.995e-4, "ok"), (34, 1.005e-4, "crashed")):
        rows[place, 0, 0] += off * max(1.0, float(np.linalg.norm(scenes.position[place])))
        faults[place] = status
    return rows, faults


def outcome_alone(case: Case, rows: Array, norm_error: float) -> Outcome:
    """The outcome of a run that returned these rows."""
    try:
        return simulation.outcome_of(rows, NormError(norm_error), case.scene, METHODS[0], TIMES, 1.0)
    except simulation.AdapterFault as fault:
        return simulation.ended_by(fault, "mujoco 1.0", case.name)


@pytest.mark.parametrize("limit", [None, 1e-3])
def test_runs_that_fail_are_told_as_if_they_were_alone(drawn: Drawn, limit: float | None) -> None:
    rows, faults = planted(drawn)
    method, norm_error = METHODS[0], np.linspace(0, 1e-3, COUNT)
    ended: dict[int, Outcome] = {40: Diverged("it gave up", "gave up"), 41: Crashed("it broke")}
    names = tuple(case.name for case in drawn.cases)
    flown = Flown(
        "mujoco",
        "1.0",
        names,
        method,
        TIMES,
        np.full(len(rows), round(TIMES[-1] / method.timestep)),
        rows,
        norm_error,
        1.0,
        ended,
    )
    outcomes = [
        ended.get(place) or outcome_alone(case, rows[place], float(norm_error[place])) for place, case in enumerate(drawn.cases)
    ]
    runs = [
        Run(case.name, "mujoco", "1.0", method, outcome, scene=case.scene)
        for case, outcome in zip(drawn.cases, outcomes, strict=True)
    ]
    expectations = [] if limit is None else [Expectation("mujoco", method, (Limit("velocity_error", None, limit),))]
    columns = judged(drawn.scenes, drawn.flights, flown, method, expectations, TODAY)
    with np.errstate(all="ignore"):
        assert_same(columns, alone(drawn, runs, expectations))
        apart = one_by_one(
            [replace(case, expectations=tuple(expectations)) for case in drawn.cases], drawn.truths, flown, TODAY
        )
    for name, values in columns.items():
        np.testing.assert_array_equal(apart[name], values, err_msg=name)
    assert {place: columns["status"][place] for place in faults} == faults
    assert "of mujoco 1.0 is at fault in the case mujoco-free-body-24: its quaternion has the norm" in columns["reason"][24]
    assert np.isnan(columns["position_error"][20])
    assert not columns["passed"][23]
    assert columns["quaternion_norm_error"][45] == pytest.approx(norm_error[45], rel=1e-12)


def damaged(rows: Array, random: np.random.Generator) -> Array:
    """The states (n, 13) of a member with one of several kinds of damage, or none."""
    rows, place, column = rows.copy(), random.integers(len(rows)), random.integers(13)
    match random.integers(9):
        case 0:
            rows[place, column] = random.choice([np.nan, np.inf, -np.inf, 1e200, 1e308, -1e160])
        case 1:
            rows[place, 3:7] *= 1 + random.choice([-1, 1]) * 1e-6 * random.uniform(0.9, 1.1)
        case 2:
            rows[0, column] += 1e-4 * random.uniform(0.5, 2)
        case 3:
            rows[:] = rows[0]
        case 4:
            rows[place, 7:] *= random.uniform(5, 30)
        case 5:
            rows[-1] = rows[0]
        case 6:
            rows[:, 3:7] *= -1
        case 7:
            rows[:, 3:7] = 0
    return rows


@pytest.mark.parametrize(("name", "shape"), [("football-wobble", {"semi_axes": 3}), ("projectile", {"radius": 0})])
def test_any_damage_is_told_as_if_the_member_were_alone(name: str, shape: dict[str, int]) -> None:
    base, random = shortened(load(name), 0.4, 9), np.random.default_rng(9)
    sizes = {key: random.uniform(0.05, 0.5, (COUNT, width) if width else COUNT) for key, width in shape.items()}
    scenes = vary(base.scene, {**sizes, "velocity": random.normal(0, 3, (COUNT, 3))})
    method, times = METHODS[1], simulation.sampling_times(base.instants, 0.01)
    truths = truths_alone(scenes, times)
    whole = fly("mujoco", method, scenes, times)
    flown = replace(whole, states=np.array([damaged(rows, random) for rows in whole.states]))
    expectations = (Expectation("mujoco", method, (Limit("attitude_error", None, 1e-3), Limit("energy_drift", None, 1e-6))),)
    cases = [replace(base, scene=scenes.scene(place), expectations=expectations) for place in range(COUNT)]
    cases = [replace(case, name=called) for case, called in zip(cases, flown.names, strict=True)]
    columns = judged(scenes, together(truths), flown, method, expectations, TODAY)
    with np.errstate(all="ignore"):
        apart = one_by_one(cases, truths, flown, TODAY)
    assert set(columns["status"]) == {"ok", "diverged", "crashed"}
    for key, values in columns.items():
        np.testing.assert_array_equal(values, apart[key], err_msg=key)


def test_cases_are_judged_one_by_one(drawn: Drawn) -> None:
    """A case may slide, last longer than another one, or have no truth."""
    cases = [
        shortened(load("sliding-brick"), 0.2, 3),
        replace(drawn.cases[20], duration=0.3, samples=4),
        drawn.cases[21],
    ]
    method = Method.parse("Euler", 0.01)
    flown = fly("mujoco", method, cases, TIMES)
    runs = [simulation.run(case, "mujoco", method) for case in cases]
    truths: list[Truth | NoTruth] = []
    for run, case in zip(runs, cases, strict=True):
        assert isinstance(run.outcome, Completed)
        truths.append(truth(case.scene, run.outcome.trajectory.t, vouched=False))
    truths[2] = NoTruth("the reference: there is none")
    columns = one_by_one(cases, truths, flown, TODAY)
    for place, (case, exact, run) in enumerate(zip(cases, truths, runs, strict=True)):
        assert_same_row(columns, place, verdict(case, exact, run, today=TODAY).row())
    assert columns["status"].tolist() == ["ok", "ok", "unsupported"]
    assert not np.isnan(columns["penetration"][0])
    assert np.isnan(columns["penetration"][1])
