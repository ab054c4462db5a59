"""Measure how long a site of 20 engines by 100 scenes takes to build, and its front page to open and to answer, in seconds.

    python benchmarks/site.py

`built` is the time in which all files are made and written. `loaded` is the time from the start of the navigation until the
front page has loaded and its scripts have run, and `filtered` until it is shown after a first filter is set. The page is opened
three times from disk, each time in a new browser window.
"""

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

#: Script that sets a filter and resolves to the times (ms) since the start of the navigation.
ANSWERS = """() => new Promise((done) => {
  const loaded = performance.getEntriesByType("navigation")[0].loadEventEnd;
  const field = document.querySelector("#filters [name=q]");
  field.value = "scene-7";
  field.dispatchEvent(new Event("input", { bubbles: true }));
  requestAnimationFrame(() => setTimeout(() => done({ loaded, filtered: performance.now() })));
})"""


def opening(browser: Any, path: Path) -> dict[str, float]:
    """Return the times (s) by event, and that of the browser's driver from the call to the answer. browser: Playwright's."""
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    try:
        page = context.new_page()
        start = time.perf_counter()
        page.goto(path.resolve().as_uri())
        found = {name: taken / 1e3 for name, taken in page.evaluate(ANSWERS).items()}
        return found | {"driven": time.perf_counter() - start}
    finally:
        context.close()


def main() -> None:
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from tests.site.browsing import built
    from tests.site.large import large
    from tests.support.browser import CHROMIUM, launched

    with tempfile.TemporaryDirectory() as place:
        catalogue = large()
        start = time.perf_counter()
        folder = built(catalogue, Path(place) / "site")
        taken = time.perf_counter() - start
        size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
        print(f"built {taken:.1f} s, {size / 1e6:.1f} MB; index.html {(folder / 'index.html').stat().st_size / 1e6:.2f} MB")
        if CHROMIUM is None:
            print("there is no chromium on the path")
            return
        with launched() as browser:
            for _ in range(3):
                print(", ".join(f"{name} {taken:.2f} s" for name, taken in opening(browser, folder / "index.html").items()))


if __name__ == "__main__":
    main()
