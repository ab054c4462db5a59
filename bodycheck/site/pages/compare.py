"""The page that compares any two results of an engine (dates, versions or machines), and the differences that it shows.

The results of an engine are its runs of one version in one table of a submission. `data/changes/ENGINE.json` has the
differences between any two of them:

- `results`: the results, the oldest first, as the key of the submission, the version and the table;
- `pairs`: the pairs of results that differ, as their indices `before` and `after` in `results`. `differences` has the runs that
  differ beyond rounding, by the quantity that differs: "status", or an error. A run is given by the place of its row in the
  table of the results before; the run after is that of the same case, integrator and time step.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

from bodycheck.site import changes, links
from bodycheck.site.catalogue import Catalogue, Entry, Results, results_of
from bodycheck.site.render import FORMAT, File, data_files, page

#: Most results of an engine in one submission that are compared, so that the pairs of a stranger's results stay few.
MOST_RESULTS = 64


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the page, and the differences between the results of each engine."""
    yield page(links.COMPARE, "compare.html.jinja", catalogue=catalogue, rule=changes.RULE)
    compared: dict[str, list[Results]] = {engine: [] for engine in catalogue.engines}
    for source in catalogue.submissions:
        of_source = defaultdict(list)
        for results in results_of(source):
            of_source[results.engine].append(results)
        for engine, every in of_source.items():
            compared[engine] += every[:MOST_RESULTS]
    for engine, every in compared.items():
        yield from data_files(links.changes(engine), f'site.differences["{engine}"]', differences(catalogue, engine, every))


def differences(catalogue: Catalogue, engine: str, compared: Sequence[Results]) -> dict[str, Any]:
    """Return the differences between any two results of an engine in their JSON form. compared: those, the oldest first."""
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
    """Return the runs of results by what those that are compared have in common: case, integrator and time step."""
    return {(run.row["case"], *run.method): run for run in results.runs if run.row["timestep"] is not None}


def _different(
    catalogue: Catalogue, earlier: Mapping[tuple[Any, ...], Entry], later: Mapping[tuple[Any, ...], Entry]
) -> dict[str, list[int]]:
    """Return the places of the earlier runs that differ from the later ones, by the quantity that differs."""
    places: dict[str, list[int]] = {}
    for key, before in earlier.items():
        after = later.get(key)
        change = None if after is None else changes.change(catalogue, catalogue.scenes[key[0]], after, before)
        if change is not None:
            places.setdefault(change.quantity, []).append(before.place)
    return places
