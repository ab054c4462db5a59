"""Obtain, list, measure, run and remove the environments in the cache folder.

The cache folder is the user's, or the folder in the environment variable BODYCHECK_CACHE. It contains a folder for each release
and each combination of interpreter and packages that the environment must be compatible with.

An environment is made under a temporary name, by one process at a time, and renamed as the last step, so that it is either
complete or does not exist. The next installation removes the remains of an installation that was killed. A damaged environment
stays until a new one can replace it. Nothing in the folder is used or run if another user can change it or one of its parent
folders.
"""

import contextlib
import json
import os
import shutil
import sys
import sysconfig
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from hashlib import sha256
from importlib import metadata
from pathlib import Path
from subprocess import CompletedProcess

from filelock import BaseFileLock, FileLock
from packaging.version import InvalidVersion, Version

from bodycheck.adapters import registry
from bodycheck.adapters.installation import Installation
from bodycheck.environments import installation, making, privacy, user_cache
from bodycheck.environments.installation import InstallationFailed, NotOnOffer
from bodycheck.environments.making import Release

#: The name of the file that only a finished environment has.
MARKER = "bodycheck.json"

#: In the name of a folder in which an environment is being made, this follows the name of the environment.
UNFINISHED = ".unfinished-"


class Unobtainable(Exception):
    """A release cannot be installed or run here; the text says which release, and what failed."""


@dataclass(frozen=True)
class Environment:
    """The environment of a release.

    Attributes
    ----------
    engine
        The name of the engine in bodycheck.
    version
        The version of the release.
    python
        The interpreter of the environment.
    """

    engine: str
    version: str
    python: Path


def releases(engine: str) -> tuple[str, ...]:
    """Return all releases of an engine that the package sources have for this Python, ascending, without pre-releases.

    Raises `Unobtainable` if they cannot be listed.
    """
    try:
        listed = [Version(text) for text in installation.versions(_installation(engine).distribution)]
    except InstallationFailed as error:
        raise Unobtainable(f"the releases of {engine} cannot be listed: {error}") from error
    return tuple(str(version) for version in sorted(listed) if not version.is_prerelease)


def newest(engine: str) -> str:
    """Return the newest release of an engine in the package sources for this Python. Raises `Unobtainable` without one."""
    versions = releases(engine)
    if not versions:
        raise Unobtainable(f"there is no release of {engine} for this Python")
    return versions[-1]


def obtain(engine: str, version: str) -> Environment:
    """Return the environment of a release; make it if it does not exist. Raises `Unobtainable` if that fails."""
    release = _release(engine, version)
    folder = _folder(release)
    with _lock(folder):
        _remove_unfinished(folder)
        if not ((folder / MARKER).is_file() and making.is_intact(folder, release)):
            _make(folder, release)
    return Environment(engine, release.version, installation.interpreter(folder))


def cached(engine: str) -> tuple[str, ...]:
    """Return the versions of an engine that have an environment, ascending. Raises `Unobtainable` for an unknown engine.

    Folders whose names are not versions were not made by bodycheck, and are left out.
    """
    source = _installation(engine)
    versions = [marker.parent.parent.name for marker in (_home() / source.distribution).glob(f"*/{_fit(source)}/{MARKER}")]
    return tuple(map(str, sorted(version for name in versions if str(version := _version(name)) == name and version)))


def kept(engine: str) -> dict[str, Environment]:
    """Return the environments of an engine by version, ascending. Raises `Unobtainable` for an unknown engine.

    Only `obtain` checks whether they are intact.
    """
    folders = {version: _folder(_release(engine, version)) for version in cached(engine)}
    return {version: Environment(engine, version, installation.interpreter(folder)) for version, folder in folders.items()}


def find(engine: str, version: str | None = None) -> Environment | None:
    """Return the environment of a release, or of the newest release that has one; None if there is none.

    Raises `Unobtainable` for an unknown engine, for an environment without an interpreter, and if another user can change it.
    """
    versions = kept(engine)
    environment = versions.get(version) if version is not None else next(reversed(versions.values()), None)
    if environment is not None:
        name = f"{engine}@{environment.version}"
        try:
            _check_private(environment.python.parent)
            environment.python.stat()
        except OSError as error:
            raise Unobtainable(
                f"{name} has a damaged environment without an interpreter; make it anew by: bodycheck engines add {name}"
            ) from error
    return environment


