"""The places and the records of engines, without importing an engine into this process.

An engine may end its process, hang or crash when it is imported, or change the state with which others compute. It is therefore
imported only in worker processes, which use the interpreter in which it is installed: together with bodycheck, or in a separate
environment. The record of an engine, its description, is requested there once and kept in the cache folder, until the engine,
its adapter or the packages installed with it change. Failures are not kept.
"""

import contextlib
import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from pydantic import TypeAdapter

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine
from bodycheck.adapters.engine_name import EngineName
from bodycheck.environments import contents, environments, user_cache
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.errors import BadInput
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.processes.interpreter import HERE, Interpreter
from bodycheck.running.tasks import import_engine, leave_out_sympy

#: The folder of records in the cache.
RECORDS = "records"

#: Time limit (s) for the import and the record of one engine. Some engines compile code when they are imported.
TIME_LIMIT_S = 120.0


@dataclass(frozen=True)
class Fault:
    """The reason why an engine cannot be used.

    Parameters
    ----------
    reason
        A sentence.
    broken
        Whether the engine is installed but fails; False if it is not installed or unknown.
    """

    reason: str
    broken: bool


#: Records that are already known, by the name of the engine and the digest of everything that the record depends on.
_known: dict[tuple[str, str], Engine | Fault] = {}


def describe(names: Sequence[str]) -> tuple[dict[str, Engine], dict[str, Fault]]:
    """Return the records of usable engines, and the faults of all other engines, by their requested names.

    Unknown records are requested in worker processes, where an engine that crashes or hangs harms no other engine.
    """
    answers_by_name: dict[str, Engine | Fault] = {}
    keys: dict[str, str] = {}
    packages = cache(_packages)  # engines that are installed together share them
    for name in dict.fromkeys(names):
        try:
            keys[name] = _depends(name, environment := _place(name), packages(environment))
        except (registry.EngineMissing, Unobtainable) as error:
            answers_by_name[name] = Fault(str(error), broken=False)
    for name, key in keys.items():
        if (known := _known.get((name, key)) or _kept(name, key)) is not None:
            answers_by_name[name] = _known[name, key] = known
    left = [name for name in keys if name not in answers_by_name]
    with pool.Workers(_ask, os.cpu_count() or 1, TIME_LIMIT_S, group=str, home=home) as workers:
        for name, answer in workers.map(left):
            match answer:
                case Crashed() | TimedOut():
                    answers_by_name[name] = Fault(f"{name} fails when it is imported: {answer.reason}", broken=True)
                case Fault():
                    answers_by_name[name] = answer
                case _:
                    answers_by_name[name] = _records().validate_json(answer)
                    _keep(name, keys[name], answer)
            _known[name, keys[name]] = answers_by_name[name]
    in_order = {name: answers_by_name[name] for name in dict.fromkeys(names)}
    return (
        {name: record for name, record in in_order.items() if isinstance(record, Engine)},
        {name: fault for name, fault in in_order.items() if isinstance(fault, Fault)},
    )


def forget(names: Sequence[str]) -> None:
    """Remove the records of engines from the cache, so that they are requested anew."""
    for name in names:
        user_cache.forget(_entry(name))


def faults(names: Sequence[str]) -> dict[str, Fault]:
    """Return the reasons why some of the engines cannot be used, by their requested names."""
    return describe(names)[1]


def record(name: str) -> Engine:
    """Return the record of an engine. Raises `EngineMissing` if it cannot be used."""
    records, missing = describe([name])
    if name in missing:
        raise registry.EngineMissing(missing[name].reason)
    return records[name]


