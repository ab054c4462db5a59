"""The built documentation: without warnings, from this folder alone, opened from disk, on any screen and by anybody.

The sources of the pages are tested in test_site_sources.py.
"""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal
from urllib.parse import unquote, urlsplit

import pytest
from filelock import FileLock

import bodycheck
from docs.extensions import versions
from tests.support import ROOT, axe, browser

pytestmark = pytest.mark.slow

#: One page of each type: the front page, prose, mathematics, commands, keys, the Python interface, a notebook and the search.
TYPES = (
    *("index", "truth", "glossary", "reference/columns", "reference/command-line", "reference/case-files"),
    *("reference/python", "studies", "gallery/index", "gallery/flip", "search", "cases", "start/tutorial"),
)

#: A telephone, a laptop and a wide screen.
WIDTHS = (390, 1280, 2560)

Scheme = Literal["light", "dark"]
SCHEMES: tuple[Scheme, ...] = ("light", "dark")

#: What a page asks for when it is opened. A link is asked for only by those who follow it.
ASKED = re.compile(
    r"""<(?:script|img|iframe|source|video|audio|embed)\b[^>]*?\ssrc=["']([^"']+)|<link\b[^>]*?\shref=["']([^"']+)"""
)
ASKED_BY_STYLES = re.compile(r"""url\(\s*["']?([^"')]+)|@import\s+["']([^"']+)""")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Path:
    """The documentation, built once for all processes that test it."""
    base = tmp_path_factory.getbasetemp()
    folder = (base if worker_id == "master" else base.parent) / "documentation"
    with FileLock(f"{folder}.lock"):
        if not folder.exists():
            options = ["--fail-on-warning", "--keep-going", "--nitpicky", "--quiet", "--doctree-dir", f"{folder}-trees"]
            built = subprocess.run(
                [sys.executable, "-m", "sphinx", *options, "--builder", "html", ROOT / "docs", folder],
                capture_output=True,
                text=True,
                env={**os.environ, "PYTHONPATH": str(ROOT)},
                check=False,
            )
            (folder / "warnings.txt").write_text(f"{built.stdout}{built.stderr}", "utf-8")
    return folder


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser.launched() as launched:
        yield launched


def pages(site: Path) -> list[Path]:
    """All pages; the theme has a template among its files."""
    return [path for path in sorted(site.rglob("*.html")) if not path.is_relative_to(site / "_static")]


def test_the_build_has_no_warning(site: Path) -> None:
    assert (site / "warnings.txt").read_text("utf-8") == ""


def test_every_page_is_built(site: Path) -> None:
    sources = [path.relative_to(ROOT / "docs") for ending in ("md", "ipynb") for path in (ROOT / "docs").rglob(f"*.{ending}")]
    built = set(pages(site))
    assert {site / path.with_suffix(".html") for path in sources if not path.parts[0].startswith("_")} <= built


def test_pages_ask_for_files_of_the_site_alone(site: Path) -> None:
    for path in [*pages(site), *site.rglob("*.css")]:
        pattern = ASKED if path.suffix == ".html" else ASKED_BY_STYLES
        for groups in pattern.findall(path.read_text("utf-8")):
            address = "".join(groups)
            asked = urlsplit(address)
            if asked.scheme != "data" and address != "#":
                assert not asked.scheme, (path, asked)
                assert not asked.netloc, (path, asked)
                assert (path.parent / unquote(asked.path)).is_file(), (path, asked)


def test_links_lead_to_pages_and_parts_of_the_site(site: Path) -> None:
    parts = {path: set(re.findall(r"""\sid=["']([^"']+)""", path.read_text("utf-8"))) for path in pages(site)}
    for path in parts:
        for link in re.findall(r"""<a\b[^>]*?\shref=["']([^"']+)""", path.read_text("utf-8")):
            to = urlsplit(link)
            if not to.scheme and not to.netloc:
                target = (path.parent / unquote(to.path)).resolve() if to.path else path
                assert target.is_file(), (path, link)
                if to.fragment and target in parts:
                    assert unquote(to.fragment) in parts[target], (path, link)


