"""Take the pictures of the README and of the gallery, in light and dark.

    bodycheck run --engine mujoco --engine pinocchio --out results
    python docs/pictures.py readme results/report.html
    make docs
    python docs/pictures.py gallery build/docs

The first one writes docs/images/matrix-player-SCHEME.png: the matrix of a report beside the player of one of its cases. The other
one writes docs/gallery/images/NAME-SCHEME.png: the first chart of each notebook without its text. Both need Playwright, Pillow and
a Chromium on the path.
"""

import argparse
import io
import sys
from pathlib import Path
from typing import Any, Literal

from PIL import Image

DOCS = Path(__file__).parent

Scheme = Literal["light", "dark"]
SCHEMES: tuple[Scheme, ...] = ("light", "dark")

#: The notebooks of the gallery.
NOTEBOOKS = ("flip", "trade", "sliding-brick", "robot-parity", "ensemble", "upgrade")

#: Style of a chart that is a small picture: what is too small to read is hidden, and lines are thicker.
SMALL = """
figure.chart svg { width: 480px !important; }
figure.chart text, figure.chart .role-legend, figure.chart .role-title { display: none; }
figure.chart .mark-line path { stroke-width: 4; }
"""

#: The width of a small picture, in pixels, and the most colours of a picture.
WIDTH, COLOURS = 480, 128


def save(picture: Image.Image, path: Path) -> None:
    """Write a picture with few colours, which are enough for charts and text."""
    path.parent.mkdir(parents=True, exist_ok=True)
    picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)
    print(path, f"{path.stat().st_size / 1000:.0f} kB")


def taken(part: Any) -> Image.Image:
    """Return a picture of an element of a page (Playwright's Locator)."""
    return Image.open(io.BytesIO(part.screenshot()))


def gallery(browser: Any, built: Path) -> None:
    """Take the first chart of each notebook from the documentation that was built."""
    for scheme in SCHEMES:
        page = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme=scheme)
        for name in NOTEBOOKS:
            page.goto((built / "gallery" / f"{name}.html").resolve().as_uri())
            page.add_style_tag(content=SMALL)
            chart = taken(page.locator("figure.chart").first)
            chart.thumbnail((WIDTH, WIDTH))
            save(chart, DOCS / "gallery" / "images" / f"{name}-{scheme}.png")
        page.close()
