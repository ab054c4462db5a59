"""Rooms depend on one another in one direction, and nothing heavy is imported before it is needed."""

import ast
import runpy
import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.support import ROOT

#: Rooms and modules of `bodycheck`, from the lowest floor up. A room imports from itself and from floors below its own.
FLOORS = (
    {"reference", "errors", "runner_log", "suggestion"},
    {"adapters", "conversion", "figures", "files"},
    {"robots"},
    {"casefile", "environments"},
    {"processes"},
    {"results"},
    {"running"},
    {"judging"},
    {"reports", "console"},
    {"interface"},
    {"studies"},
    {"site"},
    {"commands", "pytest_plugin"},
    {"__main__", "__init__"},
)


def rooms(root: Path) -> dict[str, Path]:
    """Every room of a checkout by its name: the folders and modules of `bodycheck`, links followed."""
    return {path.stem: path.resolve() for path in (root / "bodycheck").iterdir() if path.suffix == ".py" or path.is_dir()}


def modules(room: Path) -> list[Path]:
    """All modules of a room, at any depth."""
    return [room] if room.is_file() else sorted(room.rglob("*.py"))


def imports(path: Path) -> list[str]:
    """The dotted names that a module imports, wherever in it."""
    names = []
    for node in nodes(path.read_text("utf-8")):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        else:
            assert node.level == 0, f"{path}: relative import"
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return names


@cache
def nodes(source: str) -> list[ast.Import | ast.ImportFrom]:
    """The imports of a module. A copy of a checkout is not parsed again."""
    return [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Import | ast.ImportFrom)]


def engine_modules(root: Path) -> dict[str, set[str]]:
    """The modules of engines, and the folders of the adapters that import them, as each folder's `INSTALLATION` says."""
    importers: dict[str, set[str]] = {}
    for path in sorted((root / "adapters").glob("*/__init__.py")):
        for module in runpy.run_path(str(path))["INSTALLATION"].imported:
            importers.setdefault(module, set()).add(path.parent.name)
    return importers


def floor(room: str) -> int:
    return next(number for number, those in enumerate(FLOORS) if room in those)


def faults(root: Path) -> list[str]:
    """Every import of a checkout that goes up, or sideways into another room, and every room without a floor."""
    faults_seen = []
    folders, engines = rooms(root), engine_modules(root)
    for room, folder in folders.items():
        if room in ("cases", "__pycache__"):  # data
            continue
        if not any(room in those for those in FLOORS):
            faults_seen.append(f"{folder}: has no floor")
            continue
        for path in modules(folder):
            for module in imports(path):
                package, _, rest = module.partition(".")
                other = rest.partition(".")[0] or "__init__"  # the package itself is the highest floor
                if package == "bodycheck" and other != room and other in folders and floor(other) >= floor(room):
                    faults_seen.append(f"{path}: imports {module}")
                if package in engines and path.parent.name not in engines[package]:
                    faults_seen.append(f"{path}: imports the engine {package}")
    return faults_seen


def graph(root: Path) -> dict[str, set[str]]:
    """The modules of a checkout, and those that each one imports: at once, in a function, or for types alone.

    A name that is imported from a package is the module of this name if there is one, and else something in its `__init__`.
    """
    paths = {}
    for room, folder in rooms(root).items():
        for path in modules(folder) if room != "cases" else ():
            inside = path.relative_to(folder).with_suffix("").parts if folder.is_dir() else ()
            parts = ("bodycheck", room, *inside)
            paths[".".join(part for part in parts if part != "__init__")] = path
    imported = {}
    for name, path in paths.items():
        leaves = {module if module in paths else module.rpartition(".")[0] for module in imports(path)}
        imported[name] = (leaves & paths.keys()) - {name}
    return imported


def circles(root: Path) -> list[tuple[str, ...]]:
    """Every set of modules of a checkout that import one another by detours: the strongly connected components, sorted."""
    imported = graph(root)
    reachable = {name: reached(name, imported) for name in imported}
    return sorted({tuple(sorted(other for other in reachable[name] if name in reachable[other])) for name in imported} - {()})


def reached(name: str, imported: dict[str, set[str]]) -> set[str]:
    """The modules that one imports, directly or by others."""
    reached_modules: set[str] = set()
    waiting = list(imported[name])
    while waiting:
        module = waiting.pop()
        if module not in reached_modules:
            reached_modules.add(module)
            waiting += imported[module]
    return reached_modules


def test_every_import_goes_down() -> None:
    assert faults(ROOT) == []


def test_what_an_engine_is_imported_by_is_known() -> None:
    """Two engines whose modules are named otherwise than their packages, and one that shares its own with others."""
    importers = engine_modules(ROOT)
    assert importers["pydrake"] == {"drake"}
    assert importers["opensim"] == {"simbody"}
    assert importers["mujoco"] == {"brax", "mjx", "mjx32", "mujoco", "mujoco_warp"}
    imported = {
        name.partition(".")[0]
        for folder in (ROOT / "adapters").glob("*/")
        for path in modules(folder)
        for name in imports(path)
    }
    assert importers.keys() <= imported