def variables(environment: Environment) -> tuple[tuple[str, str], ...]:
    """Return the environment variables that processes in an environment need in addition to those of this process."""
    source = _installation(environment.engine)
    return (*making.path_variables(), *source.variables_in(str(environment.python.parents[1])))


def package_folders(environment: Environment) -> list[Path]:
    """Return the folders of the packages that are installed in an environment itself."""
    return making.package_folders(environment.python.parents[1])


def lock(environment: Environment) -> dict[str, str]:
    """Return the packages of an environment, each `NAME==VERSION`, with the SHA-256 of its list of files and hashes."""
    records = sorted(record for folder in package_folders(environment) for record in folder.glob("*.dist-info/RECORD"))
    return {
        "==".join(record.parent.name.removesuffix(".dist-info").rsplit("-", 1)): sha256(record.read_bytes()).hexdigest()
        for record in records
    }


def made(environment: Environment) -> datetime:
    """Return the time at which an environment was finished. Raises `OSError` if it is no longer there."""
    return datetime.fromtimestamp((environment.python.parents[1] / MARKER).stat().st_mtime, UTC)


def size(environment: Environment) -> int:
    """Return the disk space in bytes of an environment, including the files that it shares with uv's cache."""
    folder = _folder(_release(environment.engine, environment.version))
    return sum(_on_disk(file.lstat()) for file in folder.rglob("*"))


def _on_disk(status: os.stat_result) -> int:
    """Return the bytes that a file takes on the disk; its size on Windows, which does not tell them."""
    if sys.platform != "win32":
        return status.st_blocks * 512
    return status.st_size


def remove(engine: str, versions: Sequence[str]) -> tuple[str, ...]:
    """Delete the environments of releases, for all interpreters, and return the versions that had one.

    Raises `Unobtainable` for an unknown engine, and for a text that is not a version.
    """
    removed = []
    for version in versions:
        folder_of_version = _folder(_release(engine, version)).parent
        for folder in sorted(path.parent for path in folder_of_version.glob(f"*/{MARKER}")):
            with _lock(folder):
                _remove_unfinished(folder)
                _remove(folder)
            removed.append(version)
    return tuple(dict.fromkeys(removed))


def run(
    environment: Environment, module: str, arguments: Sequence[str], stdin: str | None, timeout: float
) -> CompletedProcess[str]:
    """Run `python -m module` in an environment, with limited memory, until this process ends at the latest.

    Parameters
    ----------
    environment
        The environment.
    module
        The module to run.
    arguments
        The arguments of the module.
    stdin
        The text of its standard input; None for an empty one.
    timeout
        Seconds after which it is killed.

    Raises
    ------
    subprocess.TimeoutExpired
        It took longer than `timeout`.
    Unobtainable
        The environment is no longer there, or another user can change it.
    """
    try:
        _check_private(environment.python.parent)
        return making.run(environment.python, ["-m", module, *arguments], stdin, timeout, variables(environment))
    except OSError as error:
        raise Unobtainable(f"{environment.engine}@{environment.version} is no longer there: {error}") from error


def _make(folder: Path, release: Release) -> None:
    """Make the environment of a release in the place of any earlier one. Raises `Unobtainable` if no attempt succeeds."""
    failures: list[str] = []
    usable: Path | None = None
    with contextlib.ExitStack() as stack:
        for attempt in making.ATTEMPTS:
            temporary = tempfile.TemporaryDirectory(
                prefix=f"{folder.name}{UNFINISHED}", dir=folder.parent, ignore_cleanup_errors=True
            )
            temporary_folder = Path(stack.enter_context(temporary))
            try:
                passes = making.make(temporary_folder, release, attempt)
            except InstallationFailed as error:
                failures.append(str(error))
                if isinstance(error, NotOnOffer):
                    break
                continue
            if passes:
                usable = temporary_folder
                break
            # If the engine fails checks after every attempt, the fault is in the release itself, which a study is to show.
            usable = usable or temporary_folder
        if usable is None:
            raise Unobtainable(f"{release.engine}@{release.version} is not available here: {failures[0]}")
        _finish(usable, folder, release)


