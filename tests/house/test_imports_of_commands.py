"""Commands and their worker processes import what is large only where they need it."""

import subprocess
import sys

import pytest

from bodycheck import load
from bodycheck.adapters.contract import Method
from bodycheck.processes import pool
from bodycheck.running import engines
from bodycheck.running.tasks import Task, TruthTask, group
from tests.support.calls import performed
from tests.support.commands import bodycheck_process

#: Prints the names of all imported modules at the end of a command.
LISTED = """
import atexit, os, sys
atexit.register(lambda: print("imported:", *(name for name, module in sys.modules.items() if module), file=sys.stderr))
"""

ENGINES = {"mujoco", "pinocchio"}

#: What no command and no worker process needs for a free body.
NEVER = {"dask", "distributed", "duckdb", "matplotlib", "pandas", "sympy"}

#: What makes files and pages.
FILES = {"bodycheck.reports.html", "jinja2", "pyarrow", "vl_convert"}

#: What reads case files.
READING = {"bodycheck.casefile.case", "bodycheck.running.campaign", "pydantic", "tree_sitter"}

#: What computes truths.
TRUTH = {"bodycheck.reference.truth", "bodycheck.reference.mechanisms.truth", "heyoka", "scipy"}


def by_command(*arguments: object) -> set[str]:
    """The modules that the process of a command has imported when it ends."""
    done = bodycheck_process(*arguments, prelude=LISTED)
    assert done.returncode == 0, done.stderr
    (line,) = (line for line in done.stderr.splitlines() if line.startswith("imported:"))
    return set(line.split())


def by_worker(argument: Task | TruthTask) -> set[str]:
    """The modules that a worker process has imported when it has carried out a task."""
    with pool.Workers(performed, 1, 60.0, group=group, home=engines.home) as workers:
        modules = workers.call(argument)
    assert isinstance(modules, set)
    return modules


def test_the_python_function_is_ready_before_anything_large_is_imported() -> None:
    code = "import sys, bodycheck; bodycheck.run; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    imported = set(done.stdout.split())
    assert "bodycheck.interface.runs" in imported
    others = {"cyclopts", "rich", "packaging.requirements", "ssl", "urllib.request"}
    assert imported & (NEVER | FILES | TRUTH | ENGINES | others) == set()


def test_help_imports_nothing_that_computes() -> None:
    imported = by_command("--help")
    assert "bodycheck.commands.command_line" in imported
    others = {"mpmath", "numpy", "packaging", "importlib.metadata"}
    assert imported & (NEVER | FILES | READING | TRUTH | ENGINES | others) == set()


def test_truth_computes_in_its_worker_alone() -> None:
    imported = by_command("truth", "intermediate-axis-flip")
    assert "bodycheck.console.truths" in imported
    assert imported & (NEVER | FILES | TRUTH | ENGINES) == set()


def test_run_computes_in_workers_alone() -> None:
    imported = by_command("run", "free-brick", "--engine", "mujoco", "--integrator", "Euler", "--quiet")
    assert "bodycheck.running.campaign" in imported
    assert imported & (NEVER | ENGINES | {"heyoka"}) == set()


@pytest.mark.parametrize("engine", sorted(ENGINES))
def test_a_worker_of_an_engine_needs_neither_the_truth_nor_files(engine: str) -> None:
    case = load("intermediate-axis-flip")
    method = Method.parse({"mujoco": "Euler", "pinocchio": "rk4"}[engine], 0.01)
    imported = by_worker(Task(case, engine, method))
    assert engine in imported
    assert imported & (NEVER | FILES | READING | TRUTH | {"mpmath"} | (ENGINES - {engine})) == set()


def test_a_worker_of_the_truth_needs_neither_engines_nor_files() -> None:
    imported = by_worker(TruthTask(load("intermediate-axis-flip"), (0.01,)))
    assert "bodycheck.reference.truth" in imported
    assert imported & (NEVER | FILES | READING | ENGINES) == set()
