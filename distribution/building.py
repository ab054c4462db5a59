"""Distributions of a commit, with the same bytes wherever and whenever they are built."""

import gzip
import io
import os
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

#: Calls a hook of setuptools, which must be installed: nothing is downloaded.
BUILD = "import sys\nfrom setuptools import build_meta\nprint(getattr(build_meta, sys.argv[1])(sys.argv[2]))\n"

#: The rights of files in distributions, whatever those of the checkout are.
RIGHTS = 0o644

#: The earliest day that a zip file can have.
EARLIEST = (1980, 1, 1, 0, 0, 0)


class Differs(Exception):
    """Two builds of the same commit differ; the text names the file."""


def twice(repository: Path, folder: Path) -> list[Path]:
    """Build all distributions of the last commit of a repository twice, and return the files of the first build.

    folder: an empty folder. Raises `Differs` if the builds differ.
    """
    first, second = (_all(repository, folder / name) for name in ("first", "a longer name for the second"))
    for one, other in zip(first, second, strict=True):
        if one.read_bytes() != other.read_bytes():
            raise Differs(f"{one.name}: two builds of the same commit differ")
    return first


def checkout(folder: Path) -> Path:
    """Return the checkout of the commit that `twice` has built in a folder."""
    return folder / "first" / "bodycheck"


def digest(file: Path) -> str:
    """Return the SHA-256 of a file."""
    return sha256(file.read_bytes()).hexdigest()


def build(kind: str, out: Path, source: Path, epoch: int | None = None) -> Path:
    """Build the distribution of a source tree into a folder, outside of the tree, and return its path.

    Parameters
    ----------
    kind
        The hook of setuptools: build_wheel, build_sdist or build_editable.
    out, source
        The folder, and the source tree.
    epoch
        The time (s since 1970) of all files in the distribution, which then has the same bytes wherever it is built.

    Raises
    ------
    subprocess.CalledProcessError
        setuptools failed; it has printed why.
    """
    settings = out / "setup.cfg"
    settings.write_text(f"[build]\nbuild_base = {out / 'build'}\n[egg_info]\negg_base = {out}\n", "utf-8")
    environment = os.environ | {"DIST_EXTRA_CONFIG": str(settings)}
    if epoch is not None:
        environment["SOURCE_DATE_EPOCH"] = str(epoch)
    command = [sys.executable, "-c", BUILD, kind, str(out)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=source, env=environment)
    if done.returncode:
        sys.stderr.write(done.stderr)
        done.check_returncode()
    built = out / done.stdout.splitlines()[-1]
    if epoch is not None:
        (_normalise_tar if kind == "build_sdist" else _normalise_zip)(built, epoch)
    return built


def _all(repository: Path, folder: Path) -> list[Path]:
    """Build the distributions of the last commit in a new folder: those of bodycheck, then those of pytest-bodycheck."""
    source = folder / "bodycheck"
    clone = ["git", "clone", "--quiet", "--no-hardlinks", "--config", "core.symlinks=true", str(repository), str(source)]
    subprocess.run(clone, check=True)
    when = ["git", "log", "-1", "--format=%ct"]
    epoch = int(subprocess.run(when, check=True, capture_output=True, text=True, cwd=source).stdout)
    built = []
    for place in (source, _pytest_bodycheck(source)):
        for kind in ("build_sdist", "build_wheel"):
            out = folder / f"{place.name} {kind}"
            out.mkdir(parents=True, exist_ok=True)
            built.append(build(kind, out, place, epoch))
    return built


def _pytest_bodycheck(source: Path) -> Path:
    """Give the second distribution of a source tree the version and the address of the first, and return its folder."""
    project = tomllib.loads((source / "pyproject.toml").read_text("utf-8"))["project"]
    folder = source / "distribution" / "pytest-bodycheck"
    text = (folder / "pyproject.template.toml").read_text("utf-8").replace("VERSION", project["version"])
    (folder / "pyproject.toml").write_text(text.replace("REPOSITORY", project["urls"]["Repository"]), "utf-8")
    return folder


def _normalise_zip(path: Path, epoch: int) -> None:
    """Write a wheel again: its files in the order of their names, of one time and with the same rights."""
    time = max(EARLIEST, datetime.fromtimestamp(epoch, UTC).timetuple()[:6])
    with zipfile.ZipFile(path) as archive:
        # The list of files comes last, as in every wheel.
        names = sorted(archive.namelist(), key=lambda name: (name.endswith(".dist-info/RECORD"), name))
        contents = {name: archive.read(name) for name in names}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in contents.items():
            entry = zipfile.ZipInfo(name, time)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, (0o100000 | RIGHTS) << 16
            archive.writestr(entry, content)


def _normalise_tar(path: Path, epoch: int) -> None:
    """Write a source distribution again: its files sorted by name, of one time, of nobody, with the same rights."""
    with tarfile.open(path) as archive:
        files = {member.name: archive.extractfile(member) for member in archive if member.isreg()}
        contents = {name: stream.read() for name, stream in sorted(files.items()) if stream is not None}
    plain = io.BytesIO()
    with tarfile.open(fileobj=plain, mode="w", format=tarfile.PAX_FORMAT) as archive:
        for name, content in contents.items():
            entry = tarfile.TarInfo(name)
            entry.size, entry.mtime, entry.mode = len(content), epoch, RIGHTS
            archive.addfile(entry, io.BytesIO(content))
    path.write_bytes(gzip.compress(plain.getvalue(), mtime=epoch))
