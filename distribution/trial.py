"""Try wheels as a user does: install them in a new environment, and call commands in another folder.

    python -m distribution.trial WHEEL ...

Needs nothing but Python, so that it runs on any system. The commands are a truth, runs of MuJoCo with a report, a study, a case
that becomes a test, and the plug-in for pytest.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from itertools import dropwhile
from pathlib import Path

#: The tutorial, in a checkout.
TUTORIAL = Path("docs", "start", "tutorial.md")

#: Longest time (s) of a command.
LIMIT_S = 900.0


class Failed(Exception):
    """A command failed, or did not do what it should; the text says which and shows its output."""


def tried(python: Path, wheels: Sequence[Path], folder: Path, checkout: Path | None = None) -> str:
    """Install wheels in a new environment of an interpreter, try them, and return a sentence about it.

    Parameters
    ----------
    python
        The interpreter.
    wheels
        Those of bodycheck and pytest-bodycheck; without the second, pytest is installed beside bodycheck.
    folder
        An empty folder for the environment and the files of the commands.
    checkout
        A checkout of the commit of the wheels, whose tutorial is followed too, with the versions of its `constraints.txt`.

    Raises
    ------
    Failed
        Something is not as it should be.
    """
    start = time.monotonic()
    environment, work = folder / "environment", folder / "a folder elsewhere"
    work.mkdir()
    _call([str(python), "-m", "venv", str(environment)], folder)
    scripts = environment / ("Scripts" if sys.platform == "win32" else "bin")
    constraints = [] if checkout is None else ["--constraint", str(checkout / "constraints.txt")]
    wanted = [str(wheel.resolve()) for wheel in wheels]
    if not any(wheel.name.startswith("pytest_bodycheck") for wheel in wheels):
        wanted.append("pytest")
    _call([str(scripts / "python"), "-m", "pip", "install", "--quiet", *constraints, *wanted], folder)
    size = sum(path.stat().st_size for path in environment.rglob("*") if path.is_file() and not path.is_symlink())
    version = _commands(scripts, work)
    followed = "" if checkout is None else f", and the {_follow(checkout, scripts, folder)} commands of the tutorial"
    named = _call(
        [str(scripts / "python"), "-c", "import platform; print(platform.python_version(), platform.platform())"], work
    )
    return (
        f"bodycheck {version} on Python {named.strip()}: {size / 1e6:.0f} MB installed; truth, runs, report, study and plug-in"
        f"{followed} work; {time.monotonic() - start:.0f} s"
    )


def _commands(scripts: Path, work: Path) -> str:
    """Call the commands of a user in a folder, and return the version of bodycheck."""
    bodycheck = str(scripts / "bodycheck")
    method = ["--engine", "mujoco", "--integrator", "RK4"]
    version = _call([bodycheck, "--version"], work).strip()
    truth = json.loads(_call([bodycheck, "truth", "intermediate-axis-flip", "--json"], work))
    if not truth or "truth_error" not in json.dumps(truth):
        raise Failed("bodycheck truth --json prints no bound")
    _call([bodycheck, "run", "intermediate-axis-flip", *method, "--out", "results", "--quiet"], work)
    for name in ("results.csv", "results.parquet", "results.json", "report.html", "report.md"):
        if not (work / "results" / name).is_file():
            raise Failed(f"bodycheck run --out writes no {name}")
    _call([bodycheck, "tradeoff", "free-brick", *method, "--timestep", "0.01", "--timestep", "0.005", "--quiet"], work)
    _call([bodycheck, "new", "thrown"], work)
    _call([bodycheck, "expect", "thrown.case.toml", *method, "--quiet"], work)
    printed = _call([str(scripts / "python"), "-m", "pytest", "-q"], work)
    if "1 passed" not in printed:
        raise Failed(f"the plug-in does not run the case:\n{printed}")
    return version


def _follow(checkout: Path, scripts: Path, folder: Path) -> int:
    """Follow the tutorial of a checkout from the end of its installation on, and return the number of its commands that ran."""
    from tests.support import walkthrough

    (folder / "bodycheck").symlink_to(checkout)  # the page copies a workflow from the checkout beside its folder
    steps = list(dropwhile(lambda step: getattr(step, "downloads", False), walkthrough.steps(checkout / TUTORIAL)))
    done = walkthrough.follow_afresh(steps, folder / "tutorial", _variables(scripts, folder))
    if failures := walkthrough.failures(done):
        raise Failed("\n\n".join(failures))
    return len(done)


def _call(command: Sequence[str], folder: Path) -> str:
    """Run a command in a folder and return what it printed. Raises `Failed`."""
    scripts = Path(command[0]).parent
    done = subprocess.run(
        command,
        cwd=folder,
        env=_variables(scripts, folder),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        timeout=LIMIT_S,
    )
    if done.returncode:
        raise Failed(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def _variables(scripts: Path, folder: Path) -> dict[str, str]:
    """Return the variables of a user's shell with an active environment, and none that lead to a checkout."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "GITHUB_", "VIRTUAL_ENV"))}
    path = os.pathsep.join((str(scripts), kept.get("PATH", os.defpath)))
    return kept | {"PATH": path, "BODYCHECK_CACHE": str(folder / "cache")}


def main() -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        print(tried(Path(sys.executable), [Path(name) for name in sys.argv[1:]], Path(folder)))


if __name__ == "__main__":
    main()
