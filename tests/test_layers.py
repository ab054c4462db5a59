"""The folders depend on one another in one direction, and nothing heavy is imported before it is needed."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAY_IMPORT = {
    "reference": {"bodycheck.reference"},
    "adapters": {"bodycheck.reference", "bodycheck.adapters"},
    "reports": {
        *("bodycheck", "bodycheck.reference", "bodycheck.adapters.contract", "bodycheck.reports"),
        *("bodycheck.studies.ablation_rows",),
        *("bodycheck.studies.orders", "bodycheck.studies.recommendation", "bodycheck.studies.extreme_rows"),
        *("bodycheck.studies.release_rows",),
    },
    "studies": {"bodycheck", "bodycheck.reference", "bodycheck.adapters", "bodycheck.studies", "bodycheck.reports"},
    "harness": {"bodycheck", "bodycheck.reference", "bodycheck.adapters", "bodycheck.reports", "bodycheck.studies"},
}
"""Packages whose modules each folder may use, the most specific rule that fits a module deciding."""

SIMULATING = {"bodycheck.campaign", "bodycheck.simulation", "bodycheck.truths", "bodycheck.pool", "bodycheck.plan"}
ENGINES = {"mujoco", "pinocchio"}
COMMANDS = {"harness": "command_line", "studies": "commands"}
"""The only modules of these folders that know of reports, and the only one of the harness that knows of studies."""


def imports(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def engine_of(path: Path) -> str:
    """The engine that a file of an adapter is named after: `engine.py`, `engine_part.py`."""
    return path.stem.partition("_")[0]


def belongs(module: str, packages: set[str]) -> bool:
    layers = tuple(f"bodycheck.{folder}" for folder in ("reference", "adapters", "reports", "cases", "studies"))
    layer = next((layer for layer in layers if f"{module}.".startswith(f"{layer}.")), "bodycheck")
    exact = packages - {"bodycheck"}
    return layer in packages or any(f"{module}.".startswith(f"{package}.") for package in exact)


@pytest.mark.parametrize("folder", MAY_IMPORT)
def test_dependencies_point_one_way(folder: str) -> None:
    modules = list((ROOT / folder).glob("*.py"))
    assert modules
    for path in modules:
        for module in imports(path):
            if module.split(".")[0] == "bodycheck":
                assert belongs(module, MAY_IMPORT[folder]), f"{path} imports {module}"
            if folder != "adapters" or engine_of(path) not in ENGINES:
                assert module.split(".")[0] not in ENGINES, f"{path} imports an engine"
            if folder == "reports":
                assert not any(module.startswith(name) for name in SIMULATING), f"{path} simulates"
            if folder in COMMANDS and path.stem != COMMANDS[folder]:
                assert not module.startswith("bodycheck.reports"), f"{path} knows of reports"
                assert folder == "studies" or not module.startswith("bodycheck.studies"), f"{path} knows of studies"


def test_an_adapter_knows_no_other_engine() -> None:
    for path in (ROOT / "adapters").glob("*.py"):
        used = {module.split(".")[0] for module in imports(path)} & ENGINES
        assert used <= {engine_of(path)}, f"{path} imports an engine that it is not named after"
