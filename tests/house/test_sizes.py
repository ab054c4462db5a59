"""Files, functions and folders stay small enough to be read at once, as CONTRIBUTING says."""

import ast
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support import ROOT

#: The folders with the code of the product.
FOLDERS = ("bodycheck", "reference", "adapters", "reports")

#: Most lines of a file, lines of a function without its docstring, and Python files side by side.
MOST_LINES, MOST_LINES_OF_FUNCTION, MOST_FILES = 400, 60, 24


def modules(root: Path) -> list[Path]:
    """Return all modules of a checkout; links to its folders are not followed."""
    return sorted(path for folder in FOLDERS for path in (root / folder).rglob("*.py"))


def lengths(source: str) -> Iterator[tuple[str, int]]:
    """Yield the functions of a module with the numbers of their lines, without their docstrings."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            assert node.end_lineno is not None
            docstring = node.body[0] if ast.get_docstring(node) is not None else None
            written = 0 if docstring is None else (docstring.end_lineno or docstring.lineno) - docstring.lineno + 1
            yield node.name, node.end_lineno - node.lineno + 1 - written


def too_large(root: Path) -> list[str]:
    """Return a line for each file, function and folder of a checkout that is too large."""
    faults = []
    for path in modules(root):
        source = path.read_text("utf-8")
        name = path.relative_to(root)
        if (count := len(source.splitlines())) > MOST_LINES:
            faults.append(f"{name}: has {count} lines, allowed: {MOST_LINES}")
        faults += [
            f"{name}: {function} has {count} lines, allowed: fewer than {MOST_LINES_OF_FUNCTION}"
            for function, count in lengths(source)
            if count >= MOST_LINES_OF_FUNCTION
        ]
    side_by_side = Counter(path.parent.relative_to(root) for path in modules(root))
    faults += [
        f"{folder}: has {count} modules, allowed: {MOST_FILES}" for folder, count in side_by_side.items() if count > MOST_FILES
    ]
    return faults


def test_files_functions_and_folders_are_small() -> None:
    assert too_large(ROOT) == []


@pytest.mark.parametrize(
    ("files", "fault"),
    [
        ({"long.py": "x = 1\n" * 401}, "reference/long.py: has 401 lines, allowed: 400"),
        ({"f.py": "def f():\n" + "    x = 1\n" * 59}, "reference/f.py: f has 60 lines, allowed: fewer than 60"),
        ({f"m{n}.py": "" for n in range(25)}, "reference: has 25 modules, allowed: 24"),
    ],
)
def test_what_is_too_large_is_found(tmp_path: Path, files: dict[str, str], fault: str) -> None:
    for folder in FOLDERS:
        (tmp_path / folder).mkdir()
    for name, text in files.items():
        (tmp_path / "reference" / name).write_text(text)
    assert too_large(tmp_path) == [fault]


def test_a_docstring_does_not_count() -> None:
    text = 'def f():\n    """Say\n    much."""\n    return 1\n'
    assert dict(lengths(text)) == {"f": 2}
