"""The commands `bodycheck engines`, `engines add`, `engines remove` and `engines check`.

The imports are inside the functions, so that `--help` answers at once.
"""

import sys
from typing import TYPE_CHECKING, Any

from cyclopts import App

from bodycheck.console.options import AS_USUAL, Again, Json, Viewed
from bodycheck.errors import FAILED, OK, BadInput

if TYPE_CHECKING:
    from collections.abc import Iterable


engines = App(name="engines", help="List the engines, install them apart, and check their adapters.")


@engines.default
def listed(*, again: Again = False, json: Json = False, view: Viewed = AS_USUAL) -> int:
    """List all engines that have an adapter: where each is installed, or the command that installs it.

    An engine is installed beside bodycheck, or in an environment of its own, whose day is given. `NAME@VERSION` names one of
    several releases. The columns `default` and `recommended` have the methods behind these aliases of --integrator, and `pages`
    has the addresses of the documentation that shows them. A line on stderr says what the cache keeps. With --again, every
    engine is asked again what it is.
    """
    from dataclasses import asdict

    from bodycheck.adapters import offers, roles
    from bodycheck.console import tables, terminal
    from bodycheck.running import engines as installed

    tables.check(view, terminal.ENGINES)
    names = _all_names()
    if again:
        installed.forget(names)
    records, missing = installed.describe(names)
    places = {name: installed.place(name) for name in records}
    _say_what_is_kept()
    if json:
        there: list[dict[str, Any]] = [
            {
                "name": name,
                "version": record.version,
                "place": places[name][0],
                "since": places[name][1],
                "integrators": offers.listed(record),
                "roles": {
                    role: {kind: asdict(usage) for kind, usage in usages.items()} for role, usages in record.roles.items()
                },
                "largest_step": record.largest_step,
            }
            for name, record in records.items()
        ]
        terminal.print_json(there + [{"name": name, "missing": fault.reason} for name, fault in missing.items()])
        return OK
    rows = [
        (
            *(name, record.version, " of ".join(filter(None, places[name])), ", ".join(offers.listed(record))),
            *(roles.in_words(record, role) or "-" for role in roles.ALIASES),
            " ".join(roles.pages(record)),
        )
        for name, record in records.items()
    ]
    rows += [(name, "-", "-", fault.reason, "", "", "") for name, fault in missing.items()]
    tables.show(terminal.ENGINES, rows, view)
    return OK


@engines.command
def add(*names: str, json: Json = False) -> int:
    """Install engines, each in an environment of its own, and check their adapters there.

    An environment holds the engine and the packages that it needs, and uses bodycheck from here. Without a version, it is the
    newest release. The exit code is 1 if an engine cannot be installed, or if its adapter fails a check.

    Parameters
    ----------
    names
        The names of engines, each `NAME` or `NAME@VERSION`.
    """
    import time

    from bodycheck.adapters.engine_name import EngineName
    from bodycheck.console import terminal
    from bodycheck.environments import environments

    if not names:
        raise BadInput("engines add: name at least one engine")
    asked = [EngineName.parse(name) for name in names]
    _refuse_unknown(asked)
    rows: list[dict[str, Any]] = []
    for one in asked:
        with terminal.progress(f"installing {one}", 1) as progress:
            start = time.monotonic()
            try:
                added = environments.obtain(one.adapter, one.version or environments.newest(one.adapter))
            except environments.Unobtainable as error:
                rows.append({"name": str(one), "failure": str(error)})
                continue
            seconds = time.monotonic() - start
            progress(str(one))
        row = {
            "name": f"{added.engine}@{added.version}",
            "seconds": seconds,
            "bytes": environments.size(added),
        }
        rows.append({**row, "packages": environments.lock(added), **_checked(f"{added.engine}@{added.version}")})
    if json:
        terminal.print_json(rows)
    else:
        _print_added(rows)
    return FAILED if any("failure" in row or row["faults"] for row in rows) else OK


