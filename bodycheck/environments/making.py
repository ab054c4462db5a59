"""Make an environment in an empty folder: a release of an engine that can be imported together with bodycheck.

The environment contains the release and the packages that it depends on, which come first on `sys.path`. The packages of the
running interpreter follow, added by a .pth file that Python reads when it starts. Three kinds of conflict are handled here:

- A package that was compiled against NumPy 1 may fail with NumPy 2 although its metadata allow it.
- A dependency may by now have newer releases that are incompatible with the engine's release.
- With an old NumPy, the SciPy and PyArrow of the running interpreter may fail to import. The environment then gets the oldest
  releases of SciPy and PyArrow that bodycheck supports, which date from the time of NumPy 1.
"""

import os
import site
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from importlib import metadata
from pathlib import Path
from subprocess import CompletedProcess

from packaging.version import InvalidVersion, Version

from bodycheck.adapters.installation import Installation
from bodycheck.environments import installation, subprocesses
from bodycheck.environments.installation import InstallationFailed

#: Environment variables by name.
Variables = Sequence[tuple[str, str]]

#: The environment variable that names the folders, other than site-packages, from which the running interpreter imports.
PATH_VARIABLE = "BODYCHECK_PATH"

#: Dependencies of bodycheck that are compiled against NumPy, each with a module whose import shows whether the dependency works
#: with the installed NumPy.
NUMPY_DEPENDENTS = {"scipy": "scipy.integrate", "pyarrow": "pyarrow.parquet"}

#: With `Attempt.as_of_release`, packages uploaded up to this long after the release are used: wheels often come later.
UPLOAD_DELAY = timedelta(days=14)

#: Longest time in s that one inspection of an environment may take.
INSPECTION_LIMIT_S = 900.0

#: The .pth file that adds the packages of the running interpreter, and the paths that their own .pth files add. Python reads
#: such files in the order of their names. Because of the tilde, this file is read last, so that all folders of the environment
#: come first.
PATH_FILE = "~bodycheck.pth"
PATH_FILE_LINES = """\
import site; list(map(site.addsitedir, {folders!r}))
import os, sys; sys.path.extend(filter(None, os.environ.get({variable!r}, "").split(os.pathsep)))
"""

#: Code that checks that all files have the contents that they were installed with, and prints the version of a package.
VERSION_OF_INTACT_PACKAGE = """
import base64, csv, hashlib, importlib.metadata, os, sys, sysconfig
root = sysconfig.get_path("purelib")
for folder in os.listdir(root):
    if folder.endswith(".dist-info"):
        for name, check, size in csv.reader(open(os.path.join(root, folder, "RECORD"), encoding="utf-8", newline="")):
            kind, _, digest = check.partition("=")
            if digest:
                with open(os.path.join(root, name), "rb") as file:
                    now = base64.urlsafe_b64encode(hashlib.file_digest(file, kind).digest()).decode().rstrip("=")
                if now != digest:
                    sys.exit(f"{name} is not what was installed")
print(importlib.metadata.version(sys.argv[1]))
"""

#: Code that prints which packages do not work with the NumPy of the environment.
PACKAGES_THAT_FAIL = """
import importlib, sys, warnings
warnings.simplefilter("error", UserWarning)
for package, module in zip(sys.argv[1::2], sys.argv[2::2]):
    try:
        importlib.import_module(module)
    except Exception:
        print(package)
"""

#: Code that prints the number of checks of its adapter that an engine fails; its exit code is not 0 if the engine cannot be
#: imported.
NUMBER_OF_FAILED_CHECKS = """
import sys
from bodycheck.adapters import registry
try:
    registry.load(sys.argv[1])
except registry.EngineMissing as error:
    sys.exit(str(error))
from bodycheck.running import smoke
print(len(smoke.check(sys.argv[1])))
"""


@dataclass(frozen=True)
class Attempt:
    """A way to install a release; the next way is tried if the engine cannot be imported or fails a check of its adapter.

    Attributes
    ----------
    constraints
        Conditions on packages, in addition to the condition that NumPy is no newer than in the running interpreter.
    as_of_release
        Whether to install the dependencies that the index had when the release came out.
    """

    constraints: tuple[str, ...] = ()
    as_of_release: bool = False


ATTEMPTS = (Attempt(), Attempt(constraints=("numpy<2",)), Attempt(as_of_release=True))


@dataclass(frozen=True)
class Release:
    """A release of an engine.

    Attributes
    ----------
    engine
        The name of the engine in bodycheck, without a version.
    installation
        The description of the engine's installation.
    version
        The version, as PEP 440 normalises it.
    """

    engine: str
    installation: Installation
    version: str


def make(folder: Path, release: Release, attempt: Attempt) -> bool:
    """Make the environment of a release in an empty folder.

    Parameters
    ----------
    folder
        The empty folder.
    release
        The release to install.
    attempt
        The way in which it is installed.

    Returns
    -------
    bool
        Whether the engine passes all checks of its adapter.

    Raises
    ------
    InstallationFailed
        The release cannot be installed in this way, or the engine cannot be imported.
    """
    latest_upload = None
    if attempt.as_of_release:
        if (uploaded := installation.release_day(release.installation.distribution, release.version)) is None:
            raise InstallationFailed("the package sources do not say when it was released")
        latest_upload = uploaded + UPLOAD_DELAY
    numpy_here = metadata.version("numpy")
    installation.make(folder)
    _install(folder, release, [f"numpy<={numpy_here}", *attempt.constraints], latest_upload)
    python = installation.interpreter(folder)
    (packages,) = package_folders(folder)
    (packages / PATH_FILE).write_text(_path_lines(), "utf-8")
    numpy_there = output(python, "import importlib.metadata; print(importlib.metadata.version('numpy'))")
    if numpy_there != numpy_here:
        failing = output(python, PACKAGES_THAT_FAIL, *(word for pair in NUMPY_DEPENDENTS.items() for word in pair)).split()
        if failing:
            installation.install(folder, [_oldest(package) for package in failing], [f"numpy=={numpy_there}"])
    variables = release.installation.variables_in(str(folder))
    return output(python, NUMBER_OF_FAILED_CHECKS, release.engine, variables=variables).rpartition("\n")[2] == "0"