def home(name: str | None) -> pool.Home:
    """Return the home of an engine's processes, which import it before their first call; None stands for the truths.

    If an engine is not installed any more, because its environment was removed meanwhile, its calls fail in a process of this
    interpreter.
    """
    if name is None:
        return pool.Home(prepare=leave_out_sympy, watched=False)
    try:
        environment = _place(name)
    except (registry.EngineMissing, Unobtainable):
        return pool.Home(HERE, import_engine, TIME_LIMIT_S)
    source = registry.known_installation(EngineName.parse(name).adapter)
    if environment is None:
        variables = source.variables_in(None) if source is not None else ()
        return pool.Home(Interpreter(HERE.python, variables, apart=False), import_engine, TIME_LIMIT_S)
    return pool.Home(Interpreter(environment.python, environments.variables(environment)), import_engine, TIME_LIMIT_S)


def place(name: str) -> tuple[str, str]:
    """Return the place of an engine in words, "here" or "own environment", and the day from which its environment is.

    The day of "here" is empty. Raises `EngineMissing` and `Unobtainable`.
    """
    environment = _place(name)
    return ("here", "") if environment is None else ("own environment", f"{environments.made(environment):%Y-%m-%d}")


def locks(names: Iterable[str]) -> dict[str, dict[str, str]]:
    """Return the packages and hashes of the environments in which engines are installed, by the names of these engines.

    Engines that are installed together with bodycheck, and engines whose environments cannot be used, are left out.
    """
    packages: dict[str, dict[str, str]] = {}
    for name in names:
        with contextlib.suppress(registry.EngineMissing, Unobtainable):
            if (environment := _place(name)) is not None:
                packages[name] = environments.lock(environment)
    return packages


def _place(name: str) -> Environment | None:
    """Return the environment in which an engine is installed; None if it is installed together with bodycheck.

    Raises `EngineMissing` for an engine that is unknown or not installed, and `Unobtainable` for an environment that another
    user can change.
    """
    try:
        asked = EngineName.parse(name)
    except BadInput as error:
        raise registry.EngineMissing(str(error)) from error
    source = registry.known_installation(asked.adapter)
    if source is None:
        return None  # an engine without a known package is installed together with bodycheck or not at all
    here = registry.installed(asked.adapter)
    if here is not None and asked.version in (None, here):
        return None
    if (environment := environments.find(asked.adapter, asked.version)) is not None:
        return environment
    package = source.distribution if asked.version is None else f"{source.distribution} {asked.version}"
    raise registry.EngineMissing(
        f"{asked} is not installed: there is no package {package}; install it by: bodycheck engines add {asked}"
    )


def _ask(name: str) -> str | Fault:
    """Return the record of an engine as JSON, so that the reader of the record imports nothing of the engine."""
    try:
        return _records().dump_json(registry.load(name).engine).decode("utf-8")
    except registry.EngineMissing as error:
        return Fault(str(error), isinstance(error, registry.EngineBroken))


@cache
def _records() -> TypeAdapter[Engine]:
    return TypeAdapter(Engine)


def _packages(environment: Environment | None) -> str:
    """Return a digest of what is installed in an environment; None stands for the folders of this process."""
    return contents.of_distributions(map(Path, sys.path) if environment is None else environments.package_folders(environment))


def _depends(name: str, environment: Environment | None, packages: str) -> str:
    """Return a digest of everything that the record of an engine depends on, apart from data that its own code reads."""
    adapter = contents.of_files(registry.sources(EngineName.parse(name).adapter))
    decides = (version("bodycheck"), sys.version, environment, packages, adapter)
    return sha256(repr(decides).encode()).hexdigest()


def _entry(name: str) -> str:
    """Return the name in the cache of the record of an engine."""
    return f"{RECORDS}/{sha256(name.encode()).hexdigest()[:16]}.json"


def _kept(name: str, key: str) -> Engine | None:
    """Return the record in the cache; None if there is none with this key."""
    entry = user_cache.kept(_entry(name))
    kept_key, _, record = entry.text.partition("\n") if entry is not None else ("", "", "")
    try:
        return _records().validate_json(record) if kept_key == key else None
    except ValueError:  # another development version of bodycheck has kept it
        return None


def _keep(name: str, key: str, record: str) -> None:
    user_cache.keep(_entry(name), f"{key}\n{record}")
