"""How long a report takes to open from disk in a browser and to answer, in seconds from the beginning of the navigation.

    python benchmarks/report_opening.py [REPORT.html]

Without a report, one of 100 cases and 20 methods is made, its runs copies of a few short ones. Loaded: the page and its scripts
have run. Sorted: a click on a column's header has sorted a table, and the window has shown that. Legend: the first legend was
scrolled to, and a click has switched a method off. Three times over, each in a fresh page.
"""

import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from bodycheck import load, reports
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reference.truth import Truth
from bodycheck.running import campaign, plan, store
from bodycheck.running.outcome import Unsupported
from bodycheck.running.store import Results

CASES, METHODS = 100, 20
NAMES = ("intermediate-axis-flip", "projectile", "free-brick", "sliding-brick")

ANSWERS = """() => new Promise((done) => {
  const times = { loaded: performance.getEntriesByType("navigation")[0].loadEventEnd };
  const shown = (callback) => requestAnimationFrame(() => setTimeout(callback));
  const press = (legend) => {
    const button = legend.querySelector("[data-method]");
    if (!button) return setTimeout(press, 5, legend);
    button.click();
    if (button.getAttribute("aria-pressed") !== "false") throw new Error("the legend does not answer");
    shown(() => done({ ...times, legend: performance.now() }));
  };
  const head = document.querySelector("table.sortable thead button");
  head.click();
  if (!head.closest("[aria-sort]")) throw new Error("the table does not answer");
  shown(() => {
    times.sorted = performance.now();
    const legend = document.querySelector(".legend");
    legend.scrollIntoView();
    press(legend);
  });
})"""


def opening(browser: Any, path: Path) -> dict[str, float]:
    """Seconds by what had happened then. browser: Playwright's Browser."""
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    try:
        page = context.new_page()
        page.goto(path.resolve().as_uri())
        return {name: taken / 1e3 for name, taken in page.evaluate(ANSWERS).items()}
    finally:
        context.close()


@dataclass(frozen=True)
class Copies(Results):
    """Results of copies of cases, named as `copy` names them, which have their truths."""

    source: Results

    def truth(self, case: str, timestep: float) -> Truth | Unsupported:
        return self.source.truth(case.rpartition("-")[0], timestep)


def copy(case: str, place: int) -> str:
    return f"{case}-{place}"


def large_report(folder: Path) -> Path:
    """A report of `CASES` times `METHODS` runs, written into an empty folder with what it is made of."""
    engines = {name: registry.load(name) for name in ("mujoco", "pinocchio")}
    head = campaign.header((), {name: engine.engine.version for name, engine in engines.items()}, {})
    with campaign.results(plan.plan(tuple(map(load, NAMES)), engines, (), (0.002,)), folder, head):
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
