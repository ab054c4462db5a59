"""Distributions of the checkout and environments of their own, all made outside of it: nothing of an earlier build gets in."""

import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

from tests.support import ROOT

BUILD = "import sys\nfrom setuptools import build_meta\nprint(getattr(build_meta, sys.argv[1])(sys.argv[2]))\n"


def build_wheel(out: Path, source: Path = ROOT) -> Path:
    """Build the wheel of a source tree into a folder and return its path."""
    return _build("build_wheel", out, source)


def build_sdist(out: Path) -> Path:
    """Build the source distribution of the checkout into a folder and return its path."""
    return _build("build_sdist", out, ROOT)


def build_editable(out: Path) -> Path:
    """Build the wheel that an editable install of the checkout unpacks, into a folder, and return its path."""
    return _build("build_editable", out, ROOT)


def installed(wheel: Path, folder: Path) -> Path:
    """Make an environment in which a wheel, and nothing else, is installed, and return its interpreter."""
    venv.create(folder, symlinks=True)
    (site,) = folder.glob("lib/python*/site-packages")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    return folder / "bin" / "python"


def _build(kind: str, out: Path, source: Path) -> Path:
    settings = out / "setup.cfg"
    settings.write_text(f"[build]\nbuild_base = {out / 'build'}\n[egg_info]\negg_base = {out}\n")
    environment = os.environ | {"DIST_EXTRA_CONFIG": str(settings)}
    command = [sys.executable, "-c", BUILD, kind, str(out)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=source, env=environment)
    assert done.returncode == 0, done.stderr
    return out / done.stdout.splitlines()[-1]
