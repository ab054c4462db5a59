"""Small results folders and submissions as tests make them: with the writers of bodycheck, but without running an engine."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from bodycheck.casefile import case as case_files
from bodycheck.figures.columns import COLUMNS
from bodycheck.judging.judgement import COLUMNS as RUN_COLUMNS
from bodycheck.results import csv_tables, journal, origin, store
from bodycheck.site import catalogue
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.submissions import gathering
from bodycheck.site.submissions.submission import Row, Submission
from bodycheck.site.submissions.tables import TABLES
from bodycheck.studies.audit.rows import Row as AuditRow
from bodycheck.studies.contact.rows import ContactRow, PropertyRow, SettingRow
from bodycheck.studies.ensemble.rows import Row as EnsembleRow
from bodycheck.studies.orders import Order
from bodycheck.studies.parity.rows import ParityRow
from bodycheck.studies.releases.rows import Change

#: A shipped scene with a free body, one with a contact, and one with joints, which rows are about unless a test says otherwise.
FREE, CONTACT, MECHANISM = "intermediate-axis-flip", "sliding-brick", "double-pendulum"

MACHINE = {
    "system": "Linux-6.1.0-x86_64-with-glibc2.36",
    "processor": "Some(R) Processor, family 6 model 1 stepping 1, x86_64",
    "cores": "4",
    "python": "3.11.7",
}


def header(day: str = "2026-01-01", engines: Mapping[str, str] | None = None, **others: Any) -> dict[str, Any]:
    """The header of results that were started on a day; `others` replaces its entries."""
    known = engines or {"mujoco": "4.0.0"}
    told = {
        "bodycheck": "0.1.0",
        "command": ["/home/someone/.local/bin/bodycheck", "run", "--out", "/tmp/out"],
        "started": f"{day}T12:00:00+00:00",
        "machine": dict(MACHINE),
        "packages": {"numpy": "2.4.6"},
        "engines": dict(known),
        "missing": {},
        "environments": {},
        "demonstrations": {},
        "precisions": dict.fromkeys(known, "float64"),
        "defaults": {name: {"integrator": "Euler", "timestep": "0.002 s"} for name in known},
        "soft": {name: {"loops": "solref, solimp"} for name in known},
        "without_method": {name: {} for name in known},
    }
    return told | others


def run(case: str = FREE, engine: str = "mujoco", version: str = "4.0.0", integrator: str = "Euler", **values: Any) -> Row:
    """A row of results.csv: a completed run whose error is larger than the truth's own."""
    known = {"case": case, "engine": engine, "version": version, "integrator": integrator, "timestep": 0.002, "status": "ok"}
    figures = {
        "position_error": 0.25,
        "velocity_error": 0.5,
        "attitude_error": 2.125,
        "angular_velocity_error": 3.5,
        "energy_drift": 0.0625,
        "truth_error": 1e-10,
        "truth_position_error": 1e-12,
        "truth_velocity_error": 1e-12,
        "truth_angular_velocity_error": 1e-10,
        "truth_energy_error": 1e-14,
        "steps": 5000,
        "wall_time": 0.02,
        "time_per_step": 4e-6,
        "realtime_factor": 500.0,
        "kind": "turning",
        "tags": "free;flip",
    }
    return known | figures | values


def ended(status: str, reason: str = "mujoco 4.0.0 does not model rolling", **values: Any) -> Row:
    """A row of results.csv without figures: "unsupported", "diverged", "crashed" or "timeout"."""
    told = run(**values)
    return {name: told[name] for name in (*list(told)[:5], "kind", "tags")} | {"status": status, "reason": reason} | values


def exact(**values: Any) -> Row:
    """A row of results.csv whose errors are within the truth's own."""
    small: dict[str, Any] = dict.fromkeys(
        ("position_error", "velocity_error", "attitude_error", "angular_velocity_error"), 1e-13
    )
    return run(**{**small, "truth_position_error": 1e-12, "truth_velocity_error": 1e-12, "energy_drift": 1e-15} | values)


def broken(**values: Any) -> Row:
    """A row of results.csv that breaks an expectation of its case."""
    told: dict[str, Any] = {"passed": False, "reason": "attitude_error 2.12 rad, expected at most 0.1"}
    return run(**told | values)


def tradeoff(timestep: float, cost: float = 1e-3, **values: Any) -> Row:
    """A row of tradeoff.csv."""
    costs: dict[str, Any] = {
        "time_per_step": cost * timestep,
        "time_per_step_low": 0.9 * cost * timestep,
        "time_per_step_high": 1.2 * cost * timestep,
        "evaluations": 1,
        "cost": cost,
        "processor_time_per_step": cost * timestep,
        "setup_time": 0.01,
        "engine_share": 0.5,
        "device": "cpu",
        "precision": "float64",
    }
    return run(timestep=timestep, **costs | values)


def order(**values: Any) -> Row:
    """A row of orders.csv."""
    known = Order(FREE, "mujoco", "4.0.0", "Euler", "attitude", 1.01, 0.98, 1.04, None, "", None, 1, "", "", None)
    return asdict(known) | values


def attribution(**values: Any) -> Row:
    """A row of attribution.csv."""
    known = {"case": CONTACT, "engine": "mujoco", "version": "4.0.0", "integrator": "Euler", "timestep": 0.002}
    parts = {"quantity": "position", "total": 1e-3, "model_form": 4e-4, "constraint": 5e-4, "time_step": 1e-4}
    return known | parts | values


def release(version: str, **values: Any) -> Row:
    """A row of releases.csv."""
    return run(version=version, **{"attitude_error_allowance": 1e-9} | values)