def test_a_new_engine_is_its_folder(checkout: Path) -> None:
    """Nothing else is edited: what a planted folder says of its modules keeps all others from importing them."""
    folder, elsewhere = checkout / "adapters" / "planted", checkout / "bodycheck" / "judging" / "planted.py"
    folder.mkdir()
    (folder / "__init__.py").write_text(
        "from bodycheck.adapters.installation import Installation\n\nINSTALLATION = Installation('planted-engine')\n"
    )
    (folder / "engine.py").write_text("import planted_engine\n")
    try:
        assert faults(checkout) == []
        elsewhere.write_text("import planted_engine\n")
        assert faults(checkout) == [f"{elsewhere.resolve()}: imports the engine planted_engine"]
    finally:
        shutil.rmtree(folder)
        elsewhere.unlink(missing_ok=True)


def test_no_module_imports_itself_by_a_detour() -> None:
    assert len(graph(ROOT)) > 150
    assert circles(ROOT) == []


def test_the_frame_of_reports_imports_no_report_of_runs() -> None:
    """The frame serves studies too. Only its entry points, in `__init__`, bring both together."""
    frame = [path for path in (ROOT / "reports").glob("*.py") if path.name != "__init__.py"]
    assert frame
    assert not [path.name for path in frame for name in imports(path) if name.startswith("bodycheck.reports.runs")]


def test_no_test_module_imports_another() -> None:
    """What several of them share is in `tests/support/`."""
    modules_of_tests = [path for path in (ROOT / "tests").rglob("*.py") if path.name.startswith("test_")]
    assert len(modules_of_tests) > 50
    imported = [(path.name, name) for path in modules_of_tests for name in imports(path)]
    assert not [(path, name) for path, name in imported if name.startswith("tests.") and ".test_" in name]
    assert ("test_layers.py", "tests.support.ROOT") in imported


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the checkout, to plant imports in."""
    copy = tmp_path_factory.mktemp("checkout")
    for folder in ("bodycheck", "reference", "adapters", "reports", "cases"):
        shutil.copytree(ROOT / folder, copy / folder, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
    assert faults(copy) == []
    return copy


@pytest.fixture
def planted(checkout: Path, file: str, line: str) -> Iterator[Path]:
    """A module of that copy which contains one line, for the time of a test."""
    path = checkout / file
    made = next(folder for folder in reversed(path.parents) if not folder.exists())
    path.parent.mkdir(parents=True)
    path.write_text(line + "\n")
    yield path
    shutil.rmtree(made)


@pytest.mark.parametrize(
    ("file", "line", "fault"),
    [
        (
            "reference/sliding/planted/deep/upward.py",
            "from bodycheck.processes import pool",
            "imports bodycheck.processes.pool",
        ),
        (
            "bodycheck/studies/tradeoff/planted/upward.py",
            "from bodycheck.commands.command_line import app",
            "imports bodycheck.commands.command_line.app",
        ),
        ("bodycheck/judging/planted/a/b/engine.py", "import mujoco", "imports the engine mujoco"),
        ("bodycheck/newroom/module.py", "import math", "has no floor"),
        (
            "bodycheck/results/planted/late.py",
            "def late() -> None:\n    from bodycheck.running import plan",
            "imports bodycheck.running.plan",
        ),
        (
            "bodycheck/results/planted/types.py",
            "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    from bodycheck.running.plan import plan",
            "imports bodycheck.running.plan.plan",
        ),
        ("bodycheck/studies/planted/package.py", "import bodycheck", "imports bodycheck"),
    ],
)
def test_a_planted_import_is_found(planted: Path, checkout: Path, fault: str) -> None:
    place = planted.parent if fault == "has no floor" else planted
    assert faults(checkout) == [f"{place.resolve()}: {fault}"]


@pytest.mark.parametrize(
    "line",
    [
        "from bodycheck.running import pairing",
        "def late() -> None:\n    from bodycheck.running import pairing",
        "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    from bodycheck.running.pairing import Pair",
    ],
    ids=["at once", "late", "for types alone"],
)
def test_a_planted_circle_is_found(checkout: Path, line: str) -> None:
    """A module that `pairing` imports imports it in turn."""
    path = checkout / "bodycheck/running/instants.py"
    pairing = checkout / "bodycheck/running/pairing.py"
    contents, others = path.read_text("utf-8"), pairing.read_text("utf-8")
    path.write_text(f"{contents}\n\n{line}\n", "utf-8")
    pairing.write_text(f"{others}\n\nfrom bodycheck.running import instants\n", "utf-8")
    try:
        assert any({"bodycheck.running.instants", "bodycheck.running.pairing"} <= set(circle) for circle in circles(checkout))
    finally:
        path.write_text(contents, "utf-8")
        pairing.write_text(others, "utf-8")
