"""How an environment is filled: with a release of an engine, so that it can be imported and bodycheck runs beside it.

It holds what the release depends on besides, and its packages come first. After them come those of the running interpreter,
by a file that Python reads at its start. A release is at odds with what it is installed with in three ways, each met here:

- What is compiled against NumPy 1 may fail with NumPy 2, and old metadata do not say so.
- Of what it depends on there may be newer releases by now with which it cannot be imported.
- With an old NumPy the running interpreter's SciPy, pandas and PyArrow may refuse to be imported. The environment then has the
  oldest of them that bodycheck takes, which are of the time of NumPy 1.
"""

import os
import site
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import timedelta
from importlib import metadata
from pathlib import Path
from subprocess import CompletedProcess

from packaging.requirements import Requirement
from packaging.version import InvalidVersion, Version

from bodycheck.environments import installation
from bodycheck.environments.installation import InstallationFailed
from bodycheck.running import pool

#: What tells an environment of the folders from which the running interpreter imports besides its packages.
PATH_VARIABLE = "BODYCHECK_PATH"

#: Packages of bodycheck's that are compiled against NumPy, and what to import of each to see whether it takes the one there.
COMPILED = {"scipy": "scipy.integrate", "pandas": "pandas", "pyarrow": "pyarrow.parquet"}

OLD_NUMPY = "numpy<2"

#: How long after a release the wheels of what it depends on may be uploaded still.
LATENESS = timedelta(days=14)

#: Seconds that a look at an environment may take.
PATIENCE = 120.0

#: What Python does last at its start in an environment: it adds the running interpreter's packages, with their own hooks.
HOOK = """\
import site; list(map(site.addsitedir, {folders!r}))
import os, sys; sys.path.extend(filter(None, os.environ.get({variable!r}, "").split(os.pathsep)))
"""

#: Says which version an environment has, once all files are as they were installed.
SOUND = """
import csv, importlib.metadata, os, sys, sysconfig
root = sysconfig.get_path("purelib")
for folder in os.listdir(root):
    if folder.endswith(".dist-info"):
        for name, _, size in csv.reader(open(os.path.join(root, folder, "RECORD"), encoding="utf-8", newline="")):
            if size and os.stat(os.path.join(root, name)).st_size != int(size):
                sys.exit(f"{name} is not what was installed")
print(importlib.metadata.version(sys.argv[1]))
"""

#: Says which packages do not take the environment's NumPy.
REFUSING = """
import importlib, sys, warnings
warnings.simplefilter("error", UserWarning)
for package, module in zip(sys.argv[1::2], sys.argv[2::2]):
    try:
        importlib.import_module(module)
    except Exception:
        print(package)
"""

#: Says how many of its adapter's checks an engine fails; ends otherwise than well where it cannot be imported.
FAULTS = """
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
    """A way to install a release. The next is tried where what came of the one before cannot be imported, or is faulty.

    numpy: a constraint besides the one that it be no newer than the running interpreter's. of_its_day: with all that it depends
    on as it was when the release came out.
    """

    numpy: str = ""
    of_its_day: bool = False


ATTEMPTS = (Attempt(), Attempt(OLD_NUMPY), Attempt(of_its_day=True))


@dataclass(frozen=True)
class Release:
    """engine: by its name here. distribution: that in package indexes."""

    engine: str
    distribution: str
    version: str


def fill(folder: Path, release: Release, attempt: Attempt) -> bool:
    """Make the environment of a release in an empty folder, and tell whether the engine fails no check of its adapter.

    Raises `InstallationFailed`, also where the engine cannot be imported.
    """
    day = None
    if attempt.of_its_day:
        if (uploaded := installation.release_day(release.distribution, release.version)) is None:
            raise InstallationFailed("the day of its release is not known")
        day = uploaded + LATENESS
    here = metadata.version("numpy")
    installation.make(folder)
    constraints = [f"numpy<={here}", *([attempt.numpy] if attempt.numpy else [])]
    installation.install(folder, [f"{release.distribution}=={release.version}"], constraints, day)
    python = installation.interpreter(folder)
    packages = Path(said(python, "import sysconfig; print(sysconfig.get_path('purelib'))"))
    # Of the files that Python reads at its start this is the last, so that all folders of the environment come before.
    (packages / "~bodycheck.pth").write_text(HOOK.format(folders=site_folders(), variable=PATH_VARIABLE), "utf-8")
    there = said(python, "import importlib.metadata; print(importlib.metadata.version('numpy'))")
    if there != here:
        refusing = said(python, REFUSING, *(word for pair in COMPILED.items() for word in pair)).split()
        if refusing:
            installation.install(folder, [_oldest(package) for package in refusing], [f"numpy=={there}"])
    return said(python, FAULTS, release.engine).rpartition("\n")[2] == "0"


def is_sound(folder: Path, release: Release) -> bool:
    """Whether the interpreter of an environment runs, and its files are what was installed."""
    try:
        return Version(said(installation.interpreter(folder), SOUND, release.distribution)) == Version(release.version)
    except (InstallationFailed, InvalidVersion):
        return False


def said(python: Path, code: str, *arguments: str) -> str:
    """What code prints in an environment. Raises `InstallationFailed` with its last word."""
    try:
        done = call(python, ["-c", code, *arguments], None, PATIENCE)
    except subprocess.TimeoutExpired as error:
        raise InstallationFailed(f"it was not imported within {PATIENCE:g} s") from error
    except OSError as error:
        raise InstallationFailed(f"its interpreter cannot be run: {error}") from error
    if done.returncode < 0:
        raise InstallationFailed(f"it died of signal {-done.returncode} when it was imported")
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        raise InstallationFailed(f"it died when it was imported: {last}")
    return done.stdout.strip()


def call(python: Path, arguments: Sequence[str], stdin: str | None, timeout: float) -> CompletedProcess[str]:
    """Python's outcome in an environment. Raises `subprocess.TimeoutExpired`, and OSError where there is no interpreter."""
    variables = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
    variables[PATH_VARIABLE] = os.pathsep.join(_other_folders())
    # -P: what lies in the working directory is nobody's package.
    return installation.call([str(python), "-P", *arguments], variables, stdin, timeout, pool.MEMORY)


def site_folders() -> list[str]:
    """Where the running interpreter's packages are."""
    return [*site.getsitepackages(), *([site.getusersitepackages()] if site.ENABLE_USER_SITE else [])]


def _other_folders() -> list[str]:
    """Where it imports from besides: neither packages nor its standard library."""
    own = [sysconfig.get_path("stdlib"), sysconfig.get_path("platstdlib"), *site_folders()]
    others = [Path(folder).absolute() for folder in sys.path if folder]
    return [str(folder) for folder in others if folder.is_dir() and not any(map(folder.is_relative_to, own))]


def _oldest(package: str) -> str:
    """The oldest releases of a package that bodycheck takes."""
    needs = (need for need in map(Requirement, metadata.requires("bodycheck") or ()) if need.name == package)
    (least,) = (spec.version for need in needs for spec in need.specifier if spec.operator == ">=")
    return f"{package}=={least}.*"
