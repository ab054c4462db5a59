"""Find adapters by name, in the folders beside this file and by the entry points `bodycheck.engines` of other packages.

The adapter of a folder is its module `engine`; an entry point names an adapter's module, or an object in a module. No adapter
is imported before it is requested by name. The record of an engine is checked, because another package may contain anything.

The packages that install an engine must be known even if it is not installed. A folder defines them as `INSTALLATION` in its
`__init__.py`, which imports nothing of the engine. Another package names the package that installs the engine by an entry point
in the group `bodycheck.distributions`, with underscores in place of hyphens: `myengine = "my_engine"`, or
`myengine = "my_engine [extra]"`.
"""

import importlib
import math
import pkgutil
import sys
from functools import cache
from importlib.metadata import EntryPoint, PackageNotFoundError, entry_points, metadata, version
from importlib.util import find_spec
from pathlib import Path
from traceback import extract_tb
from typing import get_args

from packaging.version import InvalidVersion, Version

import bodycheck.adapters
from bodycheck.adapters import offers
from bodycheck.adapters.contract import KINDS, Adapter, Engine, Integrator, Kind, Method, Option, Usage, Varied
from bodycheck.adapters.engine_name import EngineName
from bodycheck.adapters.installation import Installation
from bodycheck.adapters.method import MAX_NAME_LENGTH, is_name
from bodycheck.adapters.roles import ALIASES
from bodycheck.errors import BadInput
from bodycheck.suggestion import did_you_mean

#: The group of entry points that name adapters in other packages.
ENGINE_GROUP = "bodycheck.engines"
#: The group of entry points that name the packages which install engines.
DISTRIBUTION_GROUP = "bodycheck.distributions"


class EngineMissing(Exception):
    """An engine cannot be used in this environment; the text says why, and names the package to install if it is known."""


class EngineBroken(EngineMissing):
    """An engine is installed, but its import fails or its record is faulty; the text describes the failure."""


def names() -> tuple[str, ...]:
    """Return the names of all engines that have an adapter, installed or not.

    An entry point whose name cannot be the name of an engine is ignored.
    """
    folders = _own()
    return (*folders, *(point.name for point in _points(ENGINE_GROUP) if point.name not in folders and is_name(point.name)))


def installation(name: str) -> Installation:
    """Return the packages that install an engine.

    Raises `EngineMissing` for an unknown engine, and for an engine whose adapter does not name its package.
    """
    _check_known(name)
    if name in _own():
        stated: Installation = importlib.import_module(f"bodycheck.adapters.{name}").INSTALLATION
        return stated
    for point in _points(DISTRIBUTION_GROUP, name):
        return Installation(point.value.partition(" ")[0].replace("_", "-"), tuple(point.extras))
    raise EngineMissing(
        f"{name} does not say what it is installed from: it has no entry point in the group {DISTRIBUTION_GROUP!r}"
    )


def known_installation(name: str) -> Installation | None:
    """Return the packages that install an engine; None if its adapter does not name them.

    Raises `EngineMissing` for an unknown engine.
    """
    _check_known(name)
    try:
        return installation(name)
    except EngineMissing:
        return None


def sources(name: str) -> list[Path]:
    """Return the source files of an engine's adapter, without importing it. Raises `EngineMissing` for an unknown engine."""
    _check_known(name)
    if name in _own():
        return list(_own_sources())
    modules = {point.module.partition(".")[0] for point in _points(ENGINE_GROUP, name)}
    return [file for module in sorted(modules) for file in _files_of(module)]


def installed(name: str) -> str | None:
    """Return the version of the package that installs an engine, spelled as PEP 440 normalises it; None if it is not installed.

    Raises `EngineMissing` as `installation` does.
    """
    try:
        return str(Version(version(installation(name).distribution)))
    except (PackageNotFoundError, InvalidVersion):
        return None


