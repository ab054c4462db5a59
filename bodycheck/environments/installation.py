"""Virtual environments and the packages in them, made by uv from the package sources for which pip is configured.

Only wheels are installed: a source distribution would have to be built, which runs code of the distribution.
"""

import ast
import os
import platform
import re
import subprocess
import sys
import tomllib
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path

from uv import find_uv_bin

from bodycheck.environments import subprocesses

#: Longest time in s that one call of uv or pip may take.
CALL_LIMIT_S = 900.0

#: pip's options for package sources and the connection to them, with the environment variables that have the same effect on uv.
UV_VARIABLES = {
    "index-url": "UV_DEFAULT_INDEX",
    "extra-index-url": "UV_EXTRA_INDEX_URL",
    "find-links": "UV_FIND_LINKS",
    "trusted-host": "UV_INSECURE_HOST",
    "cert": "SSL_CERT_FILE",
    "proxy": "ALL_PROXY",
    "timeout": "UV_HTTP_TIMEOUT",
    "default-timeout": "UV_HTTP_TIMEOUT",
}

#: Sections of pip's configuration that apply to an installation; a later section overrides earlier ones.
PIP_SECTIONS = ("global", "install", ":env:")

#: Messages of uv and pip when an index does not answer.
UNREACHABLE = re.compile(
    r"connection (error|refused|broken)|new connection|name resolution|timed out|dns error|failed to fetch|error sending",
    re.IGNORECASE,
)
#: The message of uv about a requirement that the index does not have.
NOT_THERE = "there is no version of {}"
#: The messages of uv about a requirement for which the index has no compatible wheel.
NO_WHEEL = ("{} has no usable wheels", "{} has no wheels")


class InstallationFailed(Exception):
    """uv or pip failed; the text is the reason that the program gives, on one line."""


class NotOnOffer(InstallationFailed):
    """The package sources do not have a requirement, or cannot be reached: another attempt would fail as well."""


def interpreter(folder: Path) -> Path:
    """Return the Python interpreter of the virtual environment in a folder."""
    return folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


def make(folder: Path) -> None:
    """Make a virtual environment of the running Python, without packages, in an empty folder. Raises `InstallationFailed`."""
    # It must be relocatable, because the folder gets its final name only when the environment is finished.
    command = [find_uv_bin(), "venv", "--quiet", "--no-project", "--relocatable", "--python", sys.executable, str(folder)]
    _output(command, os.environ)


def install(
    folder: Path,
    requirements: Sequence[str],
    constraints: Sequence[str] = (),
    day: datetime | None = None,
    cached: bool = True,
) -> None:
    """Install packages and their dependencies into the virtual environment in a folder.

    Parameters
    ----------
    folder
        The folder of the virtual environment.
    requirements
        The packages to install, each as `NAME==VERSION`.
    constraints
        Conditions on the versions of all packages that are installed.
    day
        Ignore files that were uploaded to the index after this time; None to ignore nothing.
    cached
        Whether uv uses its cache; if not, it downloads the packages again and replaces installed ones.

    Raises
    ------
    NotOnOffer
        There is no wheel of a requirement, or the index cannot be reached.
    InstallationFailed
        uv failed for another reason.
    """
    limits = folder / "constraints.txt"
    limits.write_text("\n".join(constraints), "utf-8")
    until = ["--exclude-newer", day.isoformat()] if day is not None else []
    anew = [] if cached else ["--no-cache", "--reinstall"]
    options = ["--quiet", "--compile-bytecode", "--only-binary", ":all:", "--constraint", str(limits), *until, *anew]
    _uv_pip(["install", "--python", str(interpreter(folder)), *options, *requirements], requirements)


def release_day(distribution: str, version: str) -> datetime | None:
    """Return the time of upload of the last wheel of a release; None if the source, such as a folder, does not state it."""
    options = ["--quiet", "--no-deps", "--only-binary", ":all:", "--format", "pylock.toml", "--python", sys.executable]
    requirement = f"{distribution}=={version}"
    try:
        lock = tomllib.loads(_uv_pip(["compile", *options, "-"], [requirement], stdin=requirement))
    except (InstallationFailed, tomllib.TOMLDecodeError):
        return None
    wheels = [wheel for package in lock.get("packages", []) for wheel in package.get("wheels", [])]
    return max((wheel["upload-time"] for wheel in wheels if "upload-time" in wheel), default=None)


