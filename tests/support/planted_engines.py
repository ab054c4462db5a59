"""Engines that a test writes: a module and the entry point by which it is found."""

from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path

#: A module that is an adapter, up to what its engine is: `RECORD` is the record of an engine that works.
ADAPTER = """
from bodycheck.adapters.contract import Engine, Integrator
from bodycheck.adapters.stepping import InTurn

RECORD = Engine("{name}", "planted", "1.0", (Integrator("step"),), frozenset())
engine = RECORD

def prepare(scenes, method):
    return InTurn(())
"""


#: What the module of an engine does that has an adapter and is not installed.
UNINSTALLED = "import no_such_engine"


def plant(folder: Path, engines: Mapping[str, str]) -> None:
    """Write engines into a folder for the path: by their names, what their modules do besides being adapters.

    The names of the modules depend on the folder, because a process imports a module of one name once.
    """
    module = f"planted_{sha256(str(folder).encode()).hexdigest()[:12]}"
    info = folder / "planted-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: planted\nVersion: 1.0\n", "utf-8")
    points = [f"{name} = {module}_{place}" for place, name in enumerate(engines)]
    (info / "entry_points.txt").write_text("\n".join(["[bodycheck.engines]", *points, ""]), "utf-8")
    for place, (name, code) in enumerate(engines.items()):
        (folder / f"{module}_{place}.py").write_text(ADAPTER.format(name=name) + code, "utf-8")
