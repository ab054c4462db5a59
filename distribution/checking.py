"""What must hold for distributions before they are published: their metadata, their files and their size.

    python -m distribution.checking --tag TAG --address ADDRESS

checks that a tag is that of the version, that the addresses of the metadata are those of the repository from which they are
published, and that CHANGELOG.md has a section of the version.
"""

import argparse
import re
import sys
import tarfile
import tomllib
import zipfile
from collections.abc import Iterator, Sequence
from email.message import Message
from email.parser import HeaderParser
from pathlib import Path

#: The largest size of a distribution (MB). Three times that of 2026, as cases and engines come.
LARGEST_MB = 9.0

#: What the metadata of both distributions must have.
FIELDS = ("Summary", "License-Expression", "Requires-Python", "Classifier", "Project-URL", "Description-Content-Type")

#: Files that no distribution may have: those of development, and what editors and caches leave.
UNWANTED = re.compile(r"^(tests|docs|claims|submissions|benchmarks|\.git|\.venv)/|__pycache__/|\.(pyc|orig|rej|swp)$|~$")

#: A file of each kind that a wheel of bodycheck must have.
WANTED = (
    "bodycheck/py.typed",
    "bodycheck/adapters/mujoco/engine.py",
    "bodycheck/cases/intermediate-axis-flip.case.toml",
    "bodycheck/cases/case.schema.json",
    "bodycheck/reference/truth.py",
    "bodycheck/reports/templates/vega.js",
    "bodycheck/site/templates/site.css",
)


def faults(files: Sequence[Path], version: str) -> list[str]:
    """Return a sentence for each fault of the distributions of a version; none if they can be published."""
    return [f"{file.name}: {fault}" for file in files for fault in _faults(file, version)]


def metadata(file: Path) -> Message:
    """Return the metadata of a distribution."""
    suffix = ".dist-info/METADATA" if file.suffix == ".whl" else "/PKG-INFO"
    contents = read(file)
    (name,) = (name for name in contents if name.endswith(suffix) and name.count("/") == 1)
    return HeaderParser().parsestr(contents[name].decode("utf-8"))


def read(file: Path) -> dict[str, bytes]:
    """Return the contents of the regular files of a distribution by their names. Raises `ValueError` for a link in it."""
    if file.suffix == ".whl":
        with zipfile.ZipFile(file) as archive:
            return {name: archive.read(name) for name in archive.namelist()}
    contents = {}
    with tarfile.open(file) as archive:
        for member in archive:
            stream = archive.extractfile(member) if member.isreg() else None
            if stream is not None:
                contents[member.name] = stream.read()
            elif not member.isdir():
                raise ValueError(f"{file.name}: {member.name} is neither a file nor a folder")
    return contents


def _faults(file: Path, version: str) -> Iterator[str]:
    size = file.stat().st_size / 1e6
    if size > LARGEST_MB:
        yield f"has {size:.1f} MB; allowed: {LARGEST_MB:g} MB"
    described = metadata(file)
    if described["Version"] != version:
        yield f"is of the version {described['Version']}, and pyproject.toml says {version}"
    yield from (f"its metadata have no {field}" for field in FIELDS if described[field] is None)
    if not (described.get_payload() or "").strip():
        yield "its metadata have no description"
    contents = read(file)
    yield from (f"has {name}" for name in contents if UNWANTED.search(name.partition("/")[2] if file.suffix == ".gz" else name))
    if file.suffix == ".whl" and described["Name"] == "bodycheck":
        yield from (f"lacks {name}" for name in WANTED if name not in contents)
        scripts = next(content for name, content in contents.items() if name.endswith(".dist-info/entry_points.txt"))
        yield from (f"has no entry point {word}" for word in ("console_scripts", "pytest11") if word not in scripts.decode())


def faults_of_a_tag(tag: str, address: str, root: Path) -> Iterator[str]:
    """Yield a sentence for each reason why a tag of the repository at an address must not be published."""
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    if tag != f"v{project['version']}":
        yield f"pyproject.toml: version is {project['version']}, and the tag is {tag}"
    if project["urls"]["Repository"] != address:
        yield f"pyproject.toml: Repository is {project['urls']['Repository']}, and this repository is {address}"
    for name, url in project["urls"].items():
        if "OWNER" in url:
            yield f"pyproject.toml: {name} is {url}, in which OWNER stands for the owner of the repository"
    if f"\n## {project['version']}\n" not in (root / "CHANGELOG.md").read_text("utf-8"):
        yield f"CHANGELOG.md: has no section {project['version']}"


def main() -> None:
    parser = argparse.ArgumentParser(description="Check a tag before its distributions are built.")
    parser.add_argument("--tag", required=True)
    parser.add_argument("--address", required=True)
    given = parser.parse_args()
    if told := list(faults_of_a_tag(given.tag, given.address, Path(__file__).parents[1])):
        sys.exit("\n".join(told))


if __name__ == "__main__":
    main()