def change(**values: Any) -> Row:
    """A row of changes.csv."""
    known = Change(
        *("mujoco", FREE, "RK4", "attitude_error", "3.17.0", "4.0.0", 2e-5, 3e-9, 6667.0, 2.0, 4.0, "", "", 0.001, 1e-10)
    )
    return asdict(known) | values


def contact(**values: Any) -> Row:
    """A row of contact.csv."""
    known = ContactRow(
        *("mujoco", "4.0.0", "Euler", 0.002, CONTACT, "defaults", "stop_time_error", 1e-3, "s", 0.407747, 1e-15, "ok")
    )
    return asdict(known) | values


def contact_setting(**values: Any) -> Row:
    """A row of contact_settings.csv."""
    known = SettingRow("mujoco", "4.0.0", "contact", "defaults", "Euler", 0.002, 1.0, 5, 39, "soft friction")
    return asdict(known) | values


def contact_property(**values: Any) -> Row:
    """A row of contact_properties.csv: a box that friction should hold creeps."""
    known = PropertyRow("mujoco", "4.0.0", "defaults", "Euler", 0.002, "creep", "", 5e-3, "m/s", 0.0, "")
    return asdict(known) | values


def parity(**values: Any) -> Row:
    """A row of parity.csv: equal masses."""
    known = ParityRow("panda", "mujoco", "4.0.0", "agrees", "mass", "link1", "2.74", "2.74", 0.0, 0.0, "")
    return asdict(known) | values


def audit(**values: Any) -> Row:
    """A row of audit.csv: something that an engine does besides mechanics."""
    known = AuditRow(
        *("mujoco", "4.0.0", "Euler", 0.002, "linear-damping", 1e-3, "1/s", "0", "deviates", "flight: speed of a body", 2.1)
    )
    return asdict(known) | values


def ensemble(**values: Any) -> Row:
    """A row of ensemble.csv."""
    known = EnsembleRow(
        *("ensemble-of-bricks", "mujoco", "4.0.0", "Euler", 0.002, 1000, 0.01, 0.005, 0.018),
        *("attitude_error", 1e-3, 1e-2, 0.1, 0.5, 1.5, 17),
    )
    return asdict(known) | values


#: Rows of every table that the site knows.
ROWS: dict[str, list[Row]] = {
    "results.csv": [
        run(),
        ended("unsupported", integrator="implicit"),
        ended("diverged", "not a number at 3 s", case=CONTACT),
        exact(case=MECHANISM),
        broken(integrator="RK4"),
    ],
    "attribution.csv": [attribution()],
    "tradeoff.csv": [tradeoff(0.01), tradeoff(0.005)],
    "orders.csv": [order()],
    "releases.csv": [release("3.17.0"), release("4.0.0")],
    "changes.csv": [change()],
    "contact.csv": [contact()],
    "contact_settings.csv": [contact_setting()],
    "contact_properties.csv": [contact_property()],
    "parity.csv": [parity()],
    "audit.csv": [audit()],
    "ensemble.csv": [ensemble()],
}


def write_folder(
    folder: Path,
    tables: Mapping[str, Iterable[Row]],
    told: Mapping[str, Any] | None = None,
    cases: Mapping[str, str] | None = None,
) -> Path:
    """Write a results folder, and return it.

    tables: the rows by the name of the file, such as "results.csv". told: the header; `header` makes one. cases: the texts of
    cases that do not come with bodycheck, by name.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rows = {name: list(table) for name, table in tables.items()}
    versions = {row["engine"]: row["version"] for table in rows.values() for row in table if row.get("version")}
    told = told or header(engines=versions or None)
    named = {str(row.get("case") or row.get("scene")) for table in rows.values() for row in table}
    texts = {name: case_files.load(name).text for name in sorted(named) if case_files.is_shipped(name)} | dict(cases or {})
    stored: Any = {**told, "cases": [{"name": name, "text": text} for name, text in texts.items()]}
    for name, table in rows.items():
        as_mappings = replace(TABLES[name], row=None)
        csv_tables.write(folder, as_mappings, table, [origin.stored(stored)], _columns(name, table))
    with journal.begin(folder / store.RECORDS, {"format": store.FORMAT, **stored}):
        pass
    return folder


def submission(
    tables: Mapping[str, Iterable[Row]] | Sequence[Row], cases: Mapping[str, str] | None = None, **told: Any
) -> Submission:
    """Return a submission, read as the site reads it.

    tables: the rows by the name of the file, or those of results.csv. told: entries of the header, and `day`.
    """
    by_name: Mapping[str, Iterable[Row]] = tables if isinstance(tables, Mapping) else {"results.csv": tables}
    rows = {name: list(table) for name, table in by_name.items()}
    versions = {row["engine"]: row["version"] for table in rows.values() for row in table if row.get("version")}
    with TemporaryDirectory() as folder:
        write_folder(Path(folder), rows, header(**{"engines": versions or None} | told), cases)
        return gathering.read(Path(folder))


def catalogued(*submissions: Submission) -> Catalogue:
    """Return the catalogue of submissions, the oldest first."""
    in_order = sorted(submissions, key=lambda one: (one.header.started, one.key))
    return catalogue.catalogued(in_order, ())


def _columns(name: str, rows: Sequence[Row]) -> list[str]:
    """The columns of a table in the order in which bodycheck writes them."""
    there = {column for row in rows for column in row}
    if name in ("results.csv", "tradeoff.csv", "releases.csv"):
        there |= set(RUN_COLUMNS)
    ordered = [*COLUMNS, *(column for column in TABLES[name].by_name if column not in COLUMNS)]
    return [column for column in ordered if column in there] if there & {"status", "passed"} else list(rows[0])
