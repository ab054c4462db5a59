"""Worker processes keep bytecode in the cache folder where Python writes none, and nobody else can change it."""

import sys
from importlib.util import cache_from_source
from pathlib import Path

import pytest

from bodycheck.environments import privacy
from bodycheck.processes import interpreter, pool

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="folders have no permissions there")


def prefix(question: object) -> str | None:
    """Where the process that is asked keeps bytecode; None where that is beside the modules."""
    return sys.pycache_prefix


def asked() -> str | None:
    """The answer of a worker process to `prefix`."""
    with pool.Workers(prefix, 1, 60.0) as workers:
        answer = workers.call(None)
    assert answer is None or isinstance(answer, str)
    return answer


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The cache folder of a Python that writes no bytecode, and whose modules were not compiled when they were installed."""
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path))
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.setattr(interpreter, "__file__", str(tmp_path / "interpreter.py"))
    return tmp_path


def test_workers_keep_bytecode_that_python_does_not_write(cache: Path) -> None:
    assert asked() == str(cache / "bytecode")
    compiled = [path.name.partition(".")[0] for path in cache.rglob("*.pyc")]
    assert {"pool", "worker", "channel"} <= set(compiled)
    assert privacy.is_closed(cache / "bytecode")


def test_workers_use_the_bytecode_of_compiled_modules(cache: Path) -> None:
    compiled = Path(cache_from_source(str(cache / "interpreter.py")))
    compiled.parent.mkdir()
    compiled.touch()
    assert asked() is None
    assert not (cache / "bytecode").exists()


def test_workers_leave_bytecode_to_a_python_that_writes_it(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    assert interpreter.bytecode_folder() is None


@pytest.mark.parametrize("mode", [0o770, 0o707, 0o755])
def test_a_folder_that_is_open_to_others_is_not_used(cache: Path, mode: int) -> None:
    (cache / "bytecode").mkdir()
    (cache / "bytecode").chmod(mode)
    assert asked() is None
    assert not list(cache.rglob("*.pyc"))


def test_workers_start_without_a_folder_for_bytecode(cache: Path) -> None:
    (cache / "bytecode").touch()
    assert asked() is None
