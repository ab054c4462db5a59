"""The wheel holds what the checkout holds: every module, the cases, the templates, the type marker."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.support import ROOT

FOLDERS = {"bodycheck": ""} | {name: f"{name}/" for name in ("reference", "adapters", "cases", "reports")}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built outside of the checkout, where files of an earlier build could get into it."""
    out = tmp_path_factory.mktemp("wheel")
    settings = out / "setup.cfg"
    settings.write_text(f"[build]\nbuild_base = {out / 'build'}\n[egg_info]\negg_base = {out}\n")
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", out, ROOT]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"DIST_EXTRA_CONFIG": str(settings)})
    assert done.returncode == 0, done.stderr
    return next(out.glob("*.whl"))


def test_the_wheel_has_every_file_of_the_package(wheel: Path) -> None:
    shipped = {"**/*.py", "*.case.toml", "template.toml", "*.schema.json", "templates/*.*", "templates/player/*.js", "py.typed"}
    expected = {
        f"bodycheck/{prefix}{path.relative_to(ROOT / folder).as_posix()}"
        for folder, prefix in FOLDERS.items()
        for pattern in shipped
        for path in (ROOT / folder).glob(pattern)
    }
    names = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert names == expected
    assert "bodycheck/cases/free-brick.case.toml" in names


def test_a_normal_install_runs(wheel: Path, tmp_path: Path) -> None:
    """From the wheel alone, away from the checkout: the package found first is the one of the wheel."""
    zipfile.ZipFile(wheel).extractall(tmp_path)
    code = (
        f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n"
        "import bodycheck.casefile.case\nprint(bodycheck.__file__, len(bodycheck.casefile.case.shipped()))"
    )
    done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, cwd=tmp_path)
    file, count = done.stdout.split()
    assert Path(file).is_relative_to(tmp_path)
    assert int(count) == len(list((ROOT / "cases").glob("*.case.toml")))
