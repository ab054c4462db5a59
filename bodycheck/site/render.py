"""Files of the site from templates."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import jinja2

from bodycheck.reports.html import environment, json_text
from bodycheck.reports.quantities import QUANTITIES, bound, milliseconds, number, within
from bodycheck.results.verdicts import SCENES
from bodycheck.site import links

#: The names for readers of figures, by their columns.
TITLES = {name: quantity.title for name, quantity in QUANTITIES.items()}

#: The version of the format of the data.
FORMAT = 1


@dataclass(frozen=True)
class File:
    """A file of the site.

    Parameters
    ----------
    path
        Its path inside the site, with slashes.
    content
        Its content.
    """

    path: str
    content: bytes


def page(path: str, template: str, **values: Any) -> File:
    """Return a page of the site.

    Parameters
    ----------
    path
        Its path inside the site.
    template
        The name of the template in the folder `templates`. It has `root`, which leads from the page to the root of the site,
        the functions of `links`, the `verdicts` with the `words` of those on scenes, the `titles` of figures, and functions for
        numbers.
    values
        Further variables of the template.
    """
    root = "../" * path.count("/")
    return File(path, _environment().get_template(template).render(root=root, path=path, **values).encode())


def asset(name: str) -> File:
    """Return a style sheet or a script of the folder `templates` as a file in `assets/` of the site."""
    return File(f"assets/{name}", (resources.files("bodycheck.site") / "templates" / name).read_bytes())


def data_files(path: str, name: str, value: Mapping[str, Any]) -> Iterator[File]:
    """Yield a value as JSON for programs, and as a script for pages, which sets a variable.

    Parameters
    ----------
    path
        The path inside the site, without its end.
    name
        The variable.
    value
        The value.
    """
    yield json_file(path, value)
    yield script_file(path, name, value)


def json_file(path: str, value: Mapping[str, Any]) -> File:
    """Return a value as a file of JSON. path: without its end."""
    return File(f"{path}.json", (json.dumps(value, separators=(",", ":"), allow_nan=False) + "\n").encode())


def script_file(path: str, name: str, value: Mapping[str, Any]) -> File:
    """Return a script that sets a variable to a value. path: without its end."""
    return File(f"{path}.js", f"{name}={json_text(value)};\n".encode())


@cache
def _environment() -> jinja2.Environment:
    pages = environment("bodycheck.site")
    pages.globals |= {"links": links, "words": SCENES, "titles": TITLES}
    pages.globals |= {"number": number, "bound": bound, "within": within, "milliseconds": milliseconds}
    return pages
