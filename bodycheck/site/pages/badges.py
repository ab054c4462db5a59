"""A badge for each engine: how many scenes its newest release ran, failed, refused and so on. It has no score.

The same counts, of this release and of every other one, are files that services of badges read (the endpoint of Shields).
"""

import json
from collections.abc import Iterator

from markupsafe import escape

from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.releases import Release, releases
from bodycheck.site.render import File

#: The text on the left side of a badge.
LABEL = "bodycheck"

#: The colour of the right side.
COLOUR = "#0b5cad"

#: The widths of characters of Verdana and DejaVu Sans at 11 px (pixels), rounded up; other characters count as `WIDEST`.
WIDTHS = {
    **dict.fromkeys("ijl|'.,:;!I[]()/ ", 5.0),
    **dict.fromkeys('frt-"', 5.5),
    **dict.fromkeys("abcdeghknopqsuvxyzJ_0123456789", 7.2),
    **dict.fromkeys("ABCDEFGHKLNOPQRSTUVXYZ", 8.7),
}
WIDEST = 11.0

#: The margin at both sides of a text, and the height of a badge (pixels).
MARGIN, HEIGHT = 6, 20


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the badges."""
    for engine in catalogue.engines:
        ran = [one for one in releases(catalogue, engine) if one.runs]
        newest = text(ran[-1]) if ran else f"{engine}: not measured"
        yield File(links.badge(engine), badge(newest).encode())
        yield File(links.endpoint(engine), endpoint(newest))
        for release in ran:
            yield File(links.endpoint(engine, release.version), endpoint(text(release)))


def endpoint(message: str) -> bytes:
    """Return what a service of badges needs to draw a badge with a message."""
    drawn = {"schemaVersion": 1, "label": LABEL, "message": message, "color": COLOUR}
    return (json.dumps(drawn, ensure_ascii=False) + "\n").encode()


def text(release: Release) -> str:
    """Return the text of the badge for a release."""
    counts = release.counts
    told = [
        f"{release.ran} ran",
        *(f"{counts[name]} {name}" for name in ("failed", "refused", "unsupported") if name in counts),
    ]
    if counts["not run"]:
        told.append(f"{counts['not run']} not run")
    return f"{release.engine} {release.version}: {', '.join(told)}"


def badge(message: str) -> str:
    """Return a badge with a message as SVG. The colours do not depend on the message."""
    left, right = width(LABEL), width(message)
    whole = left + right + 4 * MARGIN
    edge = left + 2 * MARGIN
    style = 'font-family="Verdana,DejaVu Sans,Geneva,sans-serif" font-size="11" fill="#ffffff"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{whole}" height="{HEIGHT}" role="img" '
        f'aria-label="{escape(f"{LABEL} | {message}")}">'
        f"<title>{escape(f'{LABEL} | {message}')}</title>"
        f'<rect width="{edge}" height="{HEIGHT}" fill="#3d444d"/>'
        f'<rect x="{edge}" width="{whole - edge}" height="{HEIGHT}" fill="{COLOUR}"/>'
        f"<g {style}>"
        f'<text x="{MARGIN}" y="14" textLength="{left}">{LABEL}</text>'
        f'<text x="{edge + MARGIN}" y="14" textLength="{right}">{escape(message)}</text>'
        "</g></svg>\n"
    )


def width(message: str) -> int:
    """Return the width of a text (pixels). Browsers space the letters to this width in any font."""
    return round(sum(WIDTHS.get(letter, WIDEST) for letter in message))
