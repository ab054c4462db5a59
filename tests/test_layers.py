"""The folders depend on one another in one direction, and nothing heavy is imported before it is needed."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAY_IMPORT = {
    "reference": {"bodycheck.reference"},
    "adapters": {"bodycheck.reference", "bodycheck.adapters"},
    "reports": {"bodycheck", "bodycheck.reference", "bodycheck.adapters.contract", "bodycheck.reports"},
    "harness": {"bodycheck", "bodycheck.reference", "bodycheck.adapters", "bodycheck.reports"},
}
"""Packages whose modules each folder may use, the most specific rule that fits a module deciding."""

SIMULATING = {"bodycheck.campaign", "bodycheck.simulation", "bodycheck.truths", "bodycheck.pool", "bodycheck.plan"}
ENGINES = {"mujoco", "pinocchio"}
WITH_REPORTS = {"command_line"}
"""The only module of the harness that knows of reports."""


def imports(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def belongs(module: str, packages: set[str]) -> bool:
    layers = ("bodycheck.reference", "bodycheck.adapters", "bodycheck.reports", "bodycheck.cases")
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
            if folder != "adapters" or path.stem not in ENGINES:
                assert module.split(".")[0] not in ENGINES, f"{path} imports an engine"
            if folder == "reports":
                assert not any(module.startswith(name) for name in SIMULATING), f"{path} simulates"
            if folder == "harness" and path.stem not in WITH_REPORTS:
                assert not module.startswith("bodycheck.reports"), f"{path} knows of reports"


def test_an_adapter_knows_no_other_engine() -> None:
    for engine in ENGINES:
        used = {module.split(".")[0] for module in imports(ROOT / "adapters" / f"{engine}.py")}
        assert used & ENGINES == {engine}