def load(name: str) -> Adapter:
    """Import the adapter of an engine, check that its record is complete, and return it.

    Raises `EngineMissing` if the engine has no adapter, is not installed, or is installed in another version than `name` says,
    and `EngineBroken` if the import fails or the record is faulty.
    """
    engine_name = EngineName.parse(name)
    name = engine_name.adapter
    _check_known(name)
    if engine_name.version is not None and (installed_version := installed(name)) != engine_name.version:
        raise EngineMissing(f"{engine_name} is not installed: there is {installed_version or 'none'}")
    try:
        points = _points(ENGINE_GROUP, name)
        adapter = points[0].load() if points else importlib.import_module(f"bodycheck.adapters.{name}.engine")
    except ModuleNotFoundError as error:
        missing = f"{name} is not installed: there is no Python package {error.name!r}"
        raise EngineMissing(missing + _extra(name)) from error
    except ImportError as error:
        raise EngineBroken(f"{name} cannot be imported: {error}") from error
    except (Exception, SystemExit) as error:  # an engine may raise anything
        raise EngineBroken(f"{name} cannot be imported: {_told(error)}{frame(name, error)}") from error
    try:
        complete = isinstance(adapter, Adapter)
        fault = fault_of(adapter.engine) if complete else None
    except (Exception, SystemExit) as error:
        raise EngineBroken(f"{name} does not say what it is: {_told(error)}{frame(name, error)}") from error
    if not complete:
        raise EngineMissing(
            f"{name} has no adapter: {_description(adapter)} lacks `engine` or `prepare` of bodycheck's contract"
        )
    if fault is not None:
        raise EngineBroken(f"{name} does not say what it is: {fault}")
    return adapter


def frame(name: str, error: BaseException) -> str:
    """Return the innermost frame of an exception in the source of an adapter, such as " at toy.py:24"; empty if it has none."""
    folder = Path(bodycheck.adapters.__path__[0]).resolve()
    try:
        files = {path.resolve() for path in sources(name)}
    except ValueError:  # the module has put an object without a specification in its place
        return ""
    for path, line in reversed([(Path(one.filename).resolve(), one.lineno) for one in extract_tb(error.__traceback__)]):
        if path in files:
            return f" at {path.relative_to(folder).as_posix() if path.is_relative_to(folder) else path.name}:{line}"
    return ""


def _extra(name: str) -> str:
    """Return the end of a sentence that says how to install an engine, if an extra of bodycheck installs it; otherwise ''."""
    extras = metadata("bodycheck").get_all("Provides-Extra") or ()
    return f"; pip install 'bodycheck[{name}]' installs it" if name in extras and name in _own() else ""


def _told(error: BaseException) -> str:
    """Return the type and the message of an exception as valid UTF-8."""
    text = f"{type(error).__name__}: {error}".removesuffix(": ")
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def _description(adapter: object) -> str:
    """Return the name of a module, or of the type of an object."""
    return str(getattr(adapter, "__name__", type(adapter).__name__))


@cache
def _own() -> tuple[str, ...]:
    """Return the names of the engines whose adapters are folders beside this file."""
    return tuple(module.name for module in pkgutil.iter_modules(bodycheck.adapters.__path__) if module.ispkg)


@cache
def _own_sources() -> tuple[Path, ...]:
    """Return the source files in the folder of this file and in its subfolders."""
    return tuple(sorted(Path(bodycheck.adapters.__path__[0]).resolve().rglob("*.py")))


def _points(group: str, name: str | None = None) -> tuple[EntryPoint, ...]:
    """Return the entry points of a group on the present `sys.path`; if `name` is given, only the entry points of this name."""
    return tuple(point for point in _all_points(tuple(sys.path)) if point.group == group and name in (None, point.name))


