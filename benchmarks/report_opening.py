"""Measure how long a report takes to open from disk in a browser and to react, in seconds from the start of the navigation.

    python benchmarks/report_opening.py [REPORT.html]

Without an argument, a report of 100 cases and 20 methods is made from copies of a few short runs. `loaded` is the time when the
page has loaded and its scripts have run, `sorted` when a table is shown sorted after a click on a header, and `legend` when a
click in the first legend has switched a method off. Each time is measured three times, in a new page.
"""

import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from bodycheck import load, reports
from bodycheck.adapters.contract import Method
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results import store
from bodycheck.results.store import Results
from bodycheck.running import campaign, engines, plan

CASES, METHODS = 100, 20

#: Cases whose runs are copied.
NAMES = ("intermediate-axis-flip", "projectile", "free-brick", "sliding-brick")

#: Script that sorts a table and clicks on a legend, and resolves to the times (ms).
ANSWERS = """() => new Promise((done, fail) => {
  setTimeout(() => fail(new Error("no answer within a minute")), 60000);
  const times = { loaded: performance.getEntriesByType("navigation")[0].loadEventEnd };
  const shown = (callback) => requestAnimationFrame(() => setTimeout(callback));
  const press = (legend) => {
    const button = legend.querySelector("[data-method]");
    if (!button) return setTimeout(press, 5, legend);
    button.click();
    if (button.getAttribute("aria-pressed") !== "false") throw new Error("the legend does not answer");
    shown(() => done({ ...times, legend: performance.now() }));
  };
  const unfold = (part) => { // of many cases each is folded
    for (let fold = part.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
  };
  const head = document.querySelector("table.sortable thead button");
  unfold(head);
  head.click();
  if (!head.closest("[aria-sort]")) throw new Error("the table does not answer");
  shown(() => {
    times.sorted = performance.now();
    const legend = document.querySelector(".legend");
    unfold(legend);
    legend.scrollIntoView();
    press(legend);
  });
})"""


def opening(browser: Any, path: Path) -> dict[str, float]:
    """Return the times (s) by event. browser: Playwright's Browser."""
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    try:
        page = context.new_page()
        page.goto(path.resolve().as_uri())
        return {name: taken / 1e3 for name, taken in page.evaluate(ANSWERS).items()}
    finally:
        context.close()


@dataclass(frozen=True)
class Copies(Results):
    """Results of copies of cases, which have the names that `copy` returns and the truths of the originals."""

    source: Results

    def truth(self, case: str, timestep: float) -> Truth | NoTruth:
        return self.source.truth(case.rpartition("-")[0], timestep)


def copy(case: str, place: int) -> str:
    """Return the name of a copy of a case."""
    return f"{case}-{place}"


def large_report(folder: Path) -> Path:
    """Write a report of `CASES` times `METHODS` runs and its data into an empty folder, and return the report's path."""
    records, _ = engines.describe(("mujoco", "pinocchio"))
    head = campaign.header((), records, {})
    with campaign.results(plan.plan(tuple(map(load, NAMES)), records, (), (0.002,)), folder, head):
        pass
    source = store.read(folder)
    own: dict[str, list[Verdict]] = {name: [] for name in NAMES}
    for verdict in judgement.judge(source):
        if verdict.discrepancy is not None:
            own[verdict.run.case].append(verdict)
    originals = [(NAMES[place % len(NAMES)], place) for place in range(CASES)]
    texts = [
        {"name": copy(*case), "text": source.cases[case[0]].text.replace(f'name = "{case[0]}"', f'name = "{copy(*case)}"')}
        for case in originals
    ]
    copies = Copies(folder, source.header | {"cases": texts}, source.records, source.complete, source)
    verdicts = [
        _renamed(own[case[0]][place % len(own[case[0]])], copy(*case), place) for case in originals for place in range(METHODS)
    ]
    return reports.write([ResultSet(copies, verdicts)], folder)[0]


def _renamed(verdict: Verdict, case: str, place: int) -> Verdict:
    method = Method.parse(f"{verdict.run.method.name}-{place}", verdict.run.method.timestep)
    return replace(verdict, run=replace(verdict.run, case=case, method=method))


def main() -> None:
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from tests.support.browser import CHROMIUM, launched

    if CHROMIUM is None:
        print("there is no chromium on the path")
        return
    with tempfile.TemporaryDirectory() as place, launched() as browser:
        path = Path(sys.argv[1]) if len(sys.argv) > 1 else large_report(Path(place))
        print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB")
        for _ in range(3):
            print(", ".join(f"{name} {taken:.2f} s" for name, taken in opening(browser, path).items()))


if __name__ == "__main__":
    main()
