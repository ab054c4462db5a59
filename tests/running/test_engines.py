"""Engines that fail when they are imported or asked what they are: each is missing with the reason, and harms nothing."""

import subprocess
import sys
from pathlib import Path

import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Engine, Integrator
from bodycheck.adapters.registry import fault_of
from bodycheck.console.arguments import load_engines
from bodycheck.processes import pool
from bodycheck.processes.failures import TimedOut
from bodycheck.running import engines
from tests.support.cases import a_case, expecting
from tests.support.commands import bodycheck
from tests.support.planted_engines import plant
from tests.support.processes import calls_here

#: What the modules of engines do, and why they are missing.
FAILING = {
    "vanishing": ("import os; os._exit(0)", "fails when it is imported: its process exited with code 0"),
    "segfaulting": ("import ctypes; ctypes.string_at(0)", "fails when it is imported: its process died of signal SIGSEGV"),
    "raising": ("raise OSError('no card')", "cannot be imported: OSError: no card"),
    "exiting": ("raise SystemExit(0)", "cannot be imported: SystemExit: 0"),
    "misspelled": ("def :", "cannot be imported: SyntaxError: invalid syntax"),
    "unlinked": ("raise ImportError('libx.so')", "cannot be imported: libx.so"),
    "versionless": ("from dataclasses import replace; engine = replace(RECORD, version=None)", "does not say what it is: "),
    "recordless": ("engine = 7", "does not say what it is: its record is of the type int, not Engine"),
    "asking": (
        "class _A:\n    prepare = print\n    @property\n    def engine(self): raise RuntimeError('no')\n"
        "import sys; sys.modules[__name__] = _A()",
        "does not say what it is: RuntimeError: no",
    ),
}


@pytest.fixture
def planted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The failing engines, between two that work."""
    failing = {name: code for name, (code, _) in FAILING.items()}
    plant(tmp_path / "planted", {"first": "", **failing, "last": ""})
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(tmp_path / "planted")


#: These end their process, so that they are asked in one of their own.
DEADLY = ("vanishing", "segfaulting")


def test_an_engine_that_fails_at_import_is_missing_and_named(planted: None) -> None:
    found = engines.faults(["first", *DEADLY, "nobody"])
    with calls_here():
        found |= engines.faults([*(name for name in FAILING if name not in DEADLY), "last"])
    assert not found.pop("nobody").broken
    assert found.keys() == FAILING.keys()
    for name, (_, reason) in FAILING.items():
        assert found[name].reason.startswith(f"{name} {reason}"), found[name]
        assert found[name].broken
    assert registry.load("last").engine.version == "1.0"


def test_commands_go_on_without_a_failing_engine_unless_it_was_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plant(tmp_path / "planted", {"vanishing": FAILING["vanishing"][0]})
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(tmp_path / "planted")
    case = tmp_path / "spin.case.toml"
    case.write_text(a_case(expect=[expecting("vanishing", "step", 0.01, attitude_error=1.0)]), "utf-8")
    done = bodycheck("engines", COLUMNS="1000")
    assert done.returncode == 0
    assert "vanishing fails when it is imported: its process exited with code 0" in done.stdout
    assert "mujoco" in done.stdout
    only = bodycheck("run", case, "--engine", "vanishing")
    assert (only.returncode, only.stdout) == (1, "")
    assert "no engine can be used" in only.stderr
    both = bodycheck("run", case, "--engine", "vanishing", "--engine", "mujoco", "--integrator", "Euler", "--jobs", "1")
    assert (both.returncode, "mujoco" in both.stdout, "continuing without it" in both.stderr) == (1, True, True)
    unnamed = load_engines(())
    assert unnamed.failed([load(case)])
    assert not unnamed.failed([load("free-brick")])


def test_an_engine_that_hangs_at_import_is_stopped(planted: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """The limit itself is the pool's, whose tests hang for it."""

    def times_out(workers: pool.Workers[str, object], names: list[str]) -> object:
        yield from ((name, TimedOut(workers.limit)) for name in names)

    monkeypatch.setattr(pool.Workers, "map", times_out)
    fault = engines.faults(["first"])["first"]
    assert fault == engines.Fault("first fails when it is imported: stopped after 120 s", broken=True)


def test_a_record_is_asked_once_until_the_engine_changes(
    planted: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, missing = engines.describe(["first", "last"])
    assert not missing
    assert first["first"].integrators == (Integrator("step"),)
    monkeypatch.setattr(engines, "_known", {})  # as in another process
    with monkeypatch.context() as patch:
        patch.setattr(pool.Workers, "map", lambda workers, names: asked.extend(names) or (_ for _ in ()))
        asked: list[str] = []
        assert engines.describe(["first", "last"])[0] == first
        assert not asked
    (module,) = (tmp_path / "planted").glob("planted_*_0.py")
    module.write_text(module.read_text("utf-8").replace('"1.0"', '"2.0"'), "utf-8")
    assert engines.describe(["first", "last"])[0]["first"].version == "2.0"


def test_no_engine_is_imported_by_a_command_that_runs_it() -> None:
    code = (
        "import sys\nfrom bodycheck.commands.command_line import app\n"
        "app(['run', 'free-brick', '--engine', 'mujoco', '--integrator', 'Euler', '--timestep', '0.1'],"
        " exit_on_error=False, result_action='return_value')\n"
        "app(['engines'], exit_on_error=False, result_action='return_value')\n"
        "print({'mujoco', 'pinocchio'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "set()"


def test_a_process_of_an_engine_imports_nothing_that_reads_files() -> None:
    """That takes longer than all that it needs."""
    heavy = {"bodycheck.casefile.case", "bodycheck.running.campaign", "pyarrow", "pydantic", "tree_sitter"}
    code = (
        "import sys\nfrom bodycheck.processes import worker\n"
        "from bodycheck.running import simulation, tasks, truths\n"
        f"print({heavy} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_a_process_of_an_engine_imports_no_scipy() -> None:
    """The motion of bodies that touch needs it, and only with such bodies must a process of an engine know that motion."""
    code = (
        "import sys\nfrom bodycheck.processes import worker\nfrom bodycheck.running import simulation, tasks\n"
        "from bodycheck.running.tasks import import_engine\nimport_engine('mujoco')\nprint('scipy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


@pytest.mark.parametrize(
    ("engine", "fault"),
    [
        (Engine("e", "d", "1", (Integrator("=1+1"),), frozenset()), "an integrator is named '=1\\+1', not by text"),
        (Engine("e", "d", "1", (Integrator("x" * 101),), frozenset()), "an integrator is named 'xxx"),
        (Engine("e", "d", "1", (Integrator("\udcff"),), frozenset()), r"an integrator is named '\\udcff'"),
        (Engine("e", "d", "1", ("Euler",), frozenset()), "its integrators are"),  # type: ignore[arg-type]
        (Engine("e", "d", "1", (Integrator("a", demonstrates="b\n"),), frozenset()), "its integrator a demonstrates 'b"),
        (Engine("e", "d", "1", (), frozenset(), batch=0), "its batch is 0"),
        (
            Engine("e", "d", "1", (), frozenset(), varies=frozenset({"mass"})),
            "its varies is .*, not a frozenset of body, gravity",
        ),  # type: ignore[arg-type]
        (Engine("e", "d", "1", (), frozenset(), variants={"flight": ("\n",)}), "its variants for 'flight'"),
    ],
)
def test_a_record_that_holds_anything_else_is_refused(engine: Engine, fault: str) -> None:
    with pytest.raises(AssertionError, match=fault):
        raise AssertionError(fault_of(engine))
