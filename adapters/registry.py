"""Finding adapters by name: the files of this folder, and the entry points `bodycheck.engines` of other packages.

An entry point names an adapter's module, or an object in one. Nothing is imported before an engine is asked for by name.
"""

import importlib
import pkgutil
from importlib.metadata import entry_points
from typing import cast

import bodycheck.adapters
from bodycheck.adapters.contract import Adapter

GROUP = "bodycheck.engines"
OWN_MODULES = (
    *("contract", "registry"),
    *("mujoco_contact", "mujoco_models"),
    *("pinocchio_contact", "pinocchio_joints", "pinocchio_schemes"),
)


class EngineMissing(Exception):
    """An engine cannot be used here; the text says why and, where it can, what to install."""


def names() -> tuple[str, ...]:
    """Names of all engines that have an adapter, whether the engine itself is installed or not."""
    here = [module.name for module in pkgutil.iter_modules(bodycheck.adapters.__path__) if module.name not in OWN_MODULES]
    return tuple(here + [point.name for point in entry_points(group=GROUP) if point.name not in here])


def load(name: str) -> Adapter:
    """The adapter of an engine, and with it the engine. Raises `EngineMissing`."""
    if name not in names():
        raise EngineMissing(f"there is no engine {name!r}; there are: {', '.join(names())}")
    try:
        for point in entry_points(group=GROUP, name=name):
            return cast(Adapter, point.load())
        return cast(Adapter, importlib.import_module(f"bodycheck.adapters.{name}"))
    except ModuleNotFoundError as error:
        raise EngineMissing(f"{name} is not installed: there is no Python package {error.name!r}") from error
    except ImportError as error:
        raise EngineMissing(f"{name} cannot be imported: {error}") from error
