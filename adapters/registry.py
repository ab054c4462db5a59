"""Find adapters by name: the folders beside this file, and the entry points `bodycheck.engines` of other packages.

The adapter of a folder is its module `engine`; an entry point names an adapter's module, or an object in one. Nothing is
imported before an engine is asked for by name.

The name of the package that installs an engine must be known even if the engine is not installed. A folder defines it as
`DISTRIBUTION` in its `__init__.py`, which imports nothing of the engine. Another package defines it by an entry point in the
group `bodycheck.distributions`, with underscores in place of hyphens: `myengine = "my_engine"`.
"""

import importlib
import pkgutil
from importlib.metadata import entry_points

import bodycheck.adapters
from bodycheck.adapters.contract import Adapter
from bodycheck.adapters.method import is_name
from bodycheck.adapters.record import fault_of

#: The group of entry points that name adapters in other packages.
ENGINE_GROUP = "bodycheck.engines"
#: The group of entry points that name the packages which install engines.
DISTRIBUTION_GROUP = "bodycheck.distributions"


class EngineMissing(Exception):
    """An engine cannot be used here; the text says why, and which package to install if that is known."""


class EngineBroken(EngineMissing):
    """An engine is installed, but fails when it is imported or asked for its record; the text says how."""


def names() -> tuple[str, ...]:
    """Return the names of all engines that have an adapter, installed or not.

    An entry point whose name cannot be that of an engine is not one.
    """
    own = _own()
    return tuple(own + [p.name for p in entry_points(group=ENGINE_GROUP) if p.name not in own and is_name(p.name)])


def distribution(name: str) -> str:
    """Return the name of the package that installs an engine, as pip spells it.

    Raises `EngineMissing` for an unknown engine, and for one whose adapter does not name its package.
    """
    _check_known(name)
    if name in _own():
        return str(importlib.import_module(f"bodycheck.adapters.{name}").DISTRIBUTION)
    for point in entry_points(group=DISTRIBUTION_GROUP, name=name):
        return point.value.replace("_", "-")
    raise EngineMissing(
        f"{name} does not say what it is installed from: it has no entry point in the group {DISTRIBUTION_GROUP!r}"
    )


def load(name: str) -> Adapter:
    """Import an engine and return its adapter, whose record is complete.

    Raises `EngineMissing` if the engine is not installed or has no adapter, and `EngineBroken` if it fails.
    """
    _check_known(name)
    try:
        points = entry_points(group=ENGINE_GROUP, name=name)
        adapter = next(iter(points)).load() if points else importlib.import_module(f"bodycheck.adapters.{name}.engine")
    except ModuleNotFoundError as error:
        raise EngineMissing(f"{name} is not installed: there is no Python package {error.name!r}") from error
    except ImportError as error:
        raise EngineBroken(f"{name} cannot be imported: {error}") from error
    except (Exception, SystemExit) as error:  # an engine may raise anything
        raise EngineBroken(f"{name} cannot be imported: {_told(error)}") from error
    try:
        complete = isinstance(adapter, Adapter)
        fault = fault_of(adapter.engine) if complete else None
    except (Exception, SystemExit) as error:
        raise EngineBroken(f"{name} does not say what it is: {_told(error)}") from error
    if not complete:
        raise EngineMissing(
            f"{name} has no adapter: {_description(adapter)} lacks `engine` or `prepare` of bodycheck's contract"
        )
    if fault is not None:
        raise EngineBroken(f"{name} does not say what it is: {fault}")
    return adapter


def _told(error: BaseException) -> str:
    """Return the type and the message of an exception as valid UTF-8."""
    text = f"{type(error).__name__}: {error}".removesuffix(": ")
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def _description(adapter: object) -> str:
    """Return the name of a module, or of the type of an object."""
    return str(getattr(adapter, "__name__", type(adapter).__name__))


def _own() -> list[str]:
    """Return the engines whose adapters are folders beside this file."""
    return [module.name for module in pkgutil.iter_modules(bodycheck.adapters.__path__) if module.ispkg]


def _check_known(name: str) -> None:
    if name not in names():
        raise EngineMissing(f"there is no engine {name!r}; there are: {', '.join(names())}")
