"""Environments: a release is what it says, bodycheck runs in it as it runs here, and no broken one is ever used."""

import json
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bodycheck
from bodycheck.adapters import registry
from bodycheck.environments import environments, making
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.running.fetch_environments import obtain_all
from tests.support import wheels

#: Seconds for what takes one, on machines that are busy with other things.
LIMIT = 60.0

#: Of an installation, each at another moment.
KILLINGS = 2


@pytest.fixture
def environment(wheel: Callable[..., Path]) -> Environment:
    """That of a release, made once for several tests."""
    wheel("1.0")
    return environments.obtain("toy", "1.0")


def there(environment: Environment) -> dict[str, list[str]]:
    """Versions and files of what an environment imports."""
    done = environments.run(environment, "toy_adapter", ("toy_engine", "numpy", "scipy", "bodycheck.reference"), None, LIMIT)
    assert done.returncode == 0, done.stderr
    found: dict[str, list[str]] = json.loads(done.stdout)
    return found


def own_packages(environment: Environment) -> Path:
    return Path(there(environment)["toy_engine"][1]).parent


def unfinished(place: Path) -> list[Path]:
    return list((place / "cache").rglob(f"*{environments.UNFINISHED}*"))


def made_at(environment: Environment) -> int:
    return (environment.python.parents[1] / environments.MARKER).stat().st_mtime_ns


def test_a_release_is_itself_and_all_else_is_from_here(environment: Environment) -> None:
    found = there(environment)
    assert found["toy_engine"][0] == environment.version == "1.0"
    assert found["numpy"] == [np.__version__, np.__file__]
    assert found["bodycheck.reference"][1] == bodycheck.reference.__file__
    packages = own_packages(environment)
    assert packages.is_relative_to(environment.python.parents[1])
    assert [path.name for path in packages.glob("*.dist-info")] == ["toy_engine-1.0.dist-info"]
    assert 0 < environments.size(environment) < 1 << 20
    assert "1.0" in environments.cached("toy")


def test_a_release_comes_before_the_one_that_is_installed_here(
    environment: Environment, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether that is found by the path of this process or by the environment variable for all."""
    wheels.install(tmp_path, "9.0")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    assert there(environment)["toy_engine"][0] == "1.0"
    (tmp_path / "told.py").write_text("import importlib.metadata; print(importlib.metadata.version('toy-engine'))")
    assert environments.run(environment, "told", (), None, LIMIT).stdout == "1.0\n"


def test_what_is_there_is_used_without_an_index(environment: Environment, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PIP_FIND_LINKS", "nowhere")
    made = made_at(environment)
    assert environments.obtain("toy", "1.0") == environment
    assert made_at(environment) == made


def test_package_sources_are_those_for_which_pip_is_configured(
    place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a file alone, whose section for installations overrides the one for all commands."""
    for variable in ("PIP_NO_INDEX", "PIP_FIND_LINKS", "PIP_INDEX_URL", "PIP_EXTRA_INDEX_URL"):
        monkeypatch.delenv(variable, raising=False)
    (tmp_path / "empty").mkdir()
    wheels.wheel(tmp_path / "wheels", "8.0")
    wheels.index(tmp_path / "index", wheels.wheel(tmp_path / "elsewhere", "8.1"))
    folders = f"find-links =\n    {tmp_path / 'empty'}\n    {tmp_path / 'wheels'}\n"
    sources = f"[global]\n{folders}index-url = {(tmp_path / 'index').as_uri()}\nno-index = "
    monkeypatch.setenv("PIP_CONFIG_FILE", str(tmp_path / "pip.conf"))
    (tmp_path / "pip.conf").write_text(f"{sources}true\n")
    assert environments.releases("toy") == ("8.0",)
    assert environments.obtain("toy", "8.0").version == "8.0"
    with pytest.raises(Unobtainable, match="the index has no wheel of this version"):
        environments.obtain("toy", "8.1")
    (tmp_path / "pip.conf").write_text(f"{sources}true\n[install]\nno-index = false\n")
    assert environments.obtain("toy", "8.1").version == "8.1"


def test_releases_are_listed_in_the_order_of_their_versions(
    tmp_path: Path, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path))
    for version in ("2.0", "10.0", "2.0.1", "3.0rc1", "2.0.post1"):
        wheels.wheel(tmp_path, version)
    assert environments.releases("toy") == ("2.0", "2.0.post1", "2.0.1", "10.0")


