"""Environments: releases of engines, each installed apart, in which bodycheck runs as it runs here.

An environment holds an engine's package and what that depends on. All else, bodycheck itself first of all, it has from the
running interpreter, so that the same code runs in each and nothing of it goes stale. They are kept in the user's cache folder,
or in that which the environment variable BODYCHECK_CACHE names, apart for each interpreter and what of it they must fit.

One is made under another name and put in its place whole, as the last act, by one process at a time. What an installation that
was killed has left, the next one removes; an environment that is not sound is made anew.
"""

import contextlib
import json
import os
import shutil
import sys
import sysconfig
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib import metadata
from pathlib import Path
from subprocess import CompletedProcess
from typing import TYPE_CHECKING

from packaging.version import InvalidVersion, Version
from platformdirs import user_cache_path

from bodycheck.adapters import registry
from bodycheck.environments import filling as making
from bodycheck.environments import installation
from bodycheck.environments.filling import Release
from bodycheck.environments.installation import InstallationFailed, NotOnOffer
from bodycheck.running import pool
from bodycheck.running.outcome import Crashed, TimedOut

if TYPE_CHECKING:  # what asks releases starts processes, which need no tables
    from bodycheck.running.campaign import Advance

if sys.platform != "win32":
    import fcntl

CACHE_VARIABLE = "BODYCHECK_CACHE"

#: The file that only a finished environment has.
MARKER = "bodycheck.json"

#: Bytes that an installation may take: more than there are.
AMPLE = 1 << 40

#: Between the name of an environment and what tells those apart that are being made.
UNFINISHED = ".unfinished-"


class Unobtainable(Exception):
    """A release cannot be had or run here; the text says which, and what failed."""


@dataclass(frozen=True)
class Environment:
    """A release of an engine that can be run. python: its interpreter."""

    engine: str
    version: str
    python: Path


def releases(engine: str) -> tuple[str, ...]:
    """All releases of an engine's package that the configured index has for this Python, ascending; no pre-releases.

    Raises `Unobtainable`, also where there is no index to ask.
    """
    try:
        listed = [Version(text) for text in installation.versions(_distribution(engine))]
    except InstallationFailed as error:
        raise Unobtainable(f"the releases of {engine} cannot be listed: {error}") from error
    return tuple(str(version) for version in sorted(listed) if not version.is_prerelease)


def obtain(engine: str, version: str) -> Environment:
    """The environment of a release, from the cache or made now. Raises `Unobtainable`."""
    release = _release(engine, version)
    folder = _folder(release)
    with _alone_with(folder):
        _clear_leftovers(folder)
        if not ((folder / MARKER).is_file() and making.is_sound(folder, release)):
            _remove(folder)
            _make(folder, release)
    return Environment(engine, release.version, installation.interpreter(folder))


def obtain_all(engine: str, versions: Sequence[str], jobs: int, progress: "Advance") -> dict[str, Environment | Unobtainable]:
    """The environments of releases, made in `jobs` processes, or why there is none; progress is told of each."""
    tasks = [(engine, version) for version in dict.fromkeys(versions)]
    limit = len(making.ATTEMPTS) * installation.TIME_LIMIT
    found: dict[str, Environment | Unobtainable] = {}
    with closing(pool.call_all(_try_to_obtain, tasks, jobs, limit, memory=AMPLE)) as answers:
        for (_, version), result in answers:
            match result:
                case Crashed() | TimedOut():
                    found[version] = Unobtainable(f"{engine} {version}: {result.reason}")
                case _:
                    found[version] = result
            progress(f"{engine} {version}")
    return {version: found[version] for _, version in tasks}


def cached(engine: str) -> tuple[str, ...]:
    """The releases of an engine whose environments are there, ascending. Raises `Unobtainable` for one that there is not."""
    _distribution(engine)
    there = [marker.parent.parent.name for marker in (_home() / engine).glob(f"*/{_fit()}/{MARKER}")]
    return tuple(map(str, sorted(map(Version, there))))


def kept(engine: str) -> dict[str, Environment]:
    """The same environments by version; whether they are sound, `obtain` sees. Raises as above."""
    folders = {version: _folder(_release(engine, version)) for version in cached(engine)}
    return {version: Environment(engine, version, installation.interpreter(folder)) for version, folder in folders.items()}


def size(environment: Environment) -> int:
    """Bytes that an environment takes on the disk; files that uv shares with its own cache count here too."""
    folder = _folder(_release(environment.engine, environment.version))
    return sum(file.lstat().st_blocks * 512 for file in folder.rglob("*"))


def remove(engine: str, versions: Sequence[str]) -> tuple[str, ...]:
    """Delete the environments of releases, those for other interpreters too; the versions of which there was one."""
    removed = []
    for version in versions:
        places = _folder(_release(engine, version)).parent
        for folder in sorted(path.parent for path in places.glob(f"*/{MARKER}")):
            with _alone_with(folder):
                _clear_leftovers(folder)
                _remove(folder)
            removed.append(version)
    return tuple(dict.fromkeys(removed))


