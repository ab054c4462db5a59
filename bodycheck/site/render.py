"""The files of the site, made from templates and values."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import jinja2

from bodycheck.reports.html import environment, json_text, unbroken
from bodycheck.reports.quantities import QUANTITIES, bound, milliseconds, number, within
from bodycheck.reports.runs.choices import SAME_COST
from bodycheck.results.verdicts import SCENES
from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue

#: The titles of figures for readers, by column.
TITLES = {name: quantity.title for name, quantity in QUANTITIES.items()}

#: The most engines that the matrix has room for at 1280 pixels. With more, it scrolls in a region of its own.
MOST_COLUMNS = 16

#: The version of the format of the data.
FORMAT = 1


@dataclass(frozen=True)
class File:
    """A file of the site.

    Parameters
    ----------
    path
        The path of the file inside the site, with slashes.
    content
        The bytes of the file.
    """

    path: str
    content: bytes


def page(path: str, template: str, catalogue: Catalogue, **values: Any) -> File:
    """Return a page of the site.

    Parameters
    ----------
    path
        The path of the page inside the site.
    template
        The name of the template in the folder `templates`.
    catalogue
        The catalogue of the site, from which the head of the page knows the other pages. A template can use it, `root` (the
        relative address of the site's root), `path`, the functions of `links`, the `verdicts`, the `words` for verdicts on
        scenes, the `titles` of figures, and functions that format numbers.
    values
        Further variables of the template.
    """
    root = "../" * path.count("/")
    return File(
        path, _environment().get_template(template).render(root=root, path=path, catalogue=catalogue, **values).encode()
    )


def asset(name: str) -> File:
    """Return a style sheet or a script of the folder `templates` as a file in `assets/` of the site."""
    return File(f"assets/{name}", (resources.files("bodycheck.site") / "templates" / name).read_bytes())


def data_files(path: str, name: str, value: Mapping[str, Any]) -> Iterator[File]:
    """Yield two files of a value: JSON for programs, and a script for pages that sets a variable to the value.

    Parameters
    ----------
    path
        The path of both files inside the site, without the file name extension.
    name
        The name of the variable in the script.
    value
        The value, which must be valid JSON.
    """
    yield json_file(path, value)
    yield script_file(path, name, value)


def json_file(path: str, value: Mapping[str, Any]) -> File:
    """Return a value as a JSON file. path: its path inside the site, without ".json"."""
    return File(f"{path}.json", (json.dumps(value, separators=(",", ":"), allow_nan=False) + "\n").encode())


def script_file(path: str, name: str, value: Mapping[str, Any]) -> File:
    """Return a script that sets the variable `name` to a value. path: its path inside the site, without ".js"."""
    return File(f"{path}.js", f"{name}={json_text(value)};\n".encode())


@cache
def _environment() -> jinja2.Environment:
    pages = environment("bodycheck.site")
    pages.filters["unbroken"] = unbroken
    pages.globals |= {"links": links, "words": SCENES, "titles": TITLES}
    pages.globals |= {"same_cost": SAME_COST, "most_columns": MOST_COLUMNS}
    pages.globals |= {"number": number, "bound": bound, "within": within, "milliseconds": milliseconds}
    return pages