def _finish(temporary_folder: Path, folder: Path, release: Release) -> None:
    """Make sure that all files of a new environment are on the disk, and give it its final name, replacing an earlier one."""
    if sys.platform != "win32":
        os.sync()
    with (temporary_folder / MARKER).open("w", encoding="utf-8") as marker:
        json.dump({"engine": release.engine, "version": release.version}, marker)
        marker.flush()
        os.fsync(marker.fileno())
    _remove(folder)
    temporary_folder.rename(folder)


def _installation(engine: str) -> Installation:
    """Return the description of an engine's installation. Raises `Unobtainable` for an unknown engine."""
    try:
        return registry.installation(engine)
    except registry.EngineMissing as error:
        raise Unobtainable(str(error)) from error


def _release(engine: str, version: str) -> Release:
    """Return a release. Raises `Unobtainable` unless the version, which becomes a folder's name, is valid by PEP 440."""
    source = _installation(engine)
    try:
        return Release(engine, source, str(Version(version)))
    except InvalidVersion as error:
        raise Unobtainable(f"{version!r} is not a version of {engine}; a version looks like 3.1.6 (PEP 440)") from error


def _version(text: str) -> Version | None:
    """Return the version in a text; None if it is not a version by PEP 440."""
    try:
        return Version(text)
    except InvalidVersion:
        return None


def _check_private(folder: Path) -> None:
    """Raise `Unobtainable` if another user can change an existing folder of the cache, and `OSError` if it is missing."""
    if (open_folder := privacy.open_to_others(folder)) is not None:
        raise Unobtainable(user_cache.untrusted(folder, open_folder))


def _home() -> Path:
    return user_cache.folder() / "environments"


def _folder(release: Release) -> Path:
    """Return the folder of the environment of a release, whether or not it exists."""
    return _home() / release.installation.distribution / release.version / _fit(release.installation)


def _fit(source: Installation) -> str:
    """Return a name for the interpreter, its packages and the extras of an engine, with which an environment must agree."""
    fits = repr((sys.prefix, making.site_folders(), _versions(), source.extras, source.others))
    abi = sysconfig.get_config_var("SOABI") or f"{sys.implementation.cache_tag}-{sysconfig.get_platform()}"
    return f"{abi}-{sha256(fits.encode()).hexdigest()[:12]}"


@cache
def _versions() -> list[str]:
    """Return the versions of NumPy and of the packages compiled against it that engines are installed together with."""
    return [f"{package} {metadata.version(package)}" for package in ("numpy", *making.NUMPY_DEPENDENTS)]


def _lock(folder: Path) -> BaseFileLock:
    """Return the lock of an environment. A process holds it while it works on the environment, and loses it when it ends.

    Raises `Unobtainable` if the parent folder cannot be made, or another user can change the folder or a parent of it.
    """
    try:
        privacy.make(folder.parent)
        places = (installation.interpreter(folder).parent, folder, folder.parent)
        _check_private(next(existing for existing in places if existing.exists()))
    except OSError as error:
        raise Unobtainable(f"{folder.parent}: cannot be used as a folder: {error.strerror}") from error
    return FileLock(folder.with_name(f"{folder.name}.lock"))


def _remove_unfinished(folder: Path) -> None:
    """Remove the remains of installations that were killed. The caller must hold the lock."""
    for left in folder.parent.glob(f"{folder.name}{UNFINISHED}*"):
        shutil.rmtree(left, ignore_errors=True)


def _remove(folder: Path) -> None:
    """Remove an environment, its marker first, so that half an environment never counts as one."""
    if folder.is_symlink() or folder.is_file():
        folder.unlink()
    elif folder.exists():
        (folder / MARKER).unlink(missing_ok=True)
        shutil.rmtree(folder)