@cache
def _all_points(path: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    """Return the entry points that concern engines. The metadata of all packages are read once for each path."""
    return (*entry_points(group=ENGINE_GROUP), *entry_points(group=DISTRIBUTION_GROUP))


def _check_known(name: str) -> None:
    if name not in names():
        known_names = names()
        raise EngineMissing(
            f"there is no engine {name!r}; there are: {', '.join(known_names)}{did_you_mean(name, known_names)}"
        )


def _files_of(module: str) -> list[Path]:
    """Return the source files of a top-level module or package, without importing it."""
    spec = find_spec(module)
    if spec is None or spec.origin is None:
        return []
    files = [file for folder in spec.submodule_search_locations or () for file in sorted(Path(folder).rglob("*.py"))]
    return files or [Path(spec.origin)]


#: All properties that may differ between scenes that an engine steps together.
VARIED = frozenset(get_args(Varied))

#: The rule that `is_name` checks, in words.
RULE = f"text of 1 to {MAX_NAME_LENGTH} printable characters that begins with a letter or digit"


def fault_of(engine: object) -> str | None:
    """Return the fault of an engine's record, as a clause that does not name the engine; None if the record is complete."""
    if not isinstance(engine, Engine):
        return f"its record is of the type {type(engine).__name__}, not Engine"
    for key in ("name", "distribution", "version"):
        if not _is_name(getattr(engine, key)):
            return f"its {key} is {_shown(getattr(engine, key))}, not {RULE}"
    if not isinstance(engine.integrators, tuple) or not all(
        isinstance(integrator, Integrator) for integrator in engine.integrators
    ):
        return f"its integrators are {_shown(engine.integrators)}, not a tuple of Integrator"
    if type(engine.models) is not frozenset or not all(type(name) is str for name in engine.models):
        return f"its models are {_shown(engine.models)}, not a frozenset of names"
    if type(engine.batch) is not int or engine.batch < 1:
        return f"its batch is {_shown(engine.batch)}, not an integer of at least 1"
    if type(engine.varies) is not frozenset or not engine.varies <= VARIED:
        return f"its varies is {_shown(engine.varies)}, not a frozenset of {', '.join(sorted(VARIED))}"
    return next(
        (fault for integrator in engine.integrators if (fault := _fault_of_integrator(integrator)) is not None),
        _fault_of_variants(engine) or _fault_of_roles(engine),
    )


def _fault_of_integrator(integrator: Integrator) -> str | None:
    if not _is_name(integrator.name):
        return f"an integrator is named {_shown(integrator.name)}, not by {RULE}"
    if integrator.name in ALIASES:
        return f"an integrator is named {integrator.name}, which stands for the method that `roles` names"
    if not set(integrator.kinds) <= KINDS:
        return (
            f"its integrator {integrator.name} is for the kinds {_shown(integrator.kinds)}; allowed: {', '.join(sorted(KINDS))}"
        )
    if not all(_is_name(key) and isinstance(option, Option) for key, option in integrator.options.items()):
        options = _shown(integrator.options)
        return f"its integrator {integrator.name} has the options {options}, not values of the type Option by their names"
    if type(integrator.demonstrates) is not str or not integrator.demonstrates.isprintable():
        return (
            f"its integrator {integrator.name} demonstrates {_shown(integrator.demonstrates)}, not text of printable characters"
        )
    return None


def _fault_of_variants(engine: Engine) -> str | None:
    for kind, spellings in engine.variants.items():
        if kind not in KINDS or not all(_is_name(spelling) for spelling in spellings):
            return f"its variants for {_shown(kind)} are {_shown(spellings)}, not spellings of methods"
    return None


def _fault_of_roles(engine: Engine) -> str | None:
    for role, usages in engine.roles.items():
        if role not in ALIASES:
            return f"its roles have the key {_shown(role)}; allowed: {', '.join(ALIASES)}"
        for kind, usage in usages.items():
            if kind not in KINDS or not isinstance(usage, Usage):
                return f"its {role} method for {_shown(kind)} is {_shown(usage)}, not of the type Usage for a kind of scene"
            if (fault := _fault_of_usage(engine, kind, usage)) is not None:
                return f"its {role} method for {kind} {fault}"
    return None


def _fault_of_usage(engine: Engine, kind: Kind, usage: Usage) -> str | None:
    try:
        method = Method.parse(usage.method, 0.0)
        offers.check(engine, method)
    except BadInput as error:
        return f"is {_shown(usage.method)}: {error}"
    integrator = offers.integrator_of(engine, method)
    refused = integrator is not None and kind in integrator.refuses  # it is planned, and its runs say why there are none
    if not refused and (lacking := offers.not_offered_for(engine, kind, method)) is not None:
        return f"is {method.name}, but {engine.name} {lacking}"
    if usage.timestep is None and method.accuracy is None:
        return f"is {method.name} without a time step, which only a method with error control may lack"
    if usage.timestep is not None and not 0 < usage.timestep < math.inf:
        return f"has the time step {_shown(usage.timestep)}, not a positive number"
    return (
        None if usage.page.startswith("https://") else f"cites {_shown(usage.page)}, not an address that begins with https://"
    )


def _is_name(value: object) -> bool:
    return type(value) is str and is_name(value)


def _shown(value: object) -> str:
    """Return a short description of a value in printable characters."""
    text = ascii(value)
    return text if len(text) <= 80 else f"{text[:80]}…"
