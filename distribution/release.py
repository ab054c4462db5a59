"""Build the distributions of bodycheck and pytest-bodycheck into `dist/`, check them, and try them as users do.

    python -m distribution.release [--try INTERPRETER ...]

They are built from the last commit: what is not committed is left out. Everything is built twice, in two copies of the commit
in different folders, and must have the same bytes. Then the wheels are installed in a new environment of each interpreter (that
of the running Python if none is named), where the commands of `trial.py` run in another folder; the first environment also
follows the tutorial. Packages that they depend on come from wherever pip gets them.
"""

import argparse
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from distribution import building, checking, trial

ROOT = Path(__file__).parents[1]
DIST = ROOT / "dist"


def main() -> None:
    parser = argparse.ArgumentParser(description="Build, check and try the distributions of the last commit.")
    parser.add_argument("--try", dest="interpreters", nargs="+", type=named, default=[Path(sys.executable)], metavar="PYTHON")
    interpreters: list[Path] = parser.parse_args().interpreters
    version = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    if uncommitted := _git("status", "--porcelain").splitlines():
        print(f"left out, since it is not committed: {len(uncommitted)} files, such as {uncommitted[0][3:]}")
    with tempfile.TemporaryDirectory() as folder:
        built = building.twice(ROOT, Path(folder))
        if faults := checking.faults(built, version):
            sys.exit("\n".join(faults))
        DIST.mkdir(exist_ok=True)
        for old in DIST.iterdir():
            old.unlink()
        for file in built:
            (DIST / file.name).write_bytes(file.read_bytes())
            print(f"dist/{file.name}: {file.stat().st_size / 1e6:.2f} MB, sha256 {building.digest(file)}")
        for number, python in enumerate(interpreters):
            place = Path(folder, f"trial {number}")
            place.mkdir()
            checkout = building.checkout(Path(folder)) if number == 0 else None
            print(trial.tried(python, sorted(DIST.glob("*.whl")), place, checkout), flush=True)


def named(interpreter: str) -> Path:
    """Return an interpreter that can be called from any folder: a path is made absolute, and a name alone is found on PATH."""
    path = Path(interpreter)
    return path if path.name == interpreter else path.absolute()  # links are kept: an environment's interpreter is one


def _git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    main()
