"""The places and the records of engines, without importing one into this process.

An engine may end its process, hang or crash when it is imported, or change what others compute with. It is therefore
imported in worker processes alone, which live where it is installed: beside bodycheck, or in an environment of its own. What an
engine is, its record, is asked there once and kept in the cache folder, until the engine, its adapter or its environment
changes.
"""

import contextlib
import json
import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine
from bodycheck.adapters.engine_name import EngineName
from bodycheck.environments import environments, privacy, user_cache
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.errors import BadInput
from bodycheck.files import writing
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.processes.interpreter import HERE, Interpreter
from bodycheck.running.tasks import import_engine, leave_out_sympy

#: Time limit for the import and the record of one engine. Some compile code when they are imported.
TIME_LIMIT_S = 120.0


@dataclass(frozen=True)
class Fault:
    """Why an engine cannot be used.

    Parameters
    ----------
    reason
        A sentence.
    broken
        Whether the engine is there but fails; False if it is not installed or unknown.
    """

    reason: str
    broken: bool


#: What was asked before, by the name of the engine and what its record depends on.
_known: dict[tuple[str, str], Engine | Fault] = {}


def describe(names: Sequence[str]) -> tuple[dict[str, Engine], dict[str, Fault]]:
    """Return the records of the engines that can be used, and why the others cannot be used, by name as asked for.

    Engines whose records are not known are asked in worker processes, where one that crashes or hangs harms no other.
    """
    answers_by_name: dict[str, Engine | Fault] = {}
    keys: dict[str, str] = {}
    for name in dict.fromkeys(names):
        try:
            keys[name] = _depends(name, _place(name))
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


def faults(names: Sequence[str]) -> dict[str, Fault]:
    """Return why some of the engines cannot be used, by name as asked for."""
    return describe(names)[1]


def record(name: str) -> Engine:
    """Return the record of an engine. Raises `EngineMissing` if it cannot be used."""
    records, missing = describe([name])
    if name in missing:
        raise registry.EngineMissing(missing[name].reason)
    return records[name]


def home(name: str | None) -> pool.Home:
    """Return where the processes of an engine live, which import it before their first call; None stands for the truths.

    The calls of an engine that is nowhere installed, because its environment was removed meanwhile, fail in a process here.
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


def place(name: str) -> str:
    """Return in words where an engine is installed, such as "here". Raises `EngineMissing` and `Unobtainable`."""
    environment = _place(name)
    return "here" if environment is None else "own environment"


def locks(names: Iterable[str]) -> dict[str, dict[str, str]]:
    """Return the packages and hashes of the environments in which engines are installed, by the names of these engines.

    Engines that are installed beside bodycheck have none, and those whose environments cannot be used.
    """
    packages: dict[str, dict[str, str]] = {}
    for name in names:
        with contextlib.suppress(registry.EngineMissing, Unobtainable):
            if (environment := _place(name)) is not None:
                packages[name] = environments.lock(environment)
    return packages


def _place(name: str) -> Environment | None:
    """Return the environment in which an engine is installed; None if it is installed beside bodycheck.

    Raises `EngineMissing` for an unknown engine and one that is nowhere installed, and `Unobtainable` for an environment that
    another user can change.
    """
    try:
        asked = EngineName.parse(name)
    except BadInput as error:
        raise registry.EngineMissing(str(error)) from error
    source = registry.known_installation(asked.adapter)
    if source is None:
        return None  # an engine that does not say what it is installed from is installed beside bodycheck or nowhere
    here = registry.installed(asked.adapter)
    if here is not None and asked.version in (None, here):
        return None
    if (environment := environments.find(asked.adapter, asked.version)) is not None:
        return environment
    wanted = f" --version {asked.version}" if asked.version else ""
    raise registry.EngineMissing(
        f"{asked} is not installed: there is no package {source.distribution}{f' {asked.version}' if asked.version else ''}; "
        f"install it by: bodycheck engines add {asked.adapter}{wanted}"
    )


def _ask(name: str) -> str | Fault:
    """Return the record of an engine as JSON, so that nothing of the engine is imported where it is read."""
    try:
        return _records().dump_json(registry.load(name).engine).decode("utf-8")
    except registry.EngineMissing as error:
        return Fault(str(error), isinstance(error, registry.EngineBroken))


@cache
def _records() -> TypeAdapter[Engine]:
    return TypeAdapter(Engine)


def _depends(name: str, environment: Environment | None) -> str:
    """Return a digest of everything that the record of an engine depends on, apart from what its own code reads."""
    folders = map(Path, sys.path) if environment is None else environments.package_folders(environment)
    files = [*registry.sources(EngineName.parse(name).adapter), *(folder for folder in folders if folder.is_dir())]
    decides = (version("bodycheck"), sys.version, environment, sorted((str(file), file.stat().st_mtime_ns) for file in files))
    return sha256(repr(decides).encode()).hexdigest()


def _file(name: str) -> Path:
    return user_cache.folder() / "records" / f"{sha256(name.encode()).hexdigest()[:16]}.json"


def _kept(name: str, key: str) -> Engine | None:
    """Return the record that is kept; None if there is none, if it is outdated, or if another user may have written it."""
    path = _file(name)
    try:
        if privacy.open_to_others(path) is not None:
            return None
        kept = json.loads(path.read_text("utf-8"))
        return _records().validate_json(kept["record"]) if kept["key"] == key else None
    except (OSError, ValueError, KeyError, TypeError, ValidationError):
        return None


def _keep(name: str, key: str, record: str) -> None:
    """Keep the record of an engine, if the cache folder can be written to."""
    path = _file(name)
    with contextlib.suppress(OSError, writing.NotWritten):
        privacy.make(path.parent)
        writing.write(path, json.dumps({"key": key, "record": record}).encode("utf-8"))
