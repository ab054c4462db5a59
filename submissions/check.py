"""Check the submissions in this folder: that the site shows each of them, and that together they are not too large.

    python submissions/check.py

Exit codes: 0 all are shown; 1 something is left out, or there is too much.
"""

import sys
from pathlib import Path

from bodycheck.site.submissions import gathering

HERE = Path(__file__).resolve().parent

#: Most bytes of all files in this folder.
MOST_BYTES = 20_000_000

#: What may be in this folder besides submissions.
OTHERS = {"README.md", "renew.py", "check.py", "__pycache__"}


def main() -> int:
    """Print what is wrong, and return the exit code."""
    found, left_out = gathering.gathered([HERE])
    faults = [f"submissions/{one.name}: {one.reason}" for one in left_out]
    faults += [f"submissions/{path.name}: is no submission" for path in unknown()]
    size = sum(path.stat().st_size for path in HERE.iterdir())
    if size > MOST_BYTES:
        faults.append(f"submissions: has {size} bytes; at most {MOST_BYTES} are allowed")
    print("\n".join(faults) or f"submissions: all {len(found)} are shown, {size / 1e6:.1f} MB")
    return 1 if faults else 0


def unknown() -> list[Path]:
    """Return what is in the folder and is no submission."""
    return [path for path in sorted(HERE.iterdir()) if path.suffix != ".zip" and path.name not in OTHERS]


if __name__ == "__main__":
    sys.exit(main())
