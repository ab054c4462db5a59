"""Distributions hold what the checkout holds, as files of their own, and type checkers and editors read what they install."""

import os
import stat
import subprocess
import sys
import tarfile
import zipfile
from importlib.machinery import SourceFileLoader
from pathlib import Path

import jedi
import pytest

from bodycheck import errors
from tests.support import ROOT
from tests.support.distributions import build_editable, build_sdist, build_wheel, installed

FOLDERS = {"bodycheck": ""} | {name: f"{name}/" for name in ("reference", "adapters", "cases", "reports")}
SHIPPED = (
    "**/*.py",
    "**/*.case.toml",
    "driven/*.urdf",
    "driven/*.xml",
    "template*.toml",
    "*.schema.json",
    "studies/estimate/factors.json",
    "sources.toml",
    "certificates.json",
    "*/citation.bib",
    "templates/*.*",
    "templates/player/*.js",
    "site/*.toml",
    "site/templates/*.*",
    "py.typed",
)


def test_assertions_are_rewritten_in_the_tests_alone() -> None:
    """pytest would compile every module of bodycheck anew in each process, as bodycheck brings a plug-in."""
    assert type(errors.__loader__) is SourceFileLoader
    assert type(sys.modules[__name__].__loader__) is not SourceFileLoader


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_wheel(tmp_path_factory.mktemp("wheel"))


def contents(wheel: Path) -> dict[str, int]:
    """The checksums of a wheel's files by their names."""
    with zipfile.ZipFile(wheel) as archive:
        return {entry.filename: entry.CRC for entry in archive.infolist() if ".dist-info/" not in entry.filename}


def test_the_wheel_has_every_file_of_the_package(wheel: Path) -> None:
    """As real files where the checkout has links."""
    assert contents(wheel).keys() == {
        f"bodycheck/{prefix}{path.relative_to(ROOT / folder).as_posix()}"
        for folder, prefix in FOLDERS.items()
        for pattern in SHIPPED
        for path in (ROOT / folder).glob(pattern)
    }
    assert "bodycheck/cases/free-brick.case.toml" in contents(wheel)
    with zipfile.ZipFile(wheel) as archive:
        assert not [entry.filename for entry in archive.infolist() if stat.S_ISLNK(entry.external_attr >> 16)]


def test_the_source_distribution_makes_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    """It too holds real files where the checkout has links."""
    (tmp_path / "sdist").mkdir()
    with tarfile.open(build_sdist(tmp_path / "sdist")) as archive:
        assert not [member.name for member in archive if not (member.isreg() or member.isdir())]
        archive.extractall(tmp_path, filter="data")
    (source,) = (path for path in tmp_path.iterdir() if path.name.startswith("bodycheck-"))
    (tmp_path / "wheel").mkdir()
    assert contents(build_wheel(tmp_path / "wheel", source)) == contents(wheel)


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
    assert int(count) == len(list((ROOT / "cases").rglob("*.case.toml")))


#: What a user of the package writes.
SCRIPT = """\
from bodycheck.casefile.content import Case
from bodycheck.adapters.contract import Engine
reveal_type(Case)
Engine
"""


@pytest.fixture(scope="module", params=["wheel", "editable"])
def python(request: pytest.FixtureRequest, wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of an environment in which bodycheck, and nothing else, is installed, or is editable."""
    built = wheel if request.param == "wheel" else build_editable(tmp_path_factory.mktemp("editable"))
    return installed(built, tmp_path_factory.mktemp("environment"))


@pytest.fixture
def script(tmp_path: Path) -> Path:
    path = tmp_path / "script.py"
    path.write_text(SCRIPT)
    return path


def outside() -> dict[str, str]:
    """The environment variables of a process that knows nothing of the checkout."""
    return {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "MYPYPATH")}


def test_mypy_knows_the_types_of_an_install(python: Path, script: Path) -> None:
    """Of other packages, which are not in that environment, it need not know anything."""
    options = ("--python-executable", python, "--ignore-missing-imports", "--cache-dir", script.parent / "cache")
    command = [sys.executable, "-m", "mypy", *options, script]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, cwd=script.parent, env=outside())
    (revealed,) = (line for line in done.stdout.splitlines() if "Revealed type" in line)
    assert "scene: bodycheck.reference.scene.Scene" in revealed
    assert "-> bodycheck.casefile.content.Case" in revealed


def test_jedi_finds_the_source_of_an_install(python: Path, script: Path) -> None:
    environment = jedi.create_environment(str(python), safe=False, env_vars=outside())
    source = jedi.Script(SCRIPT, path=script, environment=environment)
    for line, module, name in ((1, "casefile/content.py", "Case"), (4, "adapters/engine_record.py", "Engine")):
        (found,) = source.goto(line, SCRIPT.splitlines()[line - 1].index(name), follow_imports=True)
        assert (found.name, found.type) == (name, "class")
        assert found.module_path is not None
        assert found.module_path.read_text() == (ROOT / "bodycheck" / module).read_text()


def test_a_clone_does_not_stand_in_for_what_is_installed(python: Path, request: pytest.FixtureRequest) -> None:
    """Python that is started in a clone finds it first: an error, unless the clone is what is installed, or with -P."""
    editable = request.node.callspec.params["python"] == "editable"
    done = subprocess.run([python, "-c", "import bodycheck"], capture_output=True, text=True, cwd=ROOT, env=outside())
    assert (done.returncode == 0) is editable
    assert "bodycheck is installed in " in done.stderr.splitlines()[-1] if done.stderr else True
    safe = subprocess.run([python, "-P", "-c", "import bodycheck"], capture_output=True, cwd=ROOT, env=outside())
    assert safe.returncode == 0
