"""Measure what each package of an installation takes on disk, for the table in `docs/start/install.md`.

    python -m distribution.size [EXTRA ...]

Installs the bodycheck of this checkout, with the extras that are named, into a new environment by uv, without compiled modules.
Prints for each distribution its size in MB of 10^6 bytes, by the blocks that `du` counts, and which distributions need it.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from importlib.metadata import Distribution, distributions
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from uv import find_uv_bin

from distribution import building

ROOT = Path(__file__).parents[1]


def main() -> None:
    extras = f"[{','.join(sys.argv[1:])}]" if sys.argv[1:] else ""
    with tempfile.TemporaryDirectory() as folder:
        uv, place = find_uv_bin(), Path(folder, "environment")
        wheel = building.build("build_wheel", Path(folder), ROOT)
        subprocess.run([uv, "venv", "--quiet", "--no-project", "--python", sys.executable, str(place)], check=True)
        subprocess.run(
            [uv, "pip", "install", "--quiet", "--python", str(place), f"bodycheck{extras} @ {wheel.as_uri()}"], check=True
        )
        (packages,) = (*place.glob("lib/*/site-packages"), *place.glob("Lib/site-packages"))
        installed = list(distributions(path=[str(packages)]))
        sizes = {each.name: size(each) for each in installed}
        for name, taken in sorted(sizes.items(), key=lambda pair: -pair[1]):
            print(f"{taken / 1e6:7.1f} MB  {name}: needed by {', '.join(needed_by(name, installed)) or 'nothing'}")
        whole = sum(on_disk(path) for path in place.rglob("*"))
        print(f"{whole / 1e6:7.1f} MB  in all, of which {sum(sizes.values()) / 1e6:.1f} MB are files of distributions")


def size(distribution: Distribution) -> int:
    """Return the bytes that the files of a distribution take on the disk."""
    return sum(on_disk(Path(str(file.locate()))) for file in distribution.files or ())


def on_disk(path: Path) -> int:
    """Return the bytes of the blocks of a file or link, 0 for what is missing or a folder."""
    return path.lstat().st_blocks * 512 if os.path.lexists(path) and not path.is_dir() else 0


def needed_by(name: str, installed: list[Distribution]) -> Iterator[str]:
    """Yield the distributions that need another one in this environment, without extras."""
    for each in installed:
        needed = map(Requirement, each.requires or ())
        plain = (one for one in needed if one.marker is None or one.marker.evaluate({"extra": ""}))
        if canonicalize_name(name) in {canonicalize_name(one.name) for one in plain}:
            yield each.name


if __name__ == "__main__":
    main()