def versions(distribution: str) -> tuple[str, ...]:
    """Return the releases of a distribution in the package sources, in no particular order. Raises `InstallationFailed`.

    This calls pip, because uv has no command for it.
    """
    listing = _pip("index", "versions", distribution, "--retries", "1")
    listed = re.search(r"^Available versions: *(.*)$", listing, re.MULTILINE)
    return tuple(re.split(r", *", listed[1].strip())) if listed else ()


def _uv_pip(arguments: Sequence[str], requirements: Sequence[str], stdin: str | None = None) -> str:
    """Run `uv pip` with the package sources of pip and return its stdout. Raises `InstallationFailed`.

    requirements: the packages that uv installs, for the message of an error.
    """
    options = _pip_options()
    variables = {UV_VARIABLES[option]: value for option, value in options.items() if option in UV_VARIABLES}
    if "UV_FIND_LINKS" in variables:
        variables["UV_FIND_LINKS"] = ",".join(variables["UV_FIND_LINKS"].split())
    # pip chooses the best version among all its indexes; by default uv uses only the first index that has the package.
    variables["UV_INDEX_STRATEGY"] = "unsafe-best-match"
    # There is no environment variable for this option.
    no_index = ["--no-index"] if options.get("no-index", "").lower() in ("1", "true", "t", "yes", "y", "on") else []
    command = [find_uv_bin(), "pip", *arguments, *no_index]
    return _output(command, {**os.environ, **variables}, requirements, stdin)


def _pip_options() -> dict[str, str]:
    """Return pip's options as its configuration files and environment variables set them. Raises `InstallationFailed`."""
    options: dict[str, dict[str, str]] = {section: {} for section in PIP_SECTIONS}
    for line in _pip("config", "list").splitlines():
        key, _, quoted = line.partition("=")
        section, _, option = key.rpartition(".")
        if section in options and (value := str(ast.literal_eval(quoted))):  # pip ignores options that are empty
            options[section][option] = value
    return {option: value for section in PIP_SECTIONS for option, value in options[section].items()}


def _pip(*arguments: str) -> str:
    """Run pip and return its stdout. Raises `InstallationFailed`."""
    return _output([sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments], os.environ)


def _output(
    command: Sequence[str], variables: Mapping[str, str], requirements: Sequence[str] = (), stdin: str | None = None
) -> str:
    """Run a command and return its stdout. Raises `InstallationFailed`."""
    try:
        done = subprocesses.run(command, variables, stdin, CALL_LIMIT_S)
    except subprocess.TimeoutExpired as error:
        raise InstallationFailed(f"the installation took longer than {CALL_LIMIT_S:g} s") from error
    except OSError as error:
        raise InstallationFailed(f"{command[0]} cannot be run: {error}") from error
    if done.returncode:
        raise _failure(done.stderr or done.stdout, requirements)
    return done.stdout


def _failure(text: str, requirements: Sequence[str]) -> InstallationFailed:
    """Return an error whose message is the reason in the output of uv or pip, on one line."""
    lines = [line.strip(" ×╰─▶│├") for line in text.splitlines()]
    reason = " ".join(line for line in lines if line and not line.startswith(("hint:", "WARNING:", "[notice]")))
    if UNREACHABLE.search(text):
        return NotOnOffer(f"the index cannot be reached: {reason}")
    if any(words.format(requirement) in reason for words in NO_WHEEL for requirement in requirements):
        return NotOnOffer(f"there is no wheel of it for Python {platform.python_version()} on this platform")
    if any(NOT_THERE.format(requirement) in reason for requirement in requirements):
        return NotOnOffer("the index has no wheel of this version")
    return InstallationFailed(reason or "no reason was given")