def _install(folder: Path, release: Release, constraints: Sequence[str], latest_upload: datetime | None) -> None:
    """Install a release and its dependencies. Raises `InstallationFailed`.

    uv links files from its cache into environments. A file that was changed in one environment is therefore changed in the
    cache and in every other environment. In this case the packages are downloaded again.
    """
    for cached in (True, False):
        installation.install(folder, release.installation.requirements(release.version), constraints, latest_upload, cached)
        if _has_its_packages(folder, release):
            return
    raise InstallationFailed("its files are not those that its wheels list")


def is_intact(folder: Path, release: Release) -> bool:
    """Return whether an environment has its packages, and imports the other packages from the running interpreter."""
    try:
        added = [(packages / PATH_FILE).read_text("utf-8") for packages in package_folders(folder)]
    except (OSError, ValueError):
        return False
    return added == [_path_lines()] and _has_its_packages(folder, release)


def package_folders(folder: Path) -> list[Path]:
    """Return the folders of packages (site-packages) of the environment in a folder: one, unless it is damaged."""
    return [path for pattern in ("lib/*/site-packages", "Lib/site-packages") for path in folder.glob(pattern)]


def _path_lines() -> str:
    """Return the content of the .pth file of an environment."""
    return PATH_FILE_LINES.format(folders=site_folders(), variable=PATH_VARIABLE)


def _has_its_packages(folder: Path, release: Release) -> bool:
    """Return whether the interpreter of an environment runs and all files have the contents that they were installed with."""
    try:
        version = output(installation.interpreter(folder), VERSION_OF_INTACT_PACKAGE, release.installation.distribution)
        return Version(version) == Version(release.version)
    except (InstallationFailed, InvalidVersion):
        return False


def output(python: Path, code: str, *arguments: str, variables: Variables = ()) -> str:
    """Run code in an environment, with further environment variables, and return its stdout, stripped.

    Raises `InstallationFailed`, with the last line of stderr, if the code fails or takes longer than `INSPECTION_LIMIT_S`.
    """
    try:
        done = run(python, ["-c", code, *arguments], None, INSPECTION_LIMIT_S, variables)
    except subprocess.TimeoutExpired as error:
        raise InstallationFailed(f"the import took longer than {INSPECTION_LIMIT_S:g} s") from error
    except OSError as error:
        raise InstallationFailed(f"its interpreter cannot be run: {error}") from error
    if done.returncode < 0:
        raise InstallationFailed(f"the import was ended by signal {-done.returncode}")
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        raise InstallationFailed(f"the import failed: {last}")
    return done.stdout.strip()


def run(
    python: Path, arguments: Sequence[str], stdin: str | None, timeout: float, variables: Variables = ()
) -> CompletedProcess[str]:
    """Run the interpreter of an environment, with at most `subprocesses.MEMORY_LIMIT_BYTES` of memory, until it ends.

    Parameters
    ----------
    python
        The interpreter.
    arguments
        Its arguments.
    stdin
        The text of its standard input; None for an empty one.
    timeout
        Seconds after which it is killed.
    variables
        Environment variables in addition to the variables of this process.

    Raises
    ------
    subprocess.TimeoutExpired
        It took longer than `timeout`.
    OSError
        There is no such interpreter.
    """
    everything = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
    everything |= dict((*path_variables(), *variables))
    # With -P nothing is imported from the working directory.
    return subprocesses.run([str(python), "-P", *arguments], everything, stdin, timeout, subprocesses.MEMORY_LIMIT_BYTES)


def site_folders() -> list[str]:
    """Return the folders of packages (site-packages) of the running interpreter."""
    return [*site.getsitepackages(), *([site.getusersitepackages()] if site.ENABLE_USER_SITE else [])]


def path_variables() -> tuple[tuple[str, str], ...]:
    """Return the environment variable with which an environment imports from the folders of the running interpreter."""
    return ((PATH_VARIABLE, os.pathsep.join(_other_folders())),)


def _other_folders() -> list[str]:
    """Return the folders, other than site-packages and the standard library, from which the running interpreter imports."""
    folders = [sysconfig.get_path("stdlib"), sysconfig.get_path("platstdlib"), *site_folders()]
    others = [Path(folder).absolute() for folder in sys.path if folder]
    return [str(folder) for folder in others if folder.is_dir() and not any(map(folder.is_relative_to, folders))]


def _oldest(package: str) -> str:
    """Return the requirement for the oldest releases of a package that bodycheck supports, as `scipy==1.14.*`."""
    from packaging.requirements import Requirement  # commands that make no environment do not need its parser

    needs = (need for need in map(Requirement, metadata.requires("bodycheck") or ()) if need.name == package)
    (least,) = (spec.version for need in needs for spec in need.specifier if spec.operator == ">=")
    return f"{package}=={least}.*"