@engines.command
def remove(*names: str, json: Json = False) -> int:
    """Delete the environments of engines.

    Parameters
    ----------
    names
        `NAME` for all environments of an engine, `NAME@VERSION` for one.
    """
    from bodycheck.adapters.engine_name import EngineName
    from bodycheck.console import terminal
    from bodycheck.environments import environments

    if not names:
        raise BadInput("engines remove: name at least one engine")
    asked = [EngineName.parse(name) for name in names]
    _refuse_unknown(asked)
    removed = []
    for one in asked:
        versions = environments.cached(one.adapter) if one.version is None else (one.version,)
        removed += [f"{one.adapter}@{version}" for version in environments.remove(one.adapter, versions)]
    if json:
        terminal.print_json({"removed": removed})
    else:
        print(f"removed: {', '.join(removed)}" if removed else "there was no such environment")
    return OK


@engines.command
def check(*names: str, json: Json = False) -> int:
    """Test the adapters of engines, by default of all that are installed, with scenes whose solution is obvious.

    The exit code is 1 if a test fails, or if an engine cannot be imported.

    Parameters
    ----------
    names
        The names of engines, each `NAME` or `NAME@VERSION`.
    """
    from bodycheck.console import terminal
    from bodycheck.console.arguments import load_engines
    from bodycheck.running import smoke

    loaded = load_engines(names, dict.fromkeys(_all_names(), True))
    faults = smoke.check_all(tuple(loaded.records))
    if json:
        terminal.print_json([{"name": name, "faults": reasons} for name, reasons in faults.items()])
    else:
        for name, reasons in faults.items():
            print("\n".join(reasons) if reasons else f"{name}: adapter check passed")
    return FAILED if any(faults.values()) or loaded.missing else OK


def _say_what_is_kept() -> None:
    """Say on stderr what the cache keeps, since when, and how it is made anew."""
    from bodycheck.environments import user_cache
    from bodycheck.running.engines import RECORDS
    from bodycheck.studies.releases.questions import MEASUREMENTS

    kinds = (
        (RECORDS, "records of engines", "engines --again"),
        (MEASUREMENTS, "measurements of releases", "releases ENGINE --again"),
    )
    kept = [
        f"{kind}: {len(times)} since {times[0]:%Y-%m-%d} (anew by: bodycheck {command})"
        for subfolder, kind, command in kinds
        if (times := user_cache.times(subfolder))
    ]
    if kept:
        print(f"kept in {user_cache.folder()}: {', '.join(kept)}", file=sys.stderr)


def _all_names() -> tuple[str, ...]:
    """Return the names of all engines that have an adapter, and of all releases that have an environment."""
    from bodycheck.adapters import registry
    from bodycheck.environments import environments

    all_names: list[str] = []
    for name in registry.names():
        all_names.append(name)
        if registry.known_installation(name) is not None:
            all_names += [f"{name}@{version}" for version in environments.cached(name)]
    return tuple(all_names)


def _refuse_unknown(asked: "Iterable[Any]") -> None:
    """Raise `BadInput` for an engine that has no adapter, or does not say what it is installed from."""
    from bodycheck.adapters import registry
    from bodycheck.console.arguments import check_engine

    for one in asked:
        check_engine(one.adapter)
        try:
            registry.installation(one.adapter)
        except registry.EngineMissing as error:
            raise BadInput(str(error)) from error


def _checked(name: str) -> dict[str, Any]:
    """Return the methods of an engine and the faults of its adapter."""
    from bodycheck.adapters import offers
    from bodycheck.running import engines as installed
    from bodycheck.running import smoke

    records, missing = installed.describe([name])
    if name in missing:
        return {"integrators": [], "faults": [missing[name].reason]}
    return {"integrators": list(offers.listed(records[name])), "faults": smoke.check_all([name])[name]}


def _print_added(rows: "list[dict[str, Any]]") -> None:
    from bodycheck.console.tables import print_table

    added = [row for row in rows if "failure" not in row]
    if added:
        print_table(
            ("engine", "MB", "seconds", "packages", "methods", "adapter"),
            [
                (
                    *(row["name"], f"{row['bytes'] / 1e6:.0f}", f"{row['seconds']:.1f}", str(len(row["packages"]))),
                    *(str(len(row["integrators"])), "checked" if not row["faults"] else "fails"),
                )
                for row in added
            ],
        )
    for row in rows:
        for fault in [row["failure"]] if "failure" in row else row["faults"]:
            print(fault)
