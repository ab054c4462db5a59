"""Rooms depend on one another in one direction, and nothing heavy is imported before it is needed."""

import ast
import shutil
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from tests.support import ROOT

#: Rooms and modules of `bodycheck`, from the lowest floor up. A room imports from itself and from floors below its own.
FLOORS = (
    {"reference", "errors", "runner_log", "suggestion"},
    {"adapters", "conversion", "figures", "files"},
    {"robots"},
    {"casefile", "environments"},
    {"running"},
    {"judging"},
    {"reports", "console"},
    {"studies"},
    {"site"},
    {"commands", "interface", "pytest_plugin"},
    {"__main__", "__init__"},
)

#: The packages of engines, and the folders of the adapters that import them, which nothing else does.
ENGINES = {
    "brax": {"brax"},
    "dartpy": {"dart"},
    "exudyn": {"exudyn"},
    "jax": {"brax", "mjx", "mjx32"},
    "mujoco": {"brax", "mjx", "mjx32", "mujoco", "mujoco_warp"},
    "mujoco_warp": {"mujoco_warp"},
    "newton": {"newton"},
    "opensim": {"simbody"},
    "pinocchio": {"pinocchio"},
    "pybullet": {"pybullet"},
    "pydrake": {"drake"},
    "rapier3d": {"rapier"},
    "sapien": {"sapien"},
    "warp": {"mujoco_warp", "newton"},
}


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


def floor(room: str) -> int:
    return next(number for number, those in enumerate(FLOORS) if room in those)


def faults(root: Path) -> list[str]:
    """Every import of a checkout that goes up, or sideways into another room, and every room without a floor."""
    found = []
    places = rooms(root)
    for room, place in places.items():
        if room in ("cases", "__pycache__"):  # data
            continue
        if not any(room in those for those in FLOORS):
            found.append(f"{place}: has no floor")
            continue
        for path in modules(place):
            for module in imports(path):
                package, _, rest = module.partition(".")
                other = rest.partition(".")[0]
                if package == "bodycheck" and other != room and other in places and floor(other) >= floor(room):
                    found.append(f"{path}: imports {module}")
                if package in ENGINES and path.parent.name not in ENGINES[package]:
                    found.append(f"{path}: imports the engine {package}")
    return found


def graph(root: Path) -> dict[str, set[str]]:
    """The modules of a checkout, and which of them each one imports at once: not later, and not for types alone."""
    names = {}
    for room, place in rooms(root).items():
        for path in modules(place) if room != "cases" else ():
            inside = path.relative_to(place).with_suffix("").parts if place.is_dir() else ()
            names[".".join(("bodycheck", room, *(part for part in inside if part != "__init__")))] = path
    found = {}
    for name, path in names.items():
        used = set()
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.ImportFrom):
                used |= {node.module or "", *(f"{node.module}.{alias.name}" for alias in node.names)}
        found[name] = (used & names.keys()) - {name}
    return found


def test_every_import_goes_down() -> None:
    assert faults(ROOT) == []


def test_no_module_imports_itself_by_a_detour() -> None:
    order = list(TopologicalSorter(graph(ROOT)).static_order())  # raises CycleError with the modules of a circle
    assert len(order) > 150
    with pytest.raises(CycleError):
        list(TopologicalSorter(graph(ROOT) | {order[0]: {order[-1]}, order[-1]: {order[0]}}).static_order())


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
        ("reference/sliding/planted/deep/upward.py", "from bodycheck.running import pool", "imports bodycheck.running.pool"),
        (
            "bodycheck/studies/tradeoff/planted/upward.py",
            "from bodycheck.commands.command_line import app",
            "imports bodycheck.commands.command_line.app",
        ),
        ("bodycheck/judging/planted/a/b/engine.py", "import mujoco", "imports the engine mujoco"),
        ("bodycheck/newroom/module.py", "import math", "has no floor"),
    ],
)
def test_a_planted_import_is_found(planted: Path, checkout: Path, fault: str) -> None:
    place = planted.parent if fault == "has no floor" else planted
    assert faults(checkout) == [f"{place.resolve()}: {fault}"]
