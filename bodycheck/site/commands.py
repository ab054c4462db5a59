"""The commands that reproduce the rows of tables."""

import shlex
from collections.abc import Callable, Sequence
from functools import cache

from packaging.version import InvalidVersion, Version

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.casefile.case import is_shipped
from bodycheck.casefile.finding import SUFFIX as CASE_END
from bodycheck.results.outcome import RECORDED
from bodycheck.site.submissions.submission import Row, Submission


def command(source: Submission, table: str, row: Row) -> str:
    """Return the command that reproduces the numbers of a row, quoted for a shell.

    A case that does not come with bodycheck is given by the name of its case file, which the page of the row shows.

    Parameters
    ----------
    source
        The submission that contains the row.
    table
        The file name of the table.
    row
        The values of the row by column.
    """
    words = MAKERS[table](row)
    if table in ACROSS_STEPS:
        steps = _steps(source.tables.get(ACROSS_STEPS[table], ()), row)
        words += [word for step in steps for word in ("--timestep", repr(step))]
    return shlex.join(["bodycheck", *words])


def engine(row: Row) -> str:
    """Return the engine of a row as the command line names it: NAME@VERSION, or NAME alone if the version is not valid."""
    name, version = adapter_of(str(row["engine"])), row.get("version")
    try:
        return f"{name}@{Version(str(version))}"
    except InvalidVersion:
        return name


@cache
def _case(name: str) -> str:
    return name if is_shipped(name) else f"{name}{CASE_END}"


def _method(row: Row) -> list[str]:
    """Return the options `--integrator` and `--timestep`, each only if the row has a value for it."""
    found = ["--integrator", str(row["integrator"])] if row.get("integrator") else []
    return [*found, "--timestep", repr(row["timestep"])] if row.get("timestep") is not None else found


def _run(row: Row) -> list[str]:
    if row.get("integrator") == RECORDED:
        return ["compare", "LOG.csv", _case(row["case"]), "--name", str(row["engine"]), "--version", str(row["version"])]
    return ["run", _case(row["case"]), "--engine", engine(row), *_method(row)]


def _tradeoff(row: Row) -> list[str]:
    batch = ["--batch", f"{row['batch']:.0f}"] if row.get("batch") else []
    return ["tradeoff", _case(row["case"]), "--engine", engine(row), *_method(row), *batch]


def _orders(row: Row) -> list[str]:
    return ["tradeoff", _case(row["case"]), "--engine", engine(row), "--integrator", str(row["integrator"])]


def _releases(row: Row) -> list[str]:
    versions = [str(row[name]) for name in ("version", "from_version", "to_version") if row.get(name)]
    return ["releases", adapter_of(str(row["engine"])), *versions, "--case", _case(row["case"]), *_method(row)]


def _contact(row: Row) -> list[str]:
    # The figures are those of a run. The command `contact` would search for the best setting in this scene alone.
    return ["run", _case(row["scene"]), "--engine", engine(row), *_method(row)]


def _contact_study(row: Row) -> list[str]:
    return ["contact", engine(row)]


def _parity(row: Row) -> list[str]:
    model = str(row["model"])
    named = f"./{model}" if model.startswith("-") else model  # a file name from a submission must not be read as an option
    return ["parity", named, *([] if row["engine"] == "file" else ["--engine", engine(row)])]


def _audit(row: Row) -> list[str]:
    return ["audit", engine(row), *_method(row)]


def _ensemble(row: Row) -> list[str]:
    return ["ensemble", _case(row["case"]), "--engine", engine(row), *_method(row), "--members", str(row["members"])]


def _attribution(row: Row) -> list[str]:
    return ["run", _case(row["case"]), "--engine", engine(row), "--integrator", str(row["integrator"])]


def _steps(rows: Sequence[Row], like: Row) -> list[float]:
    """Return the time steps (s) with which the method of a row was run on its case, the largest first."""
    same = {row["timestep"] for row in rows if all(row.get(name) == like[name] for name in ("case", "engine", "integrator"))}
    return sorted(same, reverse=True)


#: The tables whose numbers come from several time steps, each with the table that contains the runs.
ACROSS_STEPS = {"attribution.csv": "results.csv", "orders.csv": "tradeoff.csv"}

#: The functions that return the words after `bodycheck` for a row, by the file names of tables.
MAKERS: dict[str, Callable[[Row], list[str]]] = {
    "results.csv": _run,
    "attribution.csv": _attribution,
    "tradeoff.csv": _tradeoff,
    "orders.csv": _orders,
    "releases.csv": _releases,
    "changes.csv": _releases,
    "contact.csv": _contact,
    "contact_settings.csv": _contact_study,
    "contact_properties.csv": _contact_study,
    "parity.csv": _parity,
    "audit.csv": _audit,
    "ensemble.csv": _ensemble,
}