def test_where_there_is_nothing_to_list_it_is_said(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PIP_FIND_LINKS", "nowhere")
    with pytest.raises(Unobtainable, match=r"^the releases of toy cannot be listed: "):
        environments.releases("toy")
    with pytest.raises(Unobtainable, match="there is no engine 'unheard-of'"):
        environments.releases("unheard-of")
    with pytest.raises(Unobtainable, match="exact does not say what it is installed from"):
        environments.releases("exact")


VERSIONS_THAT_ARE_NONE = ("../../x", "/etc", "", "1.0; touch x", "1.0 --index-url=x", "-r x", "1.0\n2.0", "latest", ".")


@pytest.mark.parametrize("version", VERSIONS_THAT_ARE_NONE)
def test_only_versions_are_taken_for_versions(
    place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: str
) -> None:
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    for use in (environments.obtain, lambda engine, version: environments.remove(engine, [version])):
        with pytest.raises(Unobtainable, match=r"is not a version of toy; a version looks like 3\.1\.6"):
            use("toy", version)
    assert not (tmp_path / "cache").exists()


DEATHS = {
    "raise RuntimeError('no such luck')": (
        r"the import failed: toy cannot be imported: RuntimeError: no such luck at toy_adapter\.py:\d+"
    ),
    "import ctypes; ctypes.string_at(0)": "the import was ended by signal 11",
    "import not_there": "the import failed: toy is not installed: there is no Python package 'not_there'",
}


@pytest.mark.parametrize("body", DEATHS)
def test_a_release_that_dies_takes_only_itself(place: Path, wheel: Callable[..., Path], body: str) -> None:
    version = f"2.{list(DEATHS).index(body)}"
    wheel(version, body)
    with pytest.raises(Unobtainable, match=f"^toy@{version} is not available here: {DEATHS[body]}$"):
        environments.obtain("toy", version)
    assert version not in environments.cached("toy")
    assert not unfinished(place)


@pytest.mark.slow
def test_a_wrong_engine_is_for_a_study_to_tell(wheel: Callable[..., Path]) -> None:
    wheel("3.0", "KIND = 'wrong'")
    assert there(environments.obtain("toy", "3.0"))["toy_engine"][0] == "3.0"


def test_many_are_obtained_at_once_each_with_its_own_answer(environment: Environment) -> None:
    told = []
    found = obtain_all("toy", ["9.9", "1.0", "x", "1.0"], 2, lambda done, count=1: told.append(done))
    assert list(found) == ["9.9", "1.0", "x"]
    assert found["1.0"] == environment
    assert str(found["9.9"]) == "toy@9.9 is not available here: the index has no wheel of this version"
    assert str(found["x"]) == "'x' is not a version of toy; a version looks like 3.1.6 (PEP 440)"
    assert sorted(told) == ["toy@1.0", "toy@9.9", "toy@x"]


def cut_short(environment: Environment) -> None:
    module = own_packages(environment) / "toy_engine.py"
    module.unlink()  # uv's own cache may have the same file
    module.write_text("KIND =")


def without_a_file(environment: Environment) -> None:
    (own_packages(environment) / "toy_engine.py").unlink()


def without_the_packages_of_this_interpreter(environment: Environment) -> None:
    (own_packages(environment) / making.PATH_FILE).write_text("")


def with_an_interpreter_that_has_gone(environment: Environment) -> None:
    environment.python.unlink()
    environment.python.symlink_to("/nowhere/python3")


def without_a_marker(environment: Environment) -> None:
    (environment.python.parents[1] / environments.MARKER).unlink()


@pytest.mark.parametrize(
    "spoil",
    [
        cut_short,
        without_the_packages_of_this_interpreter,
        pytest.param(with_an_interpreter_that_has_gone, marks=pytest.mark.slow),
        pytest.param(without_a_file, marks=pytest.mark.slow),
        pytest.param(without_a_marker, marks=pytest.mark.slow),
    ],
)
def test_what_is_broken_is_made_anew_and_what_is_removed_is_gone(
    wheel: Callable[..., Path], spoil: Callable[[Environment], None]
) -> None:
    wheel("4.0")
    broken = environments.obtain("toy", "4.0")
    spoil(broken)
    assert environments.obtain("toy", "4.0") == broken
    assert there(broken)["toy_engine"][0] == "4.0"
    assert environments.remove("toy", ["4.0", "9.9"]) == ("4.0",)
    assert "4.0" not in environments.cached("toy")
    assert not broken.python.parents[1].exists()
    with pytest.raises(Unobtainable, match=r"toy@4\.0 is no longer there"):
        environments.run(broken, "toy_adapter", (), None, LIMIT)


OBTAIN = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # what a shell starts in the background ignores it
from bodycheck.environments import environments, making
make = making.make
def told(*arguments):
    print("made", flush=True)
    return make(*arguments)
making.make = told
environments.obtain("toy", sys.argv[1])
"""


def obtaining(version: str, **options: Any) -> "subprocess.Popen[str]":
    """A process that obtains a release, and says when it makes it."""
    return subprocess.Popen([sys.executable, "-c", OBTAIN, version], stdout=subprocess.PIPE, text=True, **options)


def test_of_processes_at_once_one_makes_it(wheel: Callable[..., Path]) -> None:
    wheel("5.0")
    processes = [obtaining("5.0") for _ in range(2)]
    assert sorted(process.communicate(timeout=LIMIT)[0] for process in processes) == ["", "made\n"]
    assert [process.returncode for process in processes] == [0, 0]


def test_installations_that_are_killed_leave_nothing(place: Path, wheel: Callable[..., Path]) -> None:
    wheel("6.0")
    moments = random.Random(1)
    for _ in range(KILLINGS):
        process = obtaining("6.0", stderr=subprocess.DEVNULL)
        assert process.stdout is not None
        assert process.stdout.readline() == "made\n"
        time.sleep(moments.uniform(0, 1.5))
        process.kill()
        process.communicate(timeout=LIMIT)
    assert there(environments.obtain("toy", "6.0"))["toy_engine"][0] == "6.0"
    assert not unfinished(place)


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_the_end_of_a_process_however_it_comes_is_that_of_its_installers(
    place: Path, wheel: Callable[..., Path], end: signal.Signals
) -> None:
    wheel("7.0", "import time; time.sleep(600)")
    process = obtaining("7.0", stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + LIMIT
    try:
        while not (children := offspring(process.pid, "toy")):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        process.send_signal(end)
        process.communicate(timeout=LIMIT)
    finally:
        process.kill()
        process.communicate()
    wait_for_end(children)
    assert end != signal.SIGINT or not unfinished(place)


def offspring(parent: int, argument: str) -> list[int]:
    """Processes that one has started with an argument."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            status, command = (entry / "stat").read_text(), (entry / "cmdline").read_bytes().decode().split("\0")
        except OSError:  # it has ended
            continue
        if int(status.rpartition(")")[2].split()[1]) == parent and argument in command:
            found.append(int(entry.name))
    return found


def wait_for_end(processes: list[int]) -> None:
    deadline = time.monotonic() + LIMIT
    while any(is_alive(process) for process in processes):
        assert time.monotonic() < deadline, "it goes on"
        time.sleep(0.01)


def is_alive(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_what_is_run_is_stopped_in_time_with_what_it_started(environment: Environment, place: Path) -> None:
    program = "import subprocess, time; print(subprocess.Popen(['sleep', '600']).pid, flush=True); time.sleep(600)"
    (place / "plugin" / "endless.py").write_text(program)
    with pytest.raises(subprocess.TimeoutExpired) as stopped:
        environments.run(environment, "endless", (), None, 3.0)
    wait_for_end([int(stopped.value.stdout or b"")])


def test_what_is_run_is_told_and_limited(environment: Environment, place: Path) -> None:
    (place / "plugin" / "echo.py").write_text("import sys; print(sys.argv[1:], sys.stdin.read()); sys.exit(3)")
    done = environments.run(environment, "echo", ("--a", "b c"), "wörd", LIMIT)
    assert (done.returncode, done.stdout) == (3, "['--a', 'b c'] wörd\n")
    (place / "plugin" / "greedy.py").write_text("bytearray(64 << 30)")
    done = environments.run(environment, "greedy", (), None, LIMIT)
    assert done.returncode == 1
    assert "MemoryError" in done.stderr


def test_the_engines_here_say_what_they_are_installed_from() -> None:
    assert (registry.installation("mujoco").distribution, registry.installation("pinocchio").distribution) == ("mujoco", "pin")


def test_a_file_that_is_changed_in_place_is_installed_without_the_cache_that_shares_it(wheel: Callable[..., Path]) -> None:
    """uv links files, so that its cache and all environments change with one; the size stays the same here."""
    wheel("4.1")
    environment = environments.obtain("toy", "4.1")
    module = own_packages(environment) / "toy_engine.py"
    text = module.read_text("utf-8")
    with module.open("r+", encoding="utf-8") as stream:  # without a new file
        stream.write(text.replace("exact", "wrong"))
    assert environments.obtain("toy", "4.1") == environment
    assert module.read_text("utf-8") == text


@pytest.mark.slow
def test_a_damaged_environment_stays_until_another_can_replace_it(
    wheel: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    wheel("4.2")
    environment = environments.obtain("toy", "4.2")
    (own_packages(environment) / "toy_engine.py").unlink()
    with monkeypatch.context() as patch:
        patch.setenv("PIP_FIND_LINKS", "nowhere")
        patch.setenv("UV_CACHE_DIR", str(environment.python.parents[1] / "nothing"))
        with pytest.raises(Unobtainable, match=r"^toy@4\.2 is not available here: "):
            environments.obtain("toy", "4.2")
    assert environments.find("toy", "4.2") == environment
    environment.python.unlink()
    with pytest.raises(Unobtainable, match=r"^toy@4\.2 has a damaged environment .* by: bodycheck engines add toy@4\.2$"):
        environments.find("toy", "4.2")
    assert environments.obtain("toy", "4.2") == environment
