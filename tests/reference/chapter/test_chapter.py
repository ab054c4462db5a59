"""What the documentation says is where is there: docs/chapter.md and docs/errata.md name what exists."""

import ast
import functools
import importlib
import re

import pytest

from bodycheck.casefile.case import shipped
from tests.support import ROOT


def rows(document: str) -> list[list[str]]:
    """The cells of each row of a document's only table, without its head."""
    lines = [line for line in (ROOT / "docs" / document).read_text(encoding="utf-8").splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def names(cell: str) -> list[str]:
    return re.findall(r"`([^`]+)`", cell)


@functools.cache
def known_tests(file: str) -> set[str]:
    (path,) = (ROOT / "tests").rglob(file)
    module = ast.parse(path.read_text(encoding="utf-8"))
    return {node.name for node in module.body if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")}


def exists(name: str) -> bool:
    """Whether a function can be imported, a case is shipped, or a file is there."""
    if name.startswith("bodycheck."):
        module, _, function = name.rpartition(".")
        return callable(getattr(importlib.import_module(module), function, None))
    return name in shipped() or (ROOT / name).is_file()


CHAPTER = rows("chapter.md")


@pytest.mark.parametrize(("place", "holders", "tests"), CHAPTER, ids=[row[0].split(":")[0] for row in CHAPTER])
def test_every_row_of_the_chapter_names_what_exists(place: str, holders: str, tests: str) -> None:
    assert place
    assert names(holders)
    assert names(tests)
    for name in names(holders):
        assert exists(name), f"{name}: no such function, case or file"
    for name in names(tests):
        file, _, test = name.partition("::")
        assert test in known_tests(file), f"{name}: no such test"


def test_every_erratum_names_a_test_and_every_test_of_errata_an_erratum() -> None:
    table = rows("errata.md")
    assert all(len(row) == 5 and all(row) for row in table)
    proved = [name for row in table for name in names(row[4])]
    assert len(proved) == len(table)
    assert set(proved) == known_tests("test_errata.py")


def test_the_walk_sees_what_is_missing() -> None:
    assert not exists("bodycheck.reference.chapter.orientation.no_such_function")
    assert not exists("no-such-case")
    assert exists("free-brick")
    assert "test_no_such" not in known_tests("test_chapter.py")
