"""Print results to stdout, and progress to stderr."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from bodycheck.console.figures import WITHIN, error_text
from bodycheck.figures.bounds import rounded_up
from bodycheck.figures.columns import bounds_of
from bodycheck.figures.conservation import angular_momentum, rotational_energy, total_energy
from bodycheck.figures.definition import Comparison
from bodycheck.judging.expectation_writer import Change
from bodycheck.judging.judgement import Verdict
from bodycheck.reference.certificate import Certificate
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import Truth
from bodycheck.running.campaign import Advance

if TYPE_CHECKING:
    from bodycheck.judging.baseline import Difference

#: Width in characters of a table that is printed into a file or a pipe.
FILE_WIDTH = 200


def print_json(value: Any) -> None:
    """Print a value as JSON, on one line."""
    print(json.dumps(value, ensure_ascii=False))


def print_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table with a header, as wide as the terminal."""
    table = Table(*header, box=None, header_style="bold", pad_edge=False)
    for row in rows:
        table.add_row(*map(escape, row))
    console = Console()
    console.width = console.width if console.is_terminal else FILE_WIDTH
    console.print(table)


def print_errors(header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table with errors of runs as `error_text` gives them, and explain the sign if any of them has it."""
    print_table(header, rows)
    if any(cell.startswith(WITHIN) for row in rows for cell in row):
        print(f"{WITHIN} marks an error within the truth's own error, which is the number shown")


def print_requirements(needs: Mapping[str, Mapping[str, bool | str | int]]) -> None:
    """Print one line per case with its requirements, which are given by their names."""

    def text(value: bool | str | int) -> str:
        return ("yes" if value else "-") if isinstance(value, bool) else str(value)

    header = ("case", *(name.replace("_", " ") for name in next(iter(needs.values()))))
    print_table(header, [(case, *map(text, needed.values())) for case, needed in needs.items()])


def print_results(verdicts: Sequence[Verdict]) -> None:
    """Print one line per run, and the numbers of runs that passed and failed."""
    header = (
        "case",
        "engine",
        "integrator",
        "step",
        "status",
        "passed",
        "position m",
        "attitude rad",
        "energy",
        "us/step",
        "reason",
    )
    print_errors(header, [_result(verdict) for verdict in verdicts])
    count = {passed: sum(verdict.passed is passed for verdict in verdicts) for passed in (True, False, None)}
    print(f"{len(verdicts)} runs: {count[True]} passed, {count[False]} failed, {count[None]} without expectations")


def _result(verdict: Verdict) -> tuple[str, ...]:
    row = verdict.row()

    passed = {True: "passed", False: "FAILED", None: "-"}[verdict.passed]
    return (
        *(row["case"], row["engine"], row["integrator"], f"{row['timestep']:g}", row["status"], passed),
        *(
            error_text(row, "position_error"),
            error_text(row, "attitude_error"),
            error_text(row, "energy_drift", "energy_error"),
            f"{1e6 * row['time_per_step']:.3g}" if "time_per_step" in row else "",
        ),
        row["reason"],
    )


def print_changes(changes: Sequence[Change]) -> None:
    """Print one line per measurement, saying whether its expectations were written."""
    rows = [
        (run.case, run.engine, run.method.name, f"{run.method.timestep:g}", change.text)
        for change in changes
        for run in (change.verdict.run,)
    ]
    print_table(("case", "engine", "integrator", "step", "its expectations"), rows)


def print_difference(found: "Difference") -> None:
    """Print one line per change, the changes of the time per step, and a summary of the changes in one sentence."""
    if found.changes:
        header = ("case", "engine", "integrator", "step", "what", "base", "now", "explained", "change")
        rows = [
            (change.case, change.engine, change.integrator, f"{change.timestep:g}", change.what, *change.figures, change.amount)
            for change in found.changes
        ]
        print_table(header, rows)
    for pace in found.paces:
        print(pace.text)
    if found.redefined:
        print(f"not compared, since their definition has changed (save a new baseline): {', '.join(found.redefined)}")
    if found.changes:
        print(found.text)


def print_truth(truth: Truth, most_rows: int) -> None:
    """Print the states at no more than `most_rows` evenly chosen instants, the model and the methods that computed them."""
    trajectory = truth.trajectory
    chosen = np.unique(np.linspace(0, len(trajectory) - 1, min(most_rows, len(trajectory))).astype(int))

    def vector(values: Any) -> str:
        return " ".join(f"{value:.9g}" for value in values)

    header = (
        *("t s", "position m", "quaternion w x y z", "velocity m/s", "angular velocity (body) rad/s"),
        *("error rad", "error m"),
    )
    rows = [
        (
            f"{trajectory.t[i]:g}",
            *(vector(part[i]) for part in (trajectory.position, trajectory.quaternion, trajectory.velocity)),
            vector(trajectory.angular_velocity[i]),
            *(f"{rounded_up(bound[i], 2):.2g}" for bound in (truth.bounds.error, truth.bounds.position_error)),
        )
        for i in chosen
    ]
    print_table(header, rows)
    left_out = f"; {len(chosen)} of {len(trajectory)} instants, --json prints all" if len(chosen) < len(trajectory) else ""
    print(_other_bounds(truth))
    print(f"model {truth.model} ({truth.reason}), backend {truth.backend}{left_out}")
    if truth.witnesses:
        print(f"compared with {'; '.join(truth.witnesses)}")


def _other_bounds(truth: Truth) -> str:
    """Return the largest bounds of the figures that the table of a truth lacks, on two lines of less than 80 characters."""
    velocity, rate, energy, momentum = (
        f"{rounded_up(float(values.max()), 2):.2g}"
        for name, values in bounds_of(truth).items()
        if name not in ("truth_error", "truth_position_error")
    )
    return (
        f"velocity error at most {velocity} m/s, angular velocity error {rate} rad/s,\n"
        f"energy error {energy}, angular momentum error {momentum}, both relative"
    )


def print_certificate(certificate: Certificate) -> None:
    """Print how much the methods of computing a truth differ up to some instants, and how well the truth conserves energy."""
    truth = certificate.truth
    t = truth.trajectory.t
    chosen = np.unique(np.searchsorted(t, np.linspace(0, t[-1], 5)[1:]))

    def figures(values: Array) -> tuple[str, ...]:
        return tuple(f"{values[i]:.1e}" for i in chosen)

    print("\nlargest attitude difference so far, rad")
    rows = [(f"{one} | {other}", *figures(apart)) for (one, other), apart in certificate.differences.items()]
    rows += [
        ("printed bound of the truth's error", *figures(truth.bounds.error)),
        ("certified bound", *figures(certificate.bound)),
    ]
    print_table(("ways", *(f"until {t[i]:g} s" for i in chosen)), rows)
    if certificate.certified:
        print(f"certified: {certificate.bound[-1]:.1e} rad, measured against arithmetic of {certificate.digits} digits")
    if certificate.growth is not None:
        print(f"an error at one instant grows up to {certificate.growth.max():.2g}-fold until a later one")
    compared = Comparison(truth, truth.trajectory)
    energy, rotational, momentum = (
        f"{compute(compared).max():.1e}" for compute in (total_energy, rotational_energy, angular_momentum)
    )
    print(f"drifts of the truth itself, relative: energy {energy}, rotational energy {rotational}, angular momentum {momentum}")


@contextmanager
def progress(title: str, total: int) -> Iterator[Advance]:
    """Show a progress bar on stderr while the context lasts.

    The context provides a function that advances the bar. Its arguments are a text about the last task, and the number of
    completed units (1 by default). `total` is the number of all units.
    """
    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), TextColumn("{task.fields[last]}"))
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(title, total=total, last="")

        def advance(last: str, count: int = 1, /) -> None:
            bar.update(task, advance=count, last=escape(last))
            if last and not console.is_terminal:
                print(last, file=console.file)

        yield advance
