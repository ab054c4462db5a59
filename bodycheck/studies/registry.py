"""The studies, each a folder beside this module, whose parts are modules with fixed names.

A folder needs the modules `rows` and `study`, whose contents `plain` describes. If the options, the page or the output of a
study differ from those of a plain study, its folder also has `command`, `interface` (its Python function), `page`, `printing`
or `saved` (the function that reads its saved results).
"""

import importlib
import importlib.util
import inspect
from typing import Any

#: The folders of the studies, in the order in which their commands are listed.
STUDIES = [
    *("tradeoff", "recommend", "estimate", "extremes", "ensemble", "ablation"),
    *("audit", "parity", "contact", "sensors", "releases"),
]


def is_plain(study: str) -> bool:
    """Return whether a study has no module `command`, so that its command is made by `plain_command`."""
    return importlib.util.find_spec(f"{__package__}.{study}.command") is None


def part(study: str, name: str) -> Any | None:
    """Return a module of the folder of a study; None if the folder has no such module."""
    path = f"{__package__}.{study}.{name}"
    return importlib.import_module(path) if importlib.util.find_spec(path) is not None else None


def required(study: str, name: str) -> Any:
    """Return a module that the folder of a study must have."""
    module = part(study, name)
    assert module is not None, f"the study {study} has no module {name}"
    return module


def about(study: str) -> str:
    """Return the description of a study: the docstring of its folder up to the first list."""
    paragraphs = (inspect.getdoc(importlib.import_module(f"{__package__}.{study}")) or "").split("\n\n")
    lists = [number for number, text in enumerate(paragraphs) if text.startswith("- ")]
    return "\n\n".join(paragraphs[: min(lists, default=None)])
