"""The lines of the product that the tests reached, by room, from what `coverage run` has measured in all processes.

python -m tests.support.coverage_by_room            a line a room
python -m tests.support.coverage_by_room --missed   and the lines of each module that no test reached
"""

import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from coverage import Coverage

from tests.support import ROOT

#: The folders of the product whose subfolders are not rooms of their own.
ROOMS = ("reference", "adapters", "reports")


def room_of(path: Path) -> str:
    """Return the room of a module, by its path in the checkout; loose modules of `bodycheck` are a room together."""
    return path.parts[0] if path.parts[0] in ROOMS or len(path.parts) == 2 else path.parts[1]


def modules(measured: Coverage) -> Iterator[tuple[Path, set[int], list[int]]]:
    """Yield each module of the product, by its path in the checkout, its lines with code, and those that were not reached."""
    for folder in ("bodycheck", *ROOMS):
        for path in sorted((ROOT / folder).rglob("*.py")):  # links to rooms are not followed
            _, lines, _, missed, _ = measured.analysis2(str(path))
            yield path.relative_to(ROOT), set(lines), missed


def main(with_missed: bool) -> None:
    """Combine what the processes of the tests have measured, and print the shares of the lines that they reached."""
    measured = Coverage(config_file=str(ROOT / "pyproject.toml"))
    if any((ROOT / "build" / "coverage").glob("lines.*")):
        measured.combine()  # the file of each process is removed
        measured.save()
    else:
        measured.load()
    counts: defaultdict[str, list[int]] = defaultdict(lambda: [0, 0])
    for path, lines, missed in modules(measured):
        for room in (room_of(path), "all"):
            counts[room][0] += len(lines)
            counts[room][1] += len(lines) - len(missed)
        if with_missed and missed:
            print(f"{path}: {', '.join(map(str, missed))}")
    print(f"{'room':14} {'lines':>6} {'reached':>8}")
    for room, (lines, reached) in sorted(counts.items(), key=lambda entry: (entry[0] == "all", entry[0])):
        print(f"{room:14} {lines:6} {100 * reached / lines if lines else 100:7.1f}%")


if __name__ == "__main__":
    main("--missed" in sys.argv[1:])
