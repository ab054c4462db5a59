"""Rows and changes of the study of releases, as tests make them."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from bodycheck.figures.revisions import REVISIONS
from bodycheck.studies.releases.page import present
from bodycheck.studies.releases.rows import Change, Found

HEADER = {
    "bodycheck": "0",
    "started": "2026-01-01T00:00:00+00:00",
    "command": ["bodycheck", "releases", "<b>"],
    "machine": {"processor": "abacus", "system": "wood"},
    "packages": {},
    "engines": {"mujoco": "1.0 to 3.0"},
    "missing": {},
    "environments": {},
    "demonstrations": {},
    "precisions": {},
    "defaults": {},
    "soft": {},
    "without_method": {},
    "robots": {},
    "departures": {},
    "versions": ["1.0", "2.0", "3.0"],
    "cases": {"spin": "0"},
    "unmeasured": {},
    "notices": [],
    "revisions": REVISIONS,
}


Row = dict[str, Any]


def row(version: str, error: float = 0.1, allowance: float = 1e-9, **others: Any) -> Row:
    known = {"case": "spin", "engine": "mujoco", "version": version, "integrator": "RK4", "timestep": 0.001, "status": "ok"}
    figures = {"attitude_error": error, "attitude_error_allowance": allowance, "truth_error": 1e-14}
    return {**known, "reason": "", **figures, **others}


def failed(version: str, status: str, reason: str = "why", **others: Any) -> Row:
    return {name: value for name, value in row(version, **others).items() if not name.startswith("attitude")} | {
        "status": status,
        "reason": reason,
    }


def change(**others: Any) -> Change:
    known = Change("mujoco", "spin", "RK4", "attitude_error", "1.0", "2.0", 2e-5, 3e-9, 6667.0, 2.0, 4.0, "", "", 0.001, 1e-10)
    return replace(known, **others)


def told(changes: Sequence[Change], rows: Sequence[Row] = (row("1.0", 2e-5), row("2.0", 3e-9))) -> list[str]:
    return [finding.text for finding in present({"": Found(HEADER, tuple(rows), tuple(changes))}).findings]
