"""The page that compares any two results of an engine (dates, versions or machines), and the differences that it shows.

The results of an engine are its runs of one version in one table of a submission. `data/changes/ENGINE.json` has the
differences between any two of them:

- `results`: the results, the oldest first, each with the key of its submission, its version and its table;
- `pairs`: the pairs of results that differ, as the indices `before` and `after` in `results`, with `differences`: the runs that
  differ beyond rounding, by the differing quantity: "status", or an error. A run is given by the index of its row in the table
  of the earlier results; the later run has the same case, integrator and time step.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

from bodycheck.site import changes, links
from bodycheck.site.catalogue import Catalogue, Entry, Results, results_of
from bodycheck.site.render import FORMAT, File, data_files, page

#: The most results of an engine in one submission that are compared, so that one submission cannot make too many pairs.
MOST_RESULTS = 64


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the page, and the differences between the results of each engine."""
    compared: dict[str, list[Results]] = {engine: [] for engine in catalogue.engines}
    for source in catalogue.submissions:
        of_source = defaultdict(list)
        for results in results_of(source):
            of_source[results.engine].append(results)
        for engine, every in of_source.items():
            compared[engine] += every[:MOST_RESULTS]
    of_engines = [differences(catalogue, engine, every) for engine, every in compared.items()]
    yield page(links.COMPARE, "compare.html.jinja", catalogue, rule=changes.RULE, opening=opening(of_engines))
    for one in of_engines:
        yield from data_files(links.changes(one["engine"]), f'site.differences["{one["engine"]}"]', one)


def opening(of_engines: Sequence[Mapping[str, Any]]) -> str:
    """Return the engine that the page shows first: one with the most differing runs in a pair of results; "" if there is none.

    of_engines: the differences of each engine.
    """
    most = {one["engine"]: max(map(_amount, one["pairs"]), default=0) for one in of_engines}
    best = max(most, key=lambda engine: most[engine], default="")
    return best if most.get(best) else ""


def _amount(pair: Mapping[str, Any]) -> int:
    """Return the number of runs that differ between two results."""
    return sum(map(len, pair["differences"].values()))


def differences(catalogue: Catalogue, engine: str, compared: Sequence[Results]) -> dict[str, Any]:
    """Return the differences between any two results of an engine in JSON form. compared: the results, the oldest first."""
    pairs = []
    for (before, earlier), (after, later) in combinations(enumerate(map(_runs, compared)), 2):
        if different := _different(catalogue, earlier, later):
            pairs.append({"before": before, "after": after, "differences": different})
    return {
        "format": FORMAT,
        "engine": engine,
        "results": [{"submission": one.source.key, "version": one.version, "table": one.table} for one in compared],
        "pairs": pairs,
    }


def _runs(results: Results) -> Mapping[tuple[Any, ...], Entry]:
    """Return the runs of results by case, integrator and time step, which are equal in two runs that are compared."""
    return {(run.row["case"], *run.method): run for run in results.runs if run.row["timestep"] is not None}


def _different(
    catalogue: Catalogue, earlier: Mapping[tuple[Any, ...], Entry], later: Mapping[tuple[Any, ...], Entry]
) -> dict[str, list[int]]:
    """Return the row indices of the earlier runs that differ from the later runs, by the differing quantity."""
    places: dict[str, list[int]] = {}
    for key, before in earlier.items():
        after = later.get(key)
        change = None if after is None else changes.change(catalogue, catalogue.scenes[key[0]], after, before)
        if change is not None:
            places.setdefault(change.quantity, []).append(before.place)
    return places