def run(
    environment: Environment, module: str, arguments: Sequence[str], stdin: str | None, timeout: float
) -> CompletedProcess[str]:
    """`python -m module` in an environment, with at most `pool.MEMORY` bytes; it ends with this process or after `timeout` s.

    Raises `subprocess.TimeoutExpired`, and `Unobtainable` where the environment has gone.
    """
    try:
        return making.call(environment.python, ["-m", module, *arguments], stdin, timeout)
    except OSError as error:
        raise Unobtainable(f"{environment.engine} {environment.version} has gone: {error}") from error


def cache_folder() -> Path:
    """Where bodycheck keeps what it can make again."""
    chosen = os.environ.get(CACHE_VARIABLE)
    return Path(chosen).absolute() if chosen else user_cache_path("bodycheck")


def _try_to_obtain(task: tuple[str, str]) -> Environment | Unobtainable:
    try:
        return obtain(*task)
    except Unobtainable as error:
        return error


def _make(folder: Path, release: Release) -> None:
    """Install a release apart and, only when all is well, put it in its place. Raises `Unobtainable`."""
    failures: list[str] = []
    usable: Path | None = None
    with contextlib.ExitStack() as kept:
        for attempt in making.ATTEMPTS:
            made = kept.enter_context(_temporary(folder))
            try:
                faultless = making.fill(made, release, attempt)
            except InstallationFailed as error:
                failures.append(str(error))
                if isinstance(error, NotOnOffer):
                    break
                continue
            if faultless:
                usable = made
                break
            usable = usable or made  # if no attempt is without faults, it is the engine that has them, for a study to tell
        if usable is None:
            raise Unobtainable(f"{release.engine} {release.version} cannot be had here: {failures[0]}")
        _finish(usable, folder, release)


def _finish(made: Path, folder: Path, release: Release) -> None:
    """Write an environment to the disk for good, and put it in its place at one stroke."""
    if sys.platform != "win32":
        os.sync()
    with (made / MARKER).open("w", encoding="utf-8") as marker:
        json.dump({"engine": release.engine, "version": release.version}, marker)
        marker.flush()
        os.fsync(marker.fileno())
    made.rename(folder)


def _distribution(engine: str) -> str:
    try:
        return registry.distribution(engine)
    except registry.EngineMissing as error:
        raise Unobtainable(str(error)) from error


def _release(engine: str, version: str) -> Release:
    """Raises `Unobtainable` for what is no version by PEP 440: a version is a stranger's word, and becomes a folder's name."""
    distribution = _distribution(engine)
    try:
        return Release(engine, distribution, str(Version(version)))
    except InvalidVersion as error:
        raise Unobtainable(f"{version!r} is no version of {engine}: it must be one by PEP 440, as in 3.1.6") from error


def _home() -> Path:
    return cache_folder() / "environments"


def _folder(release: Release) -> Path:
    """Where the environment of a release is, finished or not."""
    return _home() / release.engine / release.version / _fit()


@cache
def _fit() -> str:
    """A name for the running interpreter and the packages of it that an environment must fit."""
    versions = [f"{package} {metadata.version(package)}" for package in ("numpy", *making.COMPILED)]
    fits = repr((sys.prefix, making.site_folders(), versions))
    abi = sysconfig.get_config_var("SOABI") or f"{sys.implementation.cache_tag}-{sysconfig.get_platform()}"
    return f"{abi}-{sha256(fits.encode()).hexdigest()[:12]}"


@contextlib.contextmanager
def _alone_with(folder: Path) -> Iterator[None]:
    """Waits until no other process works on an environment and keeps others from it, until this one ends, however it does."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with folder.with_name(f"{folder.name}.lock").open("a") as lock:
        if sys.platform != "win32":
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@contextlib.contextmanager
def _temporary(folder: Path) -> Iterator[Path]:
    """A folder beside another, that is gone afterwards unless it has been moved."""
    made = Path(tempfile.mkdtemp(prefix=f"{folder.name}{UNFINISHED}", dir=folder.parent))
    try:
        yield made
    finally:
        shutil.rmtree(made, ignore_errors=True)


def _clear_leftovers(folder: Path) -> None:
    """Remove what installations that were killed have left. To be called by whoever is alone with the folder."""
    for left in folder.parent.glob(f"{folder.name}{UNFINISHED}*"):
        shutil.rmtree(left, ignore_errors=True)


def _remove(folder: Path) -> None:
    """The marker first, so that half an environment is never taken for one."""
    if folder.exists():
        (folder / MARKER).unlink(missing_ok=True)
        shutil.rmtree(folder)
