"""Accuracy against cost: the default of each engine, what its documentation recommends, and its best method at equal cost.

The cost of a run is computing time per second of motion. Methods are compared by it and not by their time steps, since a step
of one method may cost many of another. The costs are those of tradeoff.csv, which are measured many times. An engine without
such rows has the costs of results.csv, which are measured once.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reports.runs.choices import ENOUGH, SAME_COST
from bodycheck.results.outcome import Completed
from bodycheck.site import cells
from bodycheck.site.catalogue import Catalogue, Entry, Scene
from bodycheck.site.submissions.own_methods import in_role

#: The least ratio of two errors that sentences call better.
BETTER = 2.0


@dataclass(frozen=True, eq=False)
class Priced:
    """A completed run with its cost.

    Parameters
    ----------
    run
        The row of the run.
    error
        The error in the quantity of the scene, in its unit; that of the truth itself if that is larger.
    cost
        The computing time (s) of a second of motion.
    """

    run: Entry
    error: float
    cost: float


@dataclass(frozen=True, eq=False)
class Standing:
    """An engine in a scene.

    Parameters
    ----------
    engine
        The engine.
    usual
        Its default method, or the method that represents an engine without one.
    recommended
        The method that its documentation recommends; None if there is none, or if it was not measured.
    best
        Its most accurate method that costs at most what `usual` costs.
    runs
        All its runs with costs.
    repeated
        Whether the costs were measured many times.
    """

    engine: str
    usual: Priced
    recommended: Priced | None
    best: Priced
    runs: tuple[Priced, ...]
    repeated: bool

    @property
    def default(self) -> bool:
        """Return whether `usual` is the default of the engine, and not a method that stands for one."""
        return "default" in str(self.usual.run.get("role") or "")

    @property
    def gain(self) -> float:
        """Return how many times the error of `usual` is as large as that of `best`."""
        return self.usual.error / self.best.error if self.best.error else 1.0


@dataclass(frozen=True, eq=False)
class Costs:
    """The engines in a scene, the cheapest accurate method of all, and whether one machine measured them all."""

    scene: Scene
    standings: tuple[Standing, ...]
    one_machine: bool

    @property
    def cheapest(self) -> Priced | None:
        """Return the cheapest run with an error of at most `ENOUGH`; of those whose costs are equal, the most accurate one."""
        accurate = [run for one in self.standings for run in one.runs if run.error <= ENOUGH]
        least = min((run.cost for run in accurate), default=0.0)
        return min((run for run in accurate if run.cost <= SAME_COST * least), key=lambda run: run.error, default=None)

    @property
    def far(self) -> tuple[Standing, ...]:
        """Return the engines whose defaults have errors above `ENOUGH`, the worst first."""
        far = (one for one in self.standings if one.default and one.usual.error > ENOUGH)
        return tuple(sorted(far, key=lambda one: one.usual.error, reverse=True))

    @property
    def repairable(self) -> tuple[Standing, ...]:
        """Return those of `far` that have a method with an error of at most `ENOUGH` at the cost of the default."""
        return tuple(one for one in self.far if one.best.error <= ENOUGH)


def of_scene(catalogue: Catalogue, scene: Scene) -> Costs | None:
    """Return the engines whose costs in a scene are known; None if there are none, or if joints are driven.

    What computes the effort of a driven joint, and how often, differs between engines, so that costs there do not compare.
    """
    if isinstance(scene.case.scene, Mechanism) and scene.case.scene.controllers:
        return None
    known = (standing(catalogue, engine, scene) for engine in catalogue.engines)
    standings = tuple(one for one in known if one is not None)
    machines = {one.usual.run.source.machine for one in standings}
    return Costs(scene, standings, len(machines) == 1) if standings else None


def standing(catalogue: Catalogue, engine: str, scene: Scene) -> Standing | None:
    """Return how accurate an engine is at which cost in a scene; None if the cost of its own method is not known."""
    cell = cells.cell(catalogue, engine, scene)
    if cell.run is None:
        return None
    repeated = _newest([one for one in _studied(catalogue, scene.name) if one.engine == engine])
    once = [run for run in catalogue.runs[engine, scene.name] if run.source is cell.run.source]
    for runs in (repeated, once):
        priced = [one for run in runs if run.version == cell.run.version and (one := _priced(run, scene)) is not None]
        default = in_role([one.run.row for one in priced], "default")
        usual = priced[default] if default is not None else _of_method(priced, cell.run)
        if usual is not None:
            recommended = in_role([one.run.row for one in priced], "recommended")
            affordable = [one for one in priced if one.cost <= SAME_COST * usual.cost]
            best = min(affordable, key=lambda one: (one.error, one.cost))
            return Standing(
                engine,
                usual,
                None if recommended is None else priced[recommended],
                best if usual.error > BETTER * best.error else usual,
                tuple(priced),
                runs is repeated,
            )
    return None


def shown(catalogue: Catalogue) -> tuple[Costs, ...]:
    """Return the scenes of which the front page can show accuracy against cost, that which says most first.

    This is the scene in which most engines have costs that were measured many times; then that in which most engines have a
    better method at the cost of their default; then the first by name.
    """
    known = (of_scene(catalogue, scene) for scene in catalogue.scenes.values())

    def weight(costs: Costs) -> tuple[int, int, int]:
        better = sum(one.gain > BETTER for one in costs.standings)
        return sum(one.repeated for one in costs.standings), better, len(costs.standings)

    return tuple(sorted((one for one in known if one is not None), key=weight, reverse=True))


def _studied(catalogue: Catalogue, case: str) -> Sequence[Entry]:
    """Return the rows of tradeoff.csv about single runs of a case."""
    return [entry for entry in catalogue.entries("tradeoff.csv") if entry.row["case"] == case and not entry.get("batch")]


def _newest(rows: Sequence[Entry]) -> list[Entry]:
    """Return the rows of the newest version in the newest submission."""
    last = max(rows, key=lambda entry: entry.order, default=None)
    return [] if last is None else [one for one in rows if (one.version, one.source) == (last.version, last.source)]


def _priced(run: Entry, scene: Scene) -> Priced | None:
    """Return a completed run with its cost; None if the error or the cost is not known."""
    error, cost = run.get(scene.quantity.name), _cost(run.row)
    if run.get("status") != Completed.status or error is None or cost is None:
        return None
    return Priced(run, max(abs(error), run.get(scene.quantity.bound_name) or 0.0), cost)


def _cost(row: Mapping[str, float | None]) -> float | None:
    """Return the computing time (s) of a second of motion: that of all processors, where a study has measured it."""
    cost, factor = row.get("cost"), row.get("realtime_factor")
    step, busy = row.get("time_per_step"), row.get("processor_time_per_step")
    if cost and step and busy:
        return cost * busy / step
    return cost or (1 / factor if factor else None)


def _of_method(priced: Sequence[Priced], run: Entry) -> Priced | None:
    """Return the run of the same method as another one; None if there is none."""
    return next((one for one in priced if one.run.method == run.method), None)
