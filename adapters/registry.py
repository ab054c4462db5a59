"""Find adapters by name: the folders beside this file, and the entry points `bodycheck.engines` of other packages.

The adapter of a folder is its module `engine`; an entry point names an adapter's module, or an object in one. Nothing is
imported before an engine is asked for by name.

The package that installs an engine must be known where the engine is not installed. A folder has it as `DISTRIBUTION` in its
`__init__.py`, which imports nothing of the engine; another package has an entry point in the group `bodycheck.distributions`
with underscores for hyphens: `myengine = "my_engine"`.
"""

import importlib
import pkgutil
from importlib.metadata import entry_points

import bodycheck.adapters
from bodycheck.adapters.contract import Adapter

GROUP = "bodycheck.engines"
DISTRIBUTIONS = "bodycheck.distributions"


class EngineMissing(Exception):
    """An engine cannot be used here; the text says why and, where it can, what to install."""


def names() -> tuple[str, ...]:
    """Names of all engines that have an adapter, whether the engine itself is installed or not."""
    own = _own()
    return tuple(own + [point.name for point in entry_points(group=GROUP) if point.name not in own])


def distribution(name: str) -> str:
    """The package that installs an engine, as pip names it. Raises `EngineMissing` where that is not said."""
    _refuse_unknown(name)
    if name in _own():
        return str(importlib.import_module(f"bodycheck.adapters.{name}").DISTRIBUTION)
    for point in entry_points(group=DISTRIBUTIONS, name=name):
        return point.value.replace("_", "-")
    raise EngineMissing(f"{name} does not say what it is installed from: it has no entry point in the group {DISTRIBUTIONS!r}")


def load(name: str) -> Adapter:
    """The adapter of an engine, and with it the engine. Raises `EngineMissing`."""
    _refuse_unknown(name)
    try:
        points = entry_points(group=GROUP, name=name)
        adapter = next(iter(points)).load() if points else importlib.import_module(f"bodycheck.adapters.{name}.engine")
    except ModuleNotFoundError as error:
        raise EngineMissing(f"{name} is not installed: there is no Python package {error.name!r}") from error
    except ImportError as error:
        raise EngineMissing(f"{name} cannot be imported: {error}") from error
    if not isinstance(adapter, Adapter):
        raise EngineMissing(f"{name} has no adapter: {point_of(adapter)} lacks `engine` or `prepare` of bodycheck's contract")
    return adapter


def point_of(adapter: object) -> str:
    """A module or an object in words."""
    return str(getattr(adapter, "__name__", type(adapter).__name__))


def _own() -> list[str]:
    """The engines whose adapters are folders beside this file."""
    return [module.name for module in pkgutil.iter_modules(bodycheck.adapters.__path__) if module.ispkg]


def _refuse_unknown(name: str) -> None:
    if name not in names():
        raise EngineMissing(f"there is no engine {name!r}; there are: {', '.join(names())}")
