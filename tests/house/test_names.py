"""The names of variables and parameters say what they hold.

`vague_names.json` has, for each file, how many variables and parameters have a name that says something else: that a thing was
found, told or made, or that it has a place. No count may grow, and a new file has none. Where counts have shrunk or a file has
moved, this renews them:

    python -m tests.house.test_names
"""

import ast
import json
from collections import Counter
from pathlib import Path

from tests.support import ROOT

#: The names.
VAGUE = frozenset({"found", "own", "told", "made", "place", "of"})

#: The file with the counts.
COUNTS = Path(__file__).with_name("vague_names.json")

#: The folders with the code of the product.
FOLDERS = ("bodycheck", "reference", "adapters", "reports")


def vague_names(source: str) -> Counter[str]:
    """Count the variables and parameters of a module that have such a name."""
    names = (
        node.arg if isinstance(node, ast.arg) else node.id
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.arg) or (isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store))
    )
    return Counter(name for name in names if name in VAGUE)


def counts(root: Path) -> dict[str, dict[str, int]]:
    """Return the counts of all modules of a checkout that have any, by their paths."""
    paths = sorted(path for folder in FOLDERS for path in (root / folder).rglob("*.py"))
    by_path = {path.relative_to(root).as_posix(): dict(sorted(vague_names(path.read_text("utf-8")).items())) for path in paths}
    return {path: names for path, names in by_path.items() if names}


def grown(before: dict[str, dict[str, int]], after: dict[str, dict[str, int]]) -> list[str]:
    """Return a line for each name that a file has more often than before."""
    return [
        f"{path}: {name} is the name of {count} variables and parameters, {before.get(path, {}).get(name, 0)} before"
        for path, names in after.items()
        for name, count in names.items()
        if count > before.get(path, {}).get(name, 0)
    ]


def test_no_file_has_more_vague_names_than_before() -> None:
    assert grown(json.loads(COUNTS.read_text("utf-8")), counts(ROOT)) == []


def test_a_vague_name_is_counted() -> None:
    source = "def moments(of):\n    found = of.own\n    for place, mass in enumerate(of): found = mass\n"
    assert vague_names(source) == {"of": 1, "found": 2, "place": 1}
    assert grown({"a.py": {"found": 1}}, {"a.py": {"found": 2}, "b.py": {"own": 1}}) == [
        "a.py: found is the name of 2 variables and parameters, 1 before",
        "b.py: own is the name of 1 variables and parameters, 0 before",
    ]


if __name__ == "__main__":
    lines = ",\n".join(f"{json.dumps(path)}: {json.dumps(names)}" for path, names in counts(ROOT).items())
    COUNTS.write_text(f"{{\n{lines}\n}}\n", "utf-8")
