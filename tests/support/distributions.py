"""Distributions of the checkout and environments of their own, all made outside of it: nothing of an earlier build gets in."""

import venv
import zipfile
from pathlib import Path

from distribution.building import build
from tests.support import ROOT


def build_wheel(out: Path, source: Path = ROOT) -> Path:
    """Build the wheel of a source tree into a folder and return its path."""
    return build("build_wheel", out, source)


def build_sdist(out: Path, source: Path = ROOT) -> Path:
    """Build the source distribution of a source tree into a folder and return its path."""
    return build("build_sdist", out, source)


def build_editable(out: Path) -> Path:
    """Build the wheel that an editable install of the checkout unpacks, into a folder, and return its path."""
    return build("build_editable", out, ROOT)


def installed(wheel: Path, folder: Path) -> Path:
    """Make an environment in which a wheel, and nothing else, is installed, and return its interpreter."""
    venv.create(folder, symlinks=True)
    (site,) = folder.glob("lib/python*/site-packages")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    return folder / "bin" / "python"
