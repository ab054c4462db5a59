"""Take pictures of the parts of a report for a review, in light and dark, on a wide and on a narrow screen.

    python docs/screenshots.py REPORT.html --out DIR

The pictures are DIR/SCHEME-WIDTH-PART.png. PART is `first` for the first screen, or the name of a section; of the cases, only
the first one of each kind is included. DIR/print.pdf is the whole report on paper. The script needs Playwright and a Chromium
on the path.
"""

import argparse
import sys
from pathlib import Path
from typing import Any, Literal

#: Width and height of the windows, in pixels.
SIZES = ((1280, 800), (390, 844))

SCHEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")

#: Script that marks the parts of a page, with only the first case of each matrix, and returns their names.
MARK = """() => {
  const links = [...document.querySelectorAll("[data-part] tbody tr:first-child th a")];
  const first = new Set(links.map((link) => link.hash.slice(1)));
  for (const part of document.querySelectorAll("main > section, footer"))
    if (!first.size || !part.id.startsWith("case-") || first.has(part.id))
      part.dataset.picture = part.id || part.getAttribute("aria-labelledby") || part.localName;
  return [...document.querySelectorAll("[data-picture]")].map((part) => part.dataset.picture);
}"""


def pictures(page: Any, place: Path, prefix: str) -> None:
    """Take pictures of the first screen and of each part of an open page (Playwright's Page)."""
    page.screenshot(path=place / f"{prefix}-first.png")
    for name in page.evaluate(MARK):
        part = page.locator(f"[data-picture='{name}']")
        part.scroll_into_view_if_needed()
        for chart in part.locator(".chart").all():  # charts are drawn when they come near the window
            chart.scroll_into_view_if_needed()
            chart.locator("svg.marks").wait_for()
        part.screenshot(path=place / f"{prefix}-{name}.png")


def main() -> None:
    parser = argparse.ArgumentParser(
        description="Take pictures of a report in light and dark, on a wide and on a narrow screen."
    )
    parser.add_argument("report", type=Path, metavar="REPORT.html")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    options = parser.parse_args()
    if not options.report.is_file():
        parser.error(f"{options.report} is not a file")
    options.out.mkdir(parents=True, exist_ok=True)

    sys.path.insert(0, str(Path(__file__).parents[1]))
    from playwright.sync_api import sync_playwright

    from tests.support.browser import CHROMIUM, QUIET

    if CHROMIUM is None:
        parser.error("there is no chromium on the path")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        for scheme in SCHEMES:
            for width, height in SIZES:
                page = browser.new_page(viewport={"width": width, "height": height}, color_scheme=scheme)
                page.goto(options.report.resolve().as_uri())
                pictures(page, options.out, f"{scheme}-{width}")
                if (scheme, width) == ("light", SIZES[0][0]):
                    page.pdf(path=options.out / "print.pdf", format="A4")
                page.close()
        browser.close()
    print(f"{len(list(options.out.glob('*.png')))} pictures in {options.out}")


if __name__ == "__main__":
    main()
