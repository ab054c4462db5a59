"""Rows and orders of the tradeoff study, as tests make them."""

import re
from typing import Any

import vl_convert

from bodycheck.judging import judgement
from bodycheck.reports.charts import Spec
from bodycheck.reports.study import StudyReport
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff.measurements import CaseMeasurements
from bodycheck.studies.tradeoff.page import present
from tests.support.pages import HOSTILE, HOSTILE_NAME

HEADER = {
    "bodycheck": "0",
    "started": "2026-01-01T00:00:00+00:00",
    "command": ["bodycheck", "tradeoff", "<b>"],
    "machine": {"processor": "abacus"},
    "packages": {},
    "engines": {"mujoco": "4", "pinocchio": "4"},
    "missing": {},
    "environments": {},
    "demonstrations": {},
    "precisions": {},
    "defaults": {},
    "soft": {},
    "without_method": {},
    "robots": {},
    "departures": {},
}


Row = dict[str, Any]


def measurements(rows: list[Row], orders: list[Order] | None = None) -> CaseMeasurements:
    name = rows[0]["case"]
    return CaseMeasurements(name, tuple(rows), tuple(order for order in orders or () if order.case == name))


def row(**values: Any) -> Row:
    """A completed run; its costs follow from `cost`."""
    defaults = dict.fromkeys(judgement.COLUMNS) | {
        "case": "spin",
        "engine": "mujoco",
        "version": "4",
        "integrator": "Euler",
        "timestep": 0.01,
        "status": "ok",
        "reason": "",
        "attitude_error": 1e-2,
        "position_error": 1e-2,
        "energy_drift": 1e-3,
        "angular_momentum_drift": 1e-4,
        "truth_error": 1e-14,
        "evaluations": 1,
        "cost": 1e-3,
    }
    made = defaults | values
    cost = made["cost"]
    steps = dict.fromkeys(("time_per_step_low", "time_per_step_high"))
    if cost is not None:
        steps = {name: share * cost * made["timestep"] for name, share in zip(steps, (0.9, 1.2), strict=True)}
    return steps | made


def failed(**values: Any) -> Row:
    figures = ("attitude_error", "position_error", "energy_drift", "angular_momentum_drift", "truth_error", "cost")
    return row(**{"status": "diverged", "reason": "not a number"} | dict.fromkeys(figures) | values)


def order(**values: Any) -> Order:
    defaults = {
        "case": "spin",
        "engine": "mujoco",
        "version": "4",
        "integrator": "Euler",
        "quantity": "attitude",
        "order": 1.0,
        "order_low": 0.98,
        "order_high": 1.02,
        "floor": None,
        "floor_cause": "",
        "horizon": None,
        "claimed": 1,
        "scheme": "",
        "nearest_scheme": "",
        "scheme_residual": None,
    }
    return Order(**defaults | values)


def curve(integrator: str, errors: list[float], costs: list[float], **values: Any) -> list[Row]:
    """A method through as many time steps, from 10 ms each a half of the one before."""
    return [
        row(integrator=integrator, timestep=0.01 / 2**place, attitude_error=error, cost=cost, **values)
        for place, (error, cost) in enumerate(zip(errors, costs, strict=True))
    ]


def texts(report: StudyReport, subject: str) -> list[str]:
    return [finding.text for finding in report.findings if finding.subject == subject]


def drawn(specification: Spec) -> tuple[int, int, int]:
    """How many curves, rings and points a diagram has."""
    svg = vl_convert.vegalite_to_svg(specification)
    assert "NaN" not in svg
    assert "undefined" not in svg
    symbols = re.findall(r'<g class="mark-symbol role-mark [^"]*"[^>]*>(.*?)</g>', svg)
    rings, points = (group.count("<path") for group in symbols)
    lines = "".join(re.findall(r'<g class="mark-line role-mark [^"]*"[^>]*>(.*?)</g>', svg))
    front = len(re.findall(r'<path [^>]*stroke="currentColor"', lines))  # the front's own line, which has the ink of the text
    return lines.count("<path") - front, rings, points


def hostile_report() -> StudyReport:
    """The report of a study all of whose strings try to be markup."""
    rows = [
        *curve(HOSTILE_NAME, [1e-1, 1e-2], [1e-3, 1e-2]),
        failed(engine="</script><script>alert(2)</script>", status=HOSTILE, reason="</dl>"),
        failed(status="unsupported", reason=HOSTILE),
    ]
    orders = [
        order(integrator=HOSTILE_NAME, scheme=HOSTILE, nearest_scheme=HOSTILE, scheme_residual=1e-3, claimed=4, floor=1e-2)
    ]
    return present(HEADER | {"missing": {"drake": HOSTILE}}, rows, orders)
