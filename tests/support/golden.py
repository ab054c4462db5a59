"""Golden pages: one report of each kind as Markdown, whose wording is kept in `tests/golden/` and read there as a whole."""

import re
import shutil
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

from bodycheck.reports import markdown
from bodycheck.results.store import RECORDS
from bodycheck.robots.urdf_text import urdf
from tests.support import ROOT, journals, study_pages
from tests.support.asked import RENEW_OPTION
from tests.support.planted_engines import plant
from tests.support.processes import calls_here
from tests.support.reading_engines import ENGINES
from tests.support.robot_faults import clean_model
from tests.support.saved_results import call, move

#: The folder of the golden pages.
GOLDEN = ROOT / "tests" / "golden"

#: The command that writes them anew.
RENEW = f"pytest tests/commands/test_golden_pages.py {RENEW_OPTION}"

#: What varies between machines and releases, and what stands in its place.
VARYING = (
    (r"^\*bodycheck \d.*\*$", "*VERSIONS, MACHINE, DATE AND COMMAND*"),
    (r"\b(mujoco) \d+(\.\d+)+", r"\1 VERSION"),
    (r"\b\d\.\d+e-1\d\b|\b\de-1\d\b", "ROUNDING"),
    (r"(?<=agrees to ROUNDING) \([a-z ]+\)", ""),
    (r"(\d\.\d{6})\d{6,}", r"\1…"),
    (r"(?<=EARLIER_VERSION )\d+(\.\d+)+", "VERSION"),
)

#: The time of a step (s) in all runs, in place of the measured one.
STEP = 1e-5


def masked(text: str, *folders: Path) -> str:
    """A page without what varies: folders, versions, the machine, and what is rounding in numbers."""
    for folder in folders:
        text = text.replace(markdown.escape(str(folder)), "FOLDER").replace(str(folder), "FOLDER")
    for pattern, name in VARYING:
        text = re.sub(pattern, name, text, flags=re.MULTILINE)
    return text


def pages(saved: Path, folder: Path) -> dict[str, Callable[[], str]]:
    """What makes the golden pages, by name.

    saved: results of runs as `saved_results.made` leaves them. folder: an empty one, for what is made of them.
    """
    return {
        "runs": lambda: masked(of_runs(saved, folder), saved, folder),
        "comparison": lambda: masked(of_comparison(saved, folder), saved, folder),
        "parity": lambda: masked(of_parity(folder), folder),
        "ensemble": lambda: masked(markdown.render_study(study_pages.ensemble_page(folder / "ensemble"))),
        **{name: lambda make=make: masked(markdown.render_study(make())) for name, make in STUDIES.items()},  # type: ignore[misc]
    }


#: The studies whose rows are made by hand.
STUDIES = {
    "tradeoff": study_pages.tradeoff_page,
    "tradeoff-none": study_pages.tradeoff_of_nothing,
    "recommend": study_pages.recommend_page,
    "recommend-none": lambda: study_pages.recommend_page(reached=False),
    "extremes": study_pages.extremes_page,
    "ablate": study_pages.ablation_page,
    "releases": study_pages.releases_page,
    "releases-none": study_pages.releases_of_nothing,
    "audit": study_pages.audit_page,
    "contact": study_pages.contact_page,
}

NAMES = ("runs", "comparison", "parity", "ensemble", *STUDIES)


def timed(record: dict[str, Any]) -> dict[str, Any]:
    """A record of a journal, with the time that is the same on all machines."""
    return record | {"wall_time": STEP * record["steps"]} if record.get("wall_time") is not None else record


def copy(saved: Path, folder: Path, change: Callable[[dict[str, Any]], dict[str, Any] | None] = timed) -> Path:
    """A copy of the saved results of runs, with changed records."""
    shutil.copytree(saved / "run", folder)
    journals.edit(folder / RECORDS, change)
    return folder


def quietly(*arguments: object) -> int:
    """The exit code of a command, which prints to nobody."""
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        return call(*arguments)


def of_runs(saved: Path, folder: Path) -> str:
    """The report of runs."""
    own = copy(saved, folder / "run")
    assert quietly("report", own) == 1
    return (own / "report.md").read_text("utf-8")


def of_comparison(saved: Path, folder: Path) -> str:
    """The report of two folders: two larger errors, a run that crashed, and a run that is in one folder only."""

    def later(record: dict[str, Any]) -> dict[str, Any] | None:
        run = (record.get("case"), record.get("engine"), record.get("integrator"), record.get("timestep"))
        if record["record"] == "run" and run == ("slide", "mujoco", "RK4", 0.01):
            kept = {name: record[name] for name in ("record", "place", "case", "engine", "version", "integrator", "timestep")}
            return kept | {"status": "crashed", "contact_law": None, "reason": "its process died of signal SIGSEGV"}
        if record["record"] == "run" and run[:2] == ("spin", "raising") and run[-1] == 0.005:
            return None
        return timed(record)

    before, after = copy(saved, folder / "before"), copy(saved, folder / "after", later)
    move(after, 0.25)
    move(after, 1e-3, timestep=0.005)
    assert quietly("report", before, after, "--out", folder / "compared") == 1
    return (folder / "compared" / "report.md").read_text("utf-8")


def of_parity(folder: Path) -> str:
    """The report of a robot in engines that read it rightly, otherwise or not at all."""
    names = ("faithful", "heavy", "picky", "mjcf-only")
    plant(folder / "planted", {name: ENGINES[name] for name in names})
    (folder / "arm.urdf").write_text(urdf(clean_model()), "utf-8")
    options = ("--states", 4, "--motion", 0.2, "--out", folder / "parity")
    with pytest.MonkeyPatch.context() as patch, calls_here():
        patch.syspath_prepend(folder / "planted")
        engines = [word for name in names for word in ("--engine", name)]
        assert quietly("parity", folder / "arm.urdf", *engines, *options) == 1
    return (folder / "parity" / "report.md").read_text("utf-8")
