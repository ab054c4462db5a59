"""Take the pictures of the gallery, in light and dark.

    make docs
    python docs/pictures.py build/docs

It writes docs/gallery/images/NAME-SCHEME.png, the first chart of each notebook without its text, and needs Playwright and a
Chromium on the path. The picture of the front page is drawn by docs/flip_picture.py.
"""

import argparse
import sys
from pathlib import Path
from typing import Any, Literal

DOCS = Path(__file__).parent

Scheme = Literal["light", "dark"]
SCHEMES: tuple[Scheme, ...] = ("light", "dark")

#: The notebooks of the gallery.
NOTEBOOKS = ("flip", "trade", "sliding-brick", "robot-parity", "ensemble", "upgrade")

#: Style of a chart that is a small picture, in which what would be too small to read is hidden.
SMALL = """
figure.chart { width: 400px; height: 200px; overflow: hidden; }
figure.chart svg { width: 400px !important; height: 200px !important; min-width: 0; overflow: hidden; }
figure.chart text, figure.chart .role-legend, figure.chart .role-title { display: none; }
figure.chart .mark-line path { stroke-width: 4; }
"""

#: Script that lets the first chart of a page show the region of its marks alone, in the shape of the small picture.
CROP = """() => {
  const svg = document.querySelector("figure.chart svg");
  const region = svg.querySelector(".role-frame path.background").getBBox();
  const place = svg.querySelector(":scope > g").transform.baseVal.consolidate().matrix;
  svg.setAttribute("viewBox", `${place.e - 6} ${place.f - 6} ${region.width + 12} ${region.height + 12}`);
  svg.setAttribute("preserveAspectRatio", "none");
}"""


def gallery(browser: Any, built: Path) -> None:
    """Take the first chart of each notebook from the documentation that was built."""
    for scheme in SCHEMES:
        page = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme=scheme)
        for name in NOTEBOOKS:
            page.goto((built / "gallery" / f"{name}.html").resolve().as_uri())
            page.evaluate(CROP)
            page.add_style_tag(content=SMALL)
            save(page.locator("figure.chart").first, DOCS / "gallery" / "images" / f"{name}-{scheme}.png")
        page.close()


def save(part: Any, path: Path) -> None:
    """Write a picture of a page or of an element of it (Playwright's Page or Locator)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part.screenshot(path=path)
    print(path, f"{path.stat().st_size / 1000:.0f} kB")


def main() -> None:
    parser = argparse.ArgumentParser(description="Take the pictures of the gallery, in light and dark.")
    parser.add_argument("built", type=Path, help="the folder of the built documentation")
    options = parser.parse_args()
    if not options.built.exists():
        parser.error(f"{options.built} does not exist")

    sys.path.insert(0, str(DOCS.parent))
    from playwright.sync_api import sync_playwright

    from tests.support.browser import CHROMIUM, QUIET

    if CHROMIUM is None:
        parser.error("there is no chromium on the path")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        gallery(browser, options.built)
        browser.close()


if __name__ == "__main__":
    main()
