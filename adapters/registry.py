"""Finding adapters by name: the folders beside this file, and the entry points `bodycheck.engines` of other packages.

An entry point names an adapter's module, or an object in one. Nothing is imported before an engine is asked for by name.

What an engine is installed from stands in the group `bodycheck.distributions`, by the engine's name, with underscores for
hyphens: `myengine = "my_engine"`. It is said there and not by the adapter, so that it is known where the engine is not.
"""

import importlib
import pkgutil
from importlib.metadata import entry_points
from typing import cast

import bodycheck.adapters
from bodycheck.adapters.contract import Adapter

GROUP = "bodycheck.engines"
DISTRIBUTIONS = "bodycheck.distributions"
#: What the engines with adapters here are installed from.
OWN_DISTRIBUTIONS = {"mujoco": "mujoco", "pinocchio": "pin"}


class EngineMissing(Exception):
    """An engine cannot be used here; the text says why and, where it can, what to install."""


def names() -> tuple[str, ...]:
    """Names of all engines that have an adapter, whether the engine itself is installed or not."""
    here = [module.name for module in pkgutil.iter_modules(bodycheck.adapters.__path__) if module.ispkg]
    return tuple(here + [point.name for point in entry_points(group=GROUP) if point.name not in here])


def distribution(name: str) -> str:
    """The name in package indexes of what an engine is installed from. Raises `EngineMissing` where that is not said."""
    _refuse_unknown(name)
    if name in OWN_DISTRIBUTIONS:
        return OWN_DISTRIBUTIONS[name]
    for point in entry_points(group=DISTRIBUTIONS, name=name):
        return point.value.replace("_", "-")
    raise EngineMissing(f"{name} does not say what it is installed from: it has no entry point in the group {DISTRIBUTIONS!r}")


def load(name: str) -> Adapter:
    """The adapter of an engine, and with it the engine. Raises `EngineMissing`."""
    _refuse_unknown(name)
    try:
        for point in entry_points(group=GROUP, name=name):
            return cast(Adapter, point.load())
        return cast(Adapter, importlib.import_module(f"bodycheck.adapters.{name}.engine"))
    except ModuleNotFoundError as error:
        raise EngineMissing(f"{name} is not installed: there is no Python package {error.name!r}") from error
    except ImportError as error:
        raise EngineMissing(f"{name} cannot be imported: {error}") from error


def _refuse_unknown(name: str) -> None:
    if name not in names():
        raise EngineMissing(f"there is no engine {name!r}; there are: {', '.join(names())}")
