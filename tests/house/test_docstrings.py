"""Docstrings open with a verb or a noun and not with a question word.

A function begins with an imperative ("Return ..."), a property, class or module with a noun phrase ("The ...", "True if ...").
`question_docstrings.json` has, for each folder, how many docstrings open with a question word instead. No count may grow, and a
new folder has none. Where counts have shrunk or a folder has moved, this renews them:

    python -m tests.house.test_docstrings
"""

import ast
import json
import re
from collections import Counter
from pathlib import Path

from tests.support import ROOT

#: The words with which no docstring opens.
QUESTION = re.compile(r"(?:What|How|Whether|Where|Which)\b")

#: The file with the counts.
COUNTS = Path(__file__).with_name("question_docstrings.json")

#: The folders with the code of the product and of its documentation.
FOLDERS = ("bodycheck", "reference", "adapters", "reports", "docs")


def questions(source: str) -> int:
    """Count the docstrings of a module that open with a question word."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    texts = (ast.get_docstring(node) for node in ast.walk(ast.parse(source)) if isinstance(node, documented))
    return sum(bool(text and QUESTION.match(text)) for text in texts)


def counts(root: Path) -> dict[str, int]:
    """Return the counts of all folders of a checkout that have any, by their paths."""
    by_folder: Counter[str] = Counter()
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.py")):
            by_folder[path.parent.relative_to(root).as_posix()] += questions(path.read_text("utf-8"))
    return {folder: count for folder, count in by_folder.items() if count}


def grown(before: dict[str, int], after: dict[str, int]) -> list[str]:
    """Return a line for each folder with more such docstrings than before."""
    return [
        f"{folder}: {count} docstrings open with a question word, {before.get(folder, 0)} before"
        for folder, count in after.items()
        if count > before.get(folder, 0)
    ]


def test_no_folder_has_more_docstrings_that_open_with_a_question_word_than_before() -> None:
    assert grown(json.loads(COUNTS.read_text("utf-8")), counts(ROOT)) == []


def test_a_docstring_that_opens_with_a_question_word_is_counted() -> None:
    source = '"""What it is."""\ndef size():\n    """\n    Whether it is large.\n    """\nclass Whole:\n    """Whatever."""\n'
    assert questions(source) == 2
    assert grown({"a": 1}, {"a": 2, "b": 1}) == [
        "a: 2 docstrings open with a question word, 1 before",
        "b: 1 docstrings open with a question word, 0 before",
    ]


if __name__ == "__main__":
    lines = ",\n".join(f"{json.dumps(folder)}: {count}" for folder, count in counts(ROOT).items())
    COUNTS.write_text(f"{{\n{lines}\n}}\n", "utf-8")
