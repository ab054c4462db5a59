"""Type checkers and editors find every import of the checkout, in the product as in tests, documents and benchmarks."""

import ast
import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support import ROOT

#: Imports that cannot be found, by the files that they are planted in.
PLANTED = {
    "adapters/registry.py": "import nowhere",
    "bodycheck/judging/judgement.py": "from bodycheck.casefile.case import Nobody",
    "tests/docs/planted.py": "from bodycheck.harness import run",
}

#: Everything in the checkout that is Python.
FOLDERS = ("bodycheck", "reference", "adapters", "reports", "claims", "tests", "docs", "benchmarks")


def outlined(source: str) -> str:
    """The imports of a module and the names that others may import from it: all that finding imports needs, in little time."""
    imports = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Import | ast.ImportFrom)]
    names = dict.fromkeys(defined(ast.parse(source).body))
    return "\n".join([*map(ast.unparse, imports), *(f"{name} = None" for name in names)]) + "\n"


def defined(statements: list[ast.stmt]) -> Iterator[str]:
    """The names that some statements define, those within conditions included."""
    for statement in statements:
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            yield statement.name
            continue
        for node in ast.iter_child_nodes(statement):
            if isinstance(node, ast.stmt):
                yield from defined([node])
            yield from (name.id for name in ast.walk(node) if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store))


@pytest.fixture(scope="module")
def outline(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the checkout whose modules are outlined."""
    copy = tmp_path_factory.mktemp("outline")
    for folder in (*FOLDERS, "cases"):
        shutil.copytree(ROOT / folder, copy / folder, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
    settings = (ROOT / "pyproject.toml").read_text("utf-8")
    # In an outline the attributes of modules are what is imported from them.
    old, new = 'reportMissingImports = "error"\n', 'reportMissingImports = "error"\nreportAttributeAccessIssue = "error"\n'
    assert old in settings
    (copy / "pyproject.toml").write_text(settings.replace(old, new), "utf-8")
    for path in copy.rglob("*.py"):
        path.write_text(outlined(path.read_text("utf-8")), "utf-8")
    return copy


def check(checkout: Path, *folders: str) -> dict[str, Any]:
    """What basedpyright reports of some folders of a checkout."""
    command = [Path(sys.executable).with_name("basedpyright"), "--pythonpath", sys.executable, "--outputjson", *folders]
    done = subprocess.run(list(map(str, command)), cwd=checkout, capture_output=True, text=True)
    report: dict[str, Any] = json.loads(done.stdout)
    return report


def not_found(checkout: Path, report: dict[str, Any]) -> list[str]:
    """What was not found of what a checkout imports: modules, and names in modules."""
    return sorted(f"{Path(one['file']).relative_to(checkout)}: {one['message']}" for one in report["generalDiagnostics"])


@pytest.fixture(scope="module")
def missed(outline: Path) -> list[str]:
    """What basedpyright does not find in the whole outline, in which imports of what does not exist are planted."""
    files = len(list(outline.rglob("*.py")))
    for file, line in PLANTED.items():
        with (outline / file).open("a") as module:
            module.write(line + "\n")
    report = check(outline, *FOLDERS)
    assert report["summary"]["filesAnalyzed"] > files  # those of the linked folders twice
    return not_found(outline, report)


#: A fault in a linked folder is found in the folder and in the link to it.
EXPECTED = [
    'adapters/registry.py: Import "nowhere" could not be resolved',
    'bodycheck/adapters/registry.py: Import "nowhere" could not be resolved',
    'bodycheck/judging/judgement.py: "Nobody" is unknown import symbol',
    'tests/docs/planted.py: Import "bodycheck.harness" could not be resolved',
]


def test_every_import_of_the_checkout_is_found(missed: list[str]) -> None:
    assert [one for one in missed if one not in EXPECTED] == []


def test_mypy_misses_modules_of_bodycheck_alone(tmp_path: Path) -> None:
    """Without a list of engines: a package that is not installed may be one, but a module of bodycheck must be there."""
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    for package in ("bodycheck", "claims"):
        (tmp_path / package).mkdir()
        (tmp_path / package / "__init__.py").touch()
    (tmp_path / "bodycheck" / "planted.py").write_text("import planted_engine\nfrom bodycheck.adapters.contrct import Engine\n")
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path / "cache")]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    faults = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert len(faults) == 1, done.stdout + done.stderr
    assert faults[0].startswith("bodycheck/planted.py:2:")
    assert "bodycheck.adapters.contrct" in faults[0]


def test_planted_imports_are_missed(missed: list[str]) -> None:
    assert [one for one in missed if one in EXPECTED] == EXPECTED