@pytest.mark.parametrize("page", TYPES)
def test_a_page_fits_every_screen(site: Path, chromium: Any, page: str) -> None:
    """It opens from disk without a complaint or another host, nothing but tables scrolls sideways, and no code is cut off."""
    for width in WIDTHS:
        for scheme in SCHEMES:
            with browser.visiting(chromium, site / f"{page}.html", width=width, scheme=scheme, site=site) as visit:
                assert visit.page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (width, scheme)
                cut = "pre => pre.scrollWidth > pre.clientWidth"
                assert visit.page.evaluate(f"[...document.querySelectorAll('pre')].some({cut})") is False, (width, scheme)


@pytest.mark.parametrize(("width", "scheme"), [(390, "dark"), (1280, "light")])
@pytest.mark.parametrize("page", TYPES)
def test_a_page_can_be_read_by_everybody(site: Path, chromium: Any, page: str, width: int, scheme: Scheme) -> None:
    with browser.visiting(chromium, site / f"{page}.html", width=width, scheme=scheme, site=site) as visit:
        axe.check(visit.page)


@pytest.mark.parametrize(
    ("words", "page"),
    [
        ("restitution", "cases.html"),
        ("--timestep", "reference/command-line.html"),
        ("cross-check", "truth.html"),
    ],
)
def test_the_search_works_from_disk(site: Path, chromium: Any, words: str, page: str) -> None:
    with browser.visiting(chromium, site / "search.html", site=site) as visit:
        visit.page.locator("form.bd-search input[type=search] >> visible=true").fill(words)
        visit.page.keyboard.press("Enter")
        found = visit.page.locator("#search-results li a")
        found.first.wait_for()
        visit.page.wait_for_function("/found \\d+ pages/.test(document.querySelector('#search-results').innerText)")
        assert page in {urlsplit(link).path for link in found.evaluate_all("links => links.map(a => a.getAttribute('href'))")}


def test_the_keyboard_reaches_the_content(site: Path, chromium: Any) -> None:
    """The first stop is a link past the navigation."""
    with browser.visiting(chromium, site / "truth.html", site=site) as visit:
        visit.page.keyboard.press("Tab")
        visit.page.keyboard.press("Enter")
        assert visit.page.url.endswith("#main-content")


def test_another_version_opens_at_the_same_page(site: Path, chromium: Any, tmp_path: Path) -> None:
    release = bodycheck.__version__
    (tmp_path / release).symlink_to(site, target_is_directory=True)
    with browser.visiting(chromium, site / "truth.html", site=site) as visit:
        assert visit.page.locator(".version-choice >> visible=true").inner_text() == release
        assert visit.page.locator(".version-choice select").count() == 0
    # The scripts that know all versions are written into folders of their own, not into the build that other tests share.
    together = tmp_path / "together"
    for folder in (release, "9.0"):
        (together / folder / "reference").mkdir(parents=True)
        for name in ("truth.html", "index.html", "searchindex.js", *(["glossary.html"] if folder == release else [])):
            (together / folder / name).write_bytes((site / name).read_bytes())
        for shared in ("_static", "_images"):
            (together / folder / shared).symlink_to(site / shared, target_is_directory=True)
        (together / folder / versions.FILE_NAME).touch()
    assert versions.join(together) == ["9.0", release]
    for page, there in (("truth", "truth"), ("glossary", "index")):
        with browser.visiting(chromium, together / release / f"{page}.html", site=together) as visit:
            visit.page.get_by_label("Version of the documentation").locator("visible=true").select_option("9.0")
            visit.page.wait_for_url(f"**/9.0/{there}.html")


def test_the_documentation_is_small(site: Path) -> None:
    """Both sites together may have 60 MB, and that of results takes most of it."""
    assert sum(path.stat().st_size for path in site.rglob("*") if path.is_file()) < 20e6
