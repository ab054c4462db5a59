"""Wheels of a miniature engine's package, in any number of versions, written by hand: a folder of them is an index.

The package is `toy-engine`, its module `toy_engine`; the plug-in that knows it is written beside, as an installed one.
"""

import base64
import hashlib
import zipfile
from pathlib import Path

PLUGIN = '''
"""An adapter whose engine's package says how wrong it is. As a program it tells what is imported from where."""
import importlib
import json
import sys
from dataclasses import replace

import toy_engine
from bodycheck.adapters.contract import Engine
from miniature import Miniature, drifting, exact, wrong


class Toy(Miniature):
    @property
    def engine(self) -> Engine:
        return replace(super().engine, distribution="toy_engine", version=toy_engine.__version__)


ADAPTER = Toy("toy", {"exact": exact, "drifting": drifting, "wrong": wrong}[toy_engine.KIND])

if __name__ == "__main__":
    modules = {name: importlib.import_module(name) for name in sys.argv[1:]}
    print(json.dumps({name: [getattr(module, "__version__", ""), module.__file__] for name, module in modules.items()}))
'''

ENTRY_POINTS = """
[bodycheck.engines]
toy = toy_adapter:ADAPTER
[bodycheck.distributions]
toy = toy_engine
"""


def wheel(folder: Path, version: str, body: str = 'KIND = "exact"', requires: tuple[str, ...] = ()) -> Path:
    """A wheel of the engine's package; body: of its module, requires: what it depends on."""
    info = f"toy_engine-{version}.dist-info"
    needs = "".join(f"Requires-Dist: {need}\n" for need in requires)
    files = {
        "toy_engine.py": f'__version__ = "{version}"\n{body}\n',
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: toy-engine\nVersion: {version}\n{needs}",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: tests\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    records = [f"{name},sha256={digest(text)},{len(text.encode())}" for name, text in files.items()]
    files[f"{info}/RECORD"] = "\n".join([*records, f"{info}/RECORD,,", ""])
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"toy_engine-{version}-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return path


def index(folder: Path, wheel: Path) -> None:
    """A package index that has one wheel of the engine's package."""
    page = folder / "toy-engine" / "index.html"
    page.parent.mkdir(parents=True)
    page.write_text(f'<!DOCTYPE html><a href="{wheel.as_uri()}">{wheel.name}</a>')


def install(folder: Path, version: str) -> None:
    """The package as it is where it was installed."""
    with zipfile.ZipFile(wheel(folder / "wheel", version)) as archive:
        archive.extractall(folder)


def digest(text: str) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).rstrip(b"=").decode()


def plugin(folder: Path) -> None:
    """The adapter of the package as another package has it."""
    info = folder / "toy_adapter-1.0.dist-info"
    info.mkdir(parents=True)
    (folder / "toy_adapter.py").write_text(PLUGIN)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: toy-adapter\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(ENTRY_POINTS)
