"""Installing packages into environments of their own: by uv where it is, else by pip, from where pip is configured to look.

Only wheels are installed: what an index has only as sources would have to be built, by code of its own.
"""

import ast
import contextlib
import ctypes
import functools
import importlib.util
import os
import platform
import re
import shutil
import signal
import subprocess
import sys
import tomllib
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from subprocess import DEVNULL, PIPE, CompletedProcess, Popen

from bodycheck.running.limits import PR_SET_PDEATHSIG

if sys.platform != "win32":
    import resource

#: Seconds that one installation may take.
TIME_LIMIT = 900.0

#: pip's options that say where packages come from, and how they are fetched.
SOURCES = ("index-url", "extra-index-url", "find-links", "no-index", "trusted-host", "cert", "proxy", "timeout")

#: What uv calls them.
UV_NAMES = {
    "index-url": "UV_DEFAULT_INDEX",
    "extra-index-url": "UV_EXTRA_INDEX_URL",
    "find-links": "UV_FIND_LINKS",
    "no-index": "UV_NO_INDEX",
    "trusted-host": "UV_INSECURE_HOST",
    "cert": "SSL_CERT_FILE",
    "proxy": "ALL_PROXY",
    "timeout": "UV_HTTP_TIMEOUT",
}

UNREACHABLE = re.compile(
    r"connection (error|refused|broken)|new connection|name resolution|timed out|dns error|failed to fetch|error sending",
    re.IGNORECASE,
)
NOT_THERE = ("there is no version of {}", "No matching distribution found for {}")
#: What installers say of a requirement.
NO_WHEEL = ("{} has no usable wheels", "{} has no wheels")


class InstallationFailed(Exception):
    """An installer says no; the text is its own reason, in one line."""


class NotOnOffer(InstallationFailed):
    """What was asked for cannot be had from the index, in whatever way."""


def interpreter(folder: Path) -> Path:
    """The Python of an environment in a folder."""
    return folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


def make(folder: Path) -> None:
    """An environment of the running Python without any package. Raises `InstallationFailed`."""
    _installer([sys.executable, "-m", "venv", "--without-pip", str(folder)])


def install(folder: Path, requirements: Sequence[str], constraints: Sequence[str] = (), day: datetime | None = None) -> None:
    """Install requirements and what they depend on. Raises `InstallationFailed`.

    constraints: on any of it. day: until when what is installed was uploaded, which only uv can see to.
    """
    limits = folder / "constraints.txt"
    limits.write_text("\n".join(constraints), "utf-8")
    options = ["--only-binary", ":all:", "--constraint", str(limits), *requirements]  # `_failure` looks at the last
    python = str(interpreter(folder))
    if (uv := _uv()) is not None:
        until = ["--exclude-newer", day.isoformat()] if day is not None else []
        _installer([uv, "pip", "install", "--python", python, "--quiet", *until, *options], _for_uv())
        return
    _installer([python, "-m", "ensurepip", "--default-pip"])
    _installer([python, "-m", "pip", "install", "--quiet", "--no-input", *options], _for_pip())
    _installer([python, "-m", "pip", "uninstall", "--quiet", "--yes", "pip", "setuptools"], _for_pip())


def release_day(distribution: str, version: str) -> datetime | None:
    """When the last wheel of a release was uploaded; None where that cannot be found out: not by pip, not of local files."""
    if (uv := _uv()) is None:
        return None
    options = ["--quiet", "--no-deps", "--only-binary", ":all:", "--format", "pylock.toml", "--python", sys.executable]
    try:
        lock = tomllib.loads(_installer([uv, "pip", "compile", *options, "-"], _for_uv(), f"{distribution}=={version}"))
    except (InstallationFailed, tomllib.TOMLDecodeError):
        return None
    wheels = [wheel for package in lock.get("packages", []) for wheel in package.get("wheels", [])]
    return max((wheel["upload-time"] for wheel in wheels if "upload-time" in wheel), default=None)


def versions(distribution: str) -> tuple[str, ...]:
    """The releases of a distribution that the configured index has, in no order. Raises `InstallationFailed`."""
    said = _installer([*_pip(), "index", "versions", distribution, "--retries", "1"], _for_pip())
    listed = re.search(r"^Available versions: *(.*)$", said, re.MULTILINE)
    return tuple(re.split(r", *", listed[1].strip())) if listed else ()


