"""Reports of studies made of rows of a test's choosing, which have every kind of finding of the study."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.casefile.case import Case, parse
from bodycheck.reports.study import StudyReport
from bodycheck.studies.ablation import page as ablation
from bodycheck.studies.ablation.rows import Change as Effect
from bodycheck.studies.ablation.rows import ModelRow
from bodycheck.studies.audit import page as audit
from bodycheck.studies.audit.rows import PROPERTIES, Classes, ClassRow, Facts, Fault, Row, Unclassed
from bodycheck.studies.contact import page as contact
from bodycheck.studies.contact.property import Name
from bodycheck.studies.contact.rows import ContactRow, PropertyRow, Setting, SettingRow, Sheet
from bodycheck.studies.ensemble.findings.analysis import analyse
from bodycheck.studies.ensemble.report import page as ensemble
from bodycheck.studies.extremes import page as extremes
from bodycheck.studies.extremes.rows import Limit
from bodycheck.studies.extremes.rows import Row as Extreme
from bodycheck.studies.recommend import page as recommend
from bodycheck.studies.recommend.rows import Answer, Asked, Probe, Recommendation
from bodycheck.studies.releases import page as releases
from bodycheck.studies.releases.rows import Found
from bodycheck.studies.tradeoff import page as tradeoff
from tests.support import ensembles, release_rows, tradeoff_rows
from tests.support.saved_results import SLIDE, SPIN
from tests.support.tradeoff_rows import HEADER, curve, order

EULER = "semi-implicit Euler"

#: What the row of a model does not have that crashed.
UNMEASURED: dict[str, Any] = {
    **dict.fromkeys(("time_per_step", "relative_cost", "relative_cost_low", "relative_cost_high")),
    "changes": {},
    "errors": {},
}


def cases() -> dict[str, Case]:
    """The cases of `saved_results`, by name."""
    return {"spin": parse(SPIN, "spin.case.toml"), "slide": parse(SLIDE, "slide.case.toml")}


def tradeoff_page() -> StudyReport:
    """Two cases: an order that falls short, schemes, floors, a lost attitude, the cheapest, and runs without results."""
    rows: list[tradeoff_rows.Row] = []
    orders = []
    for case in ("spin", "tumble"):
        rows += curve("Euler", [1e-1, 5e-2], [1e-4, 2e-4], case=case)
        rows += curve("Tsit5", [1e-4, 1e-7], [4e-4, 5e-3], case=case)
        rows += curve("RK4", [1e-1, 2.7e-4], [1e-3, 1e-2], case=case)
        orders.append(order(case=case, scheme=EULER, nearest_scheme=EULER, scheme_residual=2e-13))
        orders.append(order(case=case, integrator="Tsit5", order=2.0, order_low=1.9, order_high=2.1, claimed=4))
        orders.append(order(case=case, integrator="RK4", floor=2.7e-4, floor_cause="limit", claimed=1))
    rows += curve("midpoint", [3.1, 2.9], [1e-3, 1e-2])
    rows += curve("implicit", [1e-1, 1e-2], [1e-3, 1e-2])
    orders.append(order(integrator="midpoint", horizon=2.5))
    orders.append(order(integrator="implicit", nearest_scheme=EULER, scheme_residual=1e-4, floor=1e-2, floor_cause="rounding"))
    rows.append(tradeoff_rows.failed(integrator="Adams"))
    rows.append(tradeoff_rows.failed(engine="drake", status="unsupported", reason="it does not model drag"))
    return tradeoff.present(HEADER | {"missing": {"dart": "dart is not installed"}}, rows, orders)


def tradeoff_of_nothing() -> StudyReport:
    """Orders as claimed, and no method that is accurate."""
    rows = curve("Euler", [1e-1, 1e-2], [1e-3, 1e-2])
    return tradeoff.present(HEADER, rows, [order(), order(quantity="position")])


def releases_of_nothing() -> StudyReport:
    """Releases that agree."""
    rows = (release_rows.row("1.0"), release_rows.row("2.0"))
    return releases.present({"": Found(release_rows.HEADER, rows, ())})


def recommend_page(reached: bool = True) -> StudyReport:
    """A cheapest method, a second one that is not monotone, one that never gets there, and one without a result.

    The timings of the first two overlap. reached: whether any method keeps the limit.
    """

    def answer(integrator: str, timestep: float | None, error: float | None, cost: float | None, **more: Any) -> Answer:
        keeps = error is not None and error <= 1e-4
        known = {
            "margin": None if error is None else 1e-4 / error / (1.1 if keeps else 1.0),
            "worst": 1.1 * error if error is not None and keeps else None,
            "cost_low": None if cost is None else 0.9 * cost,
            "cost_high": None if cost is None else 1.2 * cost,
            "smallest": 0.0006,
            "broken": None if timestep is None or not keeps else 2 * timestep,
            "reason": "",
            "monotone": None if error is None else integrator != "Tsit5",
        }
        return Answer("mujoco", "4", integrator, timestep, error, cost, reached=keeps, steps=2, **(known | more))

    best = [answer("RK4", 0.002, 4e-5, 1e-3), answer("Tsit5", 0.004, 8e-5, 1.1e-3)] if reached else []
    answers = (
        *best,
        answer("Euler", 0.0006, 0.25, None),
        answer("Adams", None, None, None, smallest=None, reason="kinetic energy 1e+07 times the most possible"),
    )
    lost = Probe("mujoco", "4", "Adams", 0.002, "diverged", None, None, "kinetic energy 1e+07 times the most possible")
    probes = [
        Probe("mujoco", "4", own.integrator, step, "ok", error, 1e-14, "")
        for own in answers
        if own.timestep is not None and own.error is not None
        for step, error in ((2 * own.timestep, 4 * own.error), (own.timestep, own.error))
    ]
    if reached:
        probes.insert(2, Probe("mujoco", "4", "Tsit5", 0.02, "ok", 2e-6, 1e-14, ""))
    asked = Asked("spin", 60.0, "attitude_error", 1e-4)
    return recommend.present(HEADER, Recommendation(asked, answers, (*probes, lost)))


def extremes_page() -> StudyReport:
    """Errors that are reported and errors that are not, a reset, a long run that fails, processes that died, and limits."""

    def row(integrator: str, axis: str, value: float, status: str, said: str = "healthy", detail: str = "") -> Extreme:
        return Extreme(
            "spin", "mujoco", "4", integrator, value if axis == "timestep" else 0.002, axis, value, status, said, detail
        )

    lost = "the angular momentum is gone by t = 0.292 s; before, energy of rotation 3.08e+09 times the initial one"
    rows = [
        row("Euler", "spin", 1.0, "ok"),
        row("Euler", "spin", 100.0, "energy-gain", detail="energy of rotation 48.3 times the initial one"),
        row("Euler", "spin", 300.0, "reset", "MuJoCo reset itself after BADQACC at t = 0.29 s", lost),
        row("RK4", "spin", 1.0, "ok"),
        row("RK4", "spin", 100.0, "inaccurate", detail="attitude off by 1.5 rad, centre of mass by 0 m"),
        row("RK4", "spin", 300.0, "crashed", "nothing", "its process exited with code 7"),
        row("Euler", "steps", 1000.0, "ok"),
        row("Euler", "steps", 1.2e5, "diverged", detail="not a number at t = 9 s"),
        row("RK4", "steps", 1000.0, "ok"),
        row("RK4", "steps", 1.2e5, "timeout", "nothing", "stopped after 60 s"),
    ]
    refused = [
        row("implicit", "spin", spin, "unsupported", "nothing", "it does not model drag") for spin in (1.0, 100.0, 300.0)
    ]
    rows += [replace(own, engine="drake") for own in refused]
    limits = [
        Limit("spin", "mujoco", "4", "Euler", 1.0, 0.005, 0.005, 0.006),
        Limit("spin", "mujoco", "4", "RK4", 1.0, 3.2, 3.2, 3.3),
        Limit("spin", "mujoco", "4", "Euler", 100.0, None, None, 1e-5),
        Limit("spin", "mujoco", "4", "RK4", 100.0, 0.02, 2.0, 0.03),
    ]
    return extremes.present(HEADER, rows, limits)


def ablation_page() -> StudyReport:
    """A model that changes nothing, one within the time-step errors, one of other physics, and one that crashes."""

    def row(model: str, adds: str, cost: float, position: float, attitude: float) -> ModelRow:
        changes = {"position": Effect(position, 1e-12, 1e-3), "attitude": Effect(attitude, 1e-12, 1e-3)}
        figures = {"position_error": 1e-4 + position, "attitude_error": 1e-4 + attitude}
        costs = (1e-6 * cost, cost, 0.9 * cost, 1.2 * cost)
        return ModelRow("slide", "mujoco", "4", "Euler", 0.002, model, adds, "ok", "", *costs, changes, figures)

    rows = [
        row("planar", "three joints in the plane", 1.0, 0.0, 0.0),
        row("free", "one free joint", 1.5, 1e-13, 0.0),
        row("contact", "contact with friction", 12.5, 2.5, 0.25),
        row("sensors", "sensors", 14.0, 5e-4, 0.0),
        replace(row("everything", "all that there is", 0, 0, 0), status="crashed", reason="out of memory", **UNMEASURED),
    ]
    return ablation.present(HEADER, cases(), rows)


def releases_page() -> StudyReport:
    """Changes of order, scheme, figure and status between releases, one release that could not be measured, and a notice."""
    row, change = release_rows.row, release_rows.change
    status = change(quantity="status", before="unsupported", after="ok", factor=None, order_before=None, order_after=None)
    same = {"before": 0.683, "after": 0.659, "order_before": 1.02, "order_after": 0.98, "factor": 1.04}
    changes = (
        change(),
        change(case="top", factor=2.0),
        change(integrator="implicit"),
        change(integrator="Euler", **same),
        change(integrator="discrete", scheme_before=EULER, scheme_after="linearly implicit Euler", **same),
        replace(status, integrator="Tsit5"),
        change(integrator="RK4", from_version="2.0", to_version="3.0", before=3e-9, after=4e-9, order_before=4.0, factor=1.3),
    )
    rows = (row("1.0", 2e-5), row("2.0", 3e-9), release_rows.failed("3.0", "crashed", "its process died of signal SIGSEGV"))
    header = release_rows.HEADER | {"unmeasured": {"2.5": "no wheel"}, "notices": ["the index has no release 4.0"]}
    return releases.present({"": Found(header, rows, changes)})


def audit_page() -> StudyReport:
    """Two engines with defaults and deviations, a probe that gave no answer, and methods that are one algorithm."""

    def row(
        engine: str, integrator: str, name: str, status: str, probe: str, value: float | None = None, unit: str = ""
    ) -> Row:
        error = 0.25 if status in ("default", "deviates") else None
        return Row(engine, "1.0", integrator, 0.002, name, value, unit, "0", status, probe, error)  # type: ignore[arg-type]

    form = "representation: two welded links: differs, and"
    rows = [
        row("toy", "euler", "energy-per-turn", "deviates", "energy", 0.0035),
        row("toy", "heun", "energy-per-turn", "deviates", "energy", -2e-5),
        row("toy", "euler", "representation", "deviates", f"{form} vanishes with the time step with order 1.0", 2e-3, "m"),
        row("toy", "heun", "representation", "deviates", f"{form} does not vanish with the time step", 1e-3, "m"),
        row("toy", "euler", "sleeping", "none", "sleeping"),
        row("toy", "heun", "sleeping", "not-probed", "sleeping: the body does not come to rest"),
        row("toy", "euler", "angular-damping", "default", "damping", 0.0499, "1/s"),
        row("block", "step", "single-precision", "default", "precision"),
        row("block", "step", "nondeterminism", "not-probed", "gave no answer: its process exited with code 7"),
    ]
    facts = {"toy": Facts("float64", {"angular-damping": "0.05 1/s"}), "block": Facts("float32")}
    faults = [Fault("block", "step", "nondeterminism", "its process exited with code 7")]
    classes = Classes(
        (
            ClassRow("flight", EULER, EULER, "toy", "1.0", "euler", 2e-15, 0.002),
            ClassRow("flight", EULER, EULER, "block", "1.0", "step", 2e-15, 0.002),
            ClassRow("flight", "not identified 1", "", "toy", "1.0", "heun", 0.0, 0.002),
        ),
        (Unclassed("drag", "block", "step", "block 1.0 does not model drag"),),
    )
    told = {(own.engine, own.integrator, own.property) for own in rows}
    for engine, integrator in (("toy", "euler"), ("toy", "heun"), ("block", "step")):
        rows += [row(engine, integrator, name, "none", name) for name in PROPERTIES if (engine, integrator, name) not in told]
    return audit.present(HEADER | {"missing": {"dart": "dart is not installed"}}, facts, rows, faults, classes)


def contact_page() -> StudyReport:
    """Two scenes in two engines, one of which creeps and gains energy, and the other does not complete a scene."""
    methods: tuple[tuple[Setting, str, float], ...] = (("defaults", "Euler", 0.002), ("best", "RK4", 0.0005))

    def rows(scene: str, figure: str, unit: str, truth: float, *values: float) -> list[ContactRow]:
        return [
            ContactRow("mujoco", "4", method, step, scene, setting, figure, value, unit, truth, 1e-14, "ok")
            for (setting, method, step), value in zip(methods, values, strict=True)
        ]

    made = [
        *rows("slide", "creep", "m/s", 0.0, 1e-3, 1e-5),
        *rows("slide", "energy_gain", "", 0.0, 0.02, 1e-6),
        *rows("slide", "stop_time_error", "s", 0.102, 0.019, 0.0009),
        *rows("spin", "creep", "m/s", 0.0, 1e-4, 1e-6),
        ContactRow("drake", "1", "discrete", 0.001, "slide", "defaults", "", None, "", None, None, "unsupported"),
    ]
    settings = [
        SettingRow("mujoco", "4", "plane", setting, method, step, error, 2, 30, "soft friction")
        for (setting, method, step), error in zip(methods, (1.0, 0.2), strict=True)
    ]
    measured: tuple[tuple[Name, str, float | None, str], ...] = (
        ("restitution", "1 m/s", 0.13, ""),
        ("bounce-threshold", "", None, "m/s"),
        ("depth-at-rest", "1 kg", 1e-4, "m"),
        ("depth-at-rest", "100 kg", 1e-2, "m"),
        ("creep", "", 0.005, "m/s"),
    )
    properties = [
        PropertyRow("mujoco", "4", setting, method, step, name, condition, value, unit, 0.0, "")
        for setting, method, step in methods
        for name, condition, value, unit in measured
    ]
    return contact.present(
        HEADER, cases(), Sheet(made, settings, properties), {("drake", "slide"): "it has no area law of friction"}
    )


def ensemble_page(folder: Path) -> StudyReport:
    """An ensemble of 400 members with two methods, one of which fails in two ways. folder: where it is written."""
    random = np.random.default_rng(7)
    drawn = {"body.mass": random.uniform(1, 2, 400), "initial.angular_velocity.0": random.uniform(-3, 3, 400)}
    size = drawn["initial.angular_velocity.0"] ** 2

    def columns(ended: np.ndarray, factor: float) -> dict[str, Any]:
        figures = {name: np.where(ended == "ok", factor * size, np.nan) for name in ("attitude_error", "position_error")}
        reason = np.where(ended == "ok", "", np.where(ended == "crashed", "its process exited with code 7", "not a number"))
        return {"status": ended.tolist(), "reason": reason.tolist(), **figures}

    ended = np.full(400, "ok", dtype=object)
    steady = columns(ended, 1e-8)
    ended[[3, 17, 90]], ended[200] = "diverged", "crashed"
    analysis = analyse(ensembles.made(folder, drawn, {ensembles.EULER: columns(ended, 1e-4), ensembles.RK4: steady}))
    file = ensemble.File(17, "spin-17.case.toml", "mujoco 4 with Euler at 0.002 s: the run has the status diverged")
    return ensemble.present(ensemble.Material(HEADER, "turning", analysis, files=(file,)))
