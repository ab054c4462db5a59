"""Reports in a real browser: Debian's Chromium or another, driven by Playwright."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

#: No sandbox, which root cannot have, and nothing that the browser would ask of the network by itself.
QUIET = ("--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update")


@contextmanager
def launched() -> Iterator[Any]:
    """Playwright's Browser. Skips the test where there is no Chromium or no Playwright."""
    sync = pytest.importorskip("playwright.sync_api", reason="reports are not tried in a browser: Playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("reports are not tried in a browser: there is no chromium on the path")
    with sync.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        try:
            yield browser
        finally:
            browser.close()


@dataclass
class Visit:
    """An open page (Playwright's Page), what it complained of, and the addresses that it asked for, its own apart."""

    page: Any
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@contextmanager
def visiting(
    browser: Any,
    path: Path,
    width: int = 1280,
    height: int = 800,
    scheme: Literal["light", "dark"] = "light",
    site: Path | None = None,
    place: str = "",
) -> Iterator[Visit]:
    """A file opened from disk in a window of so many pixels. Fails where the page complained or asked for anything.

    site: a folder whose files the page may ask for. place: what follows the path in the address, such as "#part".
    """
    context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
    try:
        visit = Visit(context.new_page())
        visit.page.on("console", lambda line: line.type in ("error", "warning") and visit.complaints.append(line.text))
        visit.page.on("pageerror", lambda error: visit.complaints.append(str(error)))
        own = (site or path).resolve().as_uri()
        visit.page.on(
            "request",
            lambda asked: asked.url.startswith(("data:", "blob:", own)) or visit.requests.append(asked.url),
        )
        visit.page.goto(path.resolve().as_uri() + place)
        yield visit
        assert not visit.complaints
        assert not visit.requests
    finally:
        context.close()


def shown_cases(page: Any) -> list[str]:
    """The cases that the matrices show as rows or as columns."""
    heads = page.locator("#matrix tr[data-words] > th:visible, #matrix th[data-words]:visible")
    return [text.replace("\u200b", "") for text in heads.all_inner_texts()]
