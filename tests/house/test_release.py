"""Distributions have the same bytes wherever they are built, and what is not fit to be published is named."""

import io
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
import yaml

from bodycheck.commands import cite
from distribution import building, checking, release
from tests.support import ROOT
from tests.support.distributions import build_sdist, build_wheel

#: What a copy of the checkout for a build has.
BUILT = ("bodycheck", "adapters", "cases", "reference", "reports", "distribution", "pyproject.toml", "setup.py", "LICENSE")

#: The rooms that are links.
ROOMS = ("adapters", "cases", "reference", "reports")


@pytest.fixture(scope="module")
def unlinked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the checkout as git makes it without symbolic links: the address of each link is a file in its place."""
    folder = tmp_path_factory.mktemp("unlinked")
    left_out = shutil.ignore_patterns("__pycache__")
    for name in BUILT:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, symlinks=True, ignore=left_out)
        else:
            shutil.copy(ROOT / name, folder)
    for room in ROOMS:
        link = folder / "bodycheck" / room
        target = link.readlink()
        link.unlink()
        link.write_text(str(target), "utf-8")
    return folder


def contents(wheel: Path) -> dict[str, int]:
    with zipfile.ZipFile(wheel) as archive:
        return {entry.filename: entry.CRC for entry in archive.infolist() if ".dist-info/" not in entry.filename}


def test_a_checkout_without_symbolic_links_gives_the_same_wheel(unlinked: Path, tmp_path: Path) -> None:
    """As git makes it on Windows; so does the source distribution that is built there."""
    for name in ("linked", "unlinked", "source", "again"):
        (tmp_path / name).mkdir()
    wheel = contents(build_wheel(tmp_path / "unlinked", unlinked))
    assert wheel == contents(build_wheel(tmp_path / "linked"))
    with tarfile.open(build_sdist(tmp_path / "source", unlinked)) as archive:
        archive.extractall(tmp_path / "extracted", filter="data")
    (source,) = (tmp_path / "extracted").iterdir()
    assert contents(build_wheel(tmp_path / "again", source)) == wheel


def test_an_editable_install_without_symbolic_links_is_refused_with_what_to_do(unlinked: Path, tmp_path: Path) -> None:
    with pytest.raises(subprocess.CalledProcessError):
        building.build("build_editable", tmp_path, unlinked)


def test_archives_do_not_depend_on_times_rights_and_order(tmp_path: Path) -> None:
    """Of the files in the checkout, which differ from clone to clone."""
    texts = {"a/b.py": b"x = 1\n", "a/a.py": b"", "a-1.dist-info/RECORD": b"list"}
    written = []
    for number, names in enumerate((list(texts), list(reversed(texts)))):
        wheel, source = tmp_path / f"{number}.whl", tmp_path / f"{number}.tar.gz"
        with zipfile.ZipFile(wheel, "w") as archive:
            for name in names:
                archive.writestr(zipfile.ZipInfo(name, (2000 + number, 1, 1, 0, 0, 0)), texts[name])
        with tarfile.open(source, "w:gz") as tar:
            for name in names:
                entry = tarfile.TarInfo(name)
                entry.size, entry.mtime, entry.mode, entry.uname = len(texts[name]), number, 0o600 + number, f"user {number}"
                tar.addfile(entry, io.BytesIO(texts[name]))
        building._normalise_zip(wheel, 1_700_000_000)
        building._normalise_tar(source, 1_700_000_000)
        written.append((wheel.read_bytes(), source.read_bytes()))
        assert checking.read(wheel) == checking.read(source) == texts
    assert written[0] == written[1]


def packed(path: Path, **files: str) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in files.items():
            archive.writestr(name.replace("__", "/"), text)
    return path


def test_what_is_not_fit_to_be_published_is_named(tmp_path: Path) -> None:
    metadata = "Name: other\nVersion: 1\nSummary: s\nLicense-Expression: MIT\nRequires-Python: >=3\nClassifier: c\n\ntext\n"
    files = {"other-1.dist-info/METADATA": metadata, "tests/test_it.py": "", "other/a.pyc": "", "other/tests.py": ""}
    assert checking.faults([packed(tmp_path / "other-1-py3-none-any.whl", **files)], "2") == [
        "other-1-py3-none-any.whl: is of the version 1, and pyproject.toml says 2",
        "other-1-py3-none-any.whl: its metadata have no Project-URL",
        "other-1-py3-none-any.whl: its metadata have no Description-Content-Type",
        "other-1-py3-none-any.whl: has tests/test_it.py",
        "other-1-py3-none-any.whl: has other/a.pyc",
    ]


def test_a_tag_is_published_only_by_its_own_repository_and_with_its_own_version(tmp_path: Path) -> None:
    project = '[project]\nversion = "0.2.0"\n[project.urls]\nRepository = "https://host/me/bodycheck"\nIssues = "https://host/OWNER"\n'
    (tmp_path / "pyproject.toml").write_text(project, "utf-8")
    (tmp_path / "CHANGELOG.md").write_text("# Changelog\n\n## Unreleased\n", "utf-8")
    assert list(checking.faults_of_a_tag("v0.3.0", "https://host/other/bodycheck", tmp_path)) == [
        "pyproject.toml: version is 0.2.0, and the tag is v0.3.0",
        "pyproject.toml: Repository is https://host/me/bodycheck, and this repository is https://host/other/bodycheck",
        "pyproject.toml: Issues is https://host/OWNER, in which OWNER stands for the owner of the repository",
        "CHANGELOG.md: has no section 0.2.0",
    ]
    (tmp_path / "pyproject.toml").write_text(project.replace("OWNER", "me"), "utf-8")
    (tmp_path / "CHANGELOG.md").write_text("# Changelog\n\n## 0.2.0\n", "utf-8")
    assert not list(checking.faults_of_a_tag("v0.2.0", "https://host/me/bodycheck", tmp_path))


def test_an_interpreter_can_be_called_from_any_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Makefile names .venv/bin/python, which links to an interpreter that has none of the packages of the environment."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/python").symlink_to(sys.executable)
    monkeypatch.chdir(tmp_path)
    assert release.named("bin/python") == tmp_path / "bin/python"
    assert release.named("python3.11") == Path("python3.11")


def test_the_year_of_citations_is_that_of_the_release() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    assert citation["date-released"].year == cite.YEAR
    assert "version" not in citation, "pyproject.toml has the version"
