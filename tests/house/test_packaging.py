"""The wheel holds what the checkout holds: every module, the cases, the templates, the type marker."""

import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from tests.support import ROOT
from tests.support.distributions import build_sdist, build_wheel

FOLDERS = {"bodycheck": ""} | {name: f"{name}/" for name in ("reference", "adapters", "cases", "reports")}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_wheel(tmp_path_factory.mktemp("wheel"))


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


def test_the_source_distribution_makes_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    """It holds real files where the checkout has links."""
    (tmp_path / "sdist").mkdir()
    with tarfile.open(build_sdist(tmp_path / "sdist")) as archive:
        assert not [member.name for member in archive if member.issym() or member.islnk()]
        archive.extractall(tmp_path, filter="data")
    (source,) = (path for path in tmp_path.iterdir() if path.name.startswith("bodycheck-"))
    (tmp_path / "wheel").mkdir()
    again = build_wheel(tmp_path / "wheel", source)
    one, other = ({entry.filename: entry.CRC for entry in zipfile.ZipFile(file).infolist()} for file in (wheel, again))
    assert {name: crc for name, crc in one.items() if ".dist-info/" not in name} == {
        name: crc for name, crc in other.items() if ".dist-info/" not in name
    }


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