def call(
    command: Sequence[str], environment: Mapping[str, str], stdin: str | None, timeout: float, memory: int | None = None
) -> CompletedProcess[str]:
    """A command's outcome. It and what it starts end with this process, with an interruption of it, or after `timeout` s.

    memory: bytes that it may take, where the system can hold it to that. Raises `subprocess.TimeoutExpired`.
    """
    with Popen(
        command,
        stdin=DEVNULL if stdin is None else PIPE,
        stdout=PIPE,
        stderr=PIPE,
        env=dict(environment),
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
        preexec_fn=_bound_to_this_process(memory),
    ) as process:
        try:
            stdout, stderr = process.communicate(stdin, timeout)
        except BaseException:
            _kill(process)
            raise
    return CompletedProcess(command, process.returncode, stdout, stderr)


def _bound_to_this_process(memory: int | None) -> Callable[[], None] | None:
    """What a child does before it becomes another program: it asks to be killed when its parent ends."""
    if sys.platform != "linux":
        return None
    libc, parent = ctypes.CDLL(None), os.getpid()

    def bind() -> None:
        libc.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)
        if memory is not None:
            _, hard = resource.getrlimit(resource.RLIMIT_DATA)
            resource.setrlimit(resource.RLIMIT_DATA, (memory, hard))

    return bind


def _kill(process: Popen[str]) -> None:
    """End a process and those that it started."""
    if sys.platform == "win32":
        process.kill()
        return
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def _installer(command: Sequence[str], environment: Mapping[str, str] | None = None, stdin: str | None = None) -> str:
    """What an installer prints. Raises `InstallationFailed`."""
    try:
        done = call(command, os.environ if environment is None else environment, stdin, TIME_LIMIT)
    except subprocess.TimeoutExpired as error:
        raise InstallationFailed(f"it was not installed within {TIME_LIMIT:g} s") from error
    except OSError as error:
        raise InstallationFailed(f"{command[0]} cannot be run: {error}") from error
    if done.returncode:
        raise _failure(done.stderr or done.stdout, command[-1])
    return done.stdout


def _failure(text: str, requirement: str) -> InstallationFailed:
    """What matters of an installer's complaint, in one line; requirement: what it was asked for."""
    lines = [line.strip(" ×╰─▶│├") for line in text.splitlines()]
    told = " ".join(line for line in lines if line and not line.startswith(("hint:", "WARNING:", "[notice]")))
    if UNREACHABLE.search(text):
        return NotOnOffer(f"the index cannot be reached: {told}")
    if any(words.format(requirement) in told for words in NO_WHEEL):
        return NotOnOffer(f"there is no wheel of it for Python {platform.python_version()} on this platform")
    if any(words.format(requirement) in told for words in NOT_THERE):
        return NotOnOffer("the index has no wheel of this version")
    return InstallationFailed(told or "the installer gives no reason")


def _uv() -> str | None:
    """Where uv is: beside the running interpreter, or on the path."""
    beside = shutil.which("uv", path=str(Path(sys.executable).parent))
    return beside or shutil.which("uv")


def _pip() -> list[str]:
    """How pip is called."""
    if importlib.util.find_spec("pip") is not None:
        return [sys.executable, "-m", "pip"]
    if (uv := _uv()) is not None:
        return [uv, "tool", "run", "--quiet", "--python", sys.executable, "pip"]
    raise InstallationFailed("neither pip nor uv is installed")


@functools.cache
def _configured() -> dict[str, str]:
    """What pip's configuration files say of `SOURCES`."""
    try:
        listed = _installer([*_pip(), "config", "list"])
    except InstallationFailed:  # no pip, and no network to get one
        return {}
    found = {}
    # The sections of single commands come after that for all, and decide.
    for line in sorted(listed.splitlines(), key=lambda line: not line.startswith("global.")):
        key, _, value = line.partition("=")
        option = key.rpartition(".")[2]
        if option in SOURCES and not key.startswith(":env:"):
            found[option] = str(ast.literal_eval(value))
    return found


def _sources() -> dict[str, str]:
    """What pip is configured with of `SOURCES`: its environment variables decide."""
    variables = {option: os.environ.get(_pip_variable(option), "") for option in SOURCES}
    return _configured() | {option: value for option, value in variables.items() if value}


def _pip_variable(option: str) -> str:
    return f"PIP_{option.upper().replace('-', '_')}"


def _for_pip() -> dict[str, str]:
    """The environment variables with which a pip of any environment looks where this one's pip does."""
    names = {_pip_variable(option): value for option, value in _sources().items()}
    return {**os.environ, **names, "PIP_DISABLE_PIP_VERSION_CHECK": "1"}


def _for_uv() -> dict[str, str]:
    """Those with which uv does. pip takes all its indexes for equal; uv does where it is told to."""
    names = {UV_NAMES[option]: value for option, value in _sources().items()}
    if "UV_FIND_LINKS" in names:
        names["UV_FIND_LINKS"] = ",".join(names["UV_FIND_LINKS"].split())
    return {**os.environ, "UV_INDEX_STRATEGY": "unsafe-best-match", **names}
