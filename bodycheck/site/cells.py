"""The cell of an engine and a scene: a verdict with its error, the error bound of the truth, and the changes."""

from dataclasses import dataclass, replace

from bodycheck.reports.quantities import number, within
from bodycheck.results.outcome import Completed, Unsupported
from bodycheck.results.verdicts import SCENES, Verdict
from bodycheck.site import changes
from bodycheck.site.catalogue import REFUSES, Catalogue, Entry, Scene
from bodycheck.site.changes import Change
from bodycheck.site.submissions.own_methods import in_role, own_method


@dataclass(frozen=True, eq=False)
class Cell:
    """The results of an engine on a scene.

    Parameters
    ----------
    verdict
        The verdict on the method that represents the engine: its default method, as far as it is known.
    run
        The run of that method; None if the engine has no run of the scene.
    value, bound
        The error in the quantity of the scene and the error bound of the truth, in the quantity's unit; None if unknown.
    recommended
        The run of the method that the documentation of the engine recommends; None if there is none, or if it is not known.
    best
        The completed run of the engine with the smallest error; None if no run completed with an error.
    changes
        The changes in any method of the engine since the previous results; empty if there are no earlier results.
    reason
        Why there is no error; empty if there is an error.
    others
        The runs of the same method in the same version, from other submissions, that say something else.
    """

    verdict: Verdict
    run: Entry | None = None
    value: float | None = None
    bound: float | None = None
    recommended: Entry | None = None
    best: Entry | None = None
    changes: tuple[Change, ...] = ()
    reason: str = ""
    others: tuple[Entry, ...] = ()


def cell(catalogue: Catalogue, engine: str, scene: Scene) -> Cell:
    """Return the cell of an engine and a scene, for the newest version of the engine with runs of the scene."""
    runs = catalogue.runs.get((engine, scene.name), ())
    if not runs:
        why = catalogue.without_method.get((engine, scene.name), "")
        return Cell("unsupported" if why else "not run", reason=why)
    newest = [entry for entry in runs if entry.version == runs[-1].version and entry.source is runs[-1].source]
    own = default_run(newest)
    changed = tuple(changes.since(catalogue, scene, newest))
    done = [entry for entry in newest if entry.get("status") == Completed.status and entry.get(scene.quantity.name) is not None]
    recommended = in_role([entry.row for entry in newest], "recommended")
    best = min(done, key=lambda entry: float(entry.get(scene.quantity.name)), default=None)
    return replace(
        of_run(own, scene),
        recommended=None if recommended is None else newest[recommended],
        best=best,
        changes=changed,
        others=changes.contradictions(catalogue, scene, own),
    )


def verdict(run: Entry, scene: Scene) -> Verdict:
    """Return the verdict on a run."""
    status = run.get("status")
    if status == Unsupported.status:
        return "refused" if REFUSES in str(run.get("reason")) else "unsupported"
    if status != Completed.status:
        return "failed"
    if run.get("passed") is False:
        return "broken"
    value, bound = run.get(scene.quantity.name), run.get(scene.quantity.bound_name)
    return "exact" if value is not None and bound is not None and value <= bound else "error"


def default_run(runs: list[Entry]) -> Entry:
    """Return the run of the method that represents an engine; see `own_methods.own_method`.

    runs: the runs of one scene in one version of an engine in one submission; at least one run, in any order.
    """
    in_order = sorted(runs, key=lambda entry: entry.place)
    return in_order[own_method([entry.row for entry in in_order], in_order[0].source.header.defaults)]


def of_run(run: Entry, scene: Scene) -> Cell:
    """Return a cell with a run alone."""
    value, bound = run.get(scene.quantity.name), run.get(scene.quantity.bound_name)
    return Cell(verdict(run, scene), run, value, bound, reason=str(run.get("reason") or ""))


def text(cell: Cell) -> str:
    """Return the text of a cell: the error to two digits, the bound if the run is exact, or the mark of the verdict.

    The text is "ok" for a completed run in which the scene's quantity was not measured.
    """
    if cell.verdict == "exact" and cell.bound is not None:
        return within(cell.bound, 2)
    if cell.value is not None and cell.verdict in ("error", "broken"):
        return f"{SCENES[cell.verdict].mark}{number(cell.value, 2)}"
    return SCENES[cell.verdict].mark or "ok"
