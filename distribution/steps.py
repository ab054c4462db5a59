"""Run the steps of the workflows in a shell, as far as they need nothing of the service that runs them.

    python -m distribution.steps                        lists all jobs and steps, and says which cannot be run here and why
    python -m distribution.steps sites.build checks     runs these jobs, or all jobs of a workflow; action is action.yml

Each job gets a new clone of the last commit, and its steps run in it one after another by bash, as a runner calls it. The first
value of each list of the matrix is taken. Package registries are used from wherever pip is told to.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).parents[1]

#: What in a step needs the service, by the reason why the step cannot be run here.
NEEDS = {
    r"\bgh (release|pr|issue)\b": "it calls the interface of the service (gh)",
    r"\bgit push\b": "it writes to the repository",
    r"\bfind found\b": "it takes an artifact of another job",
}

#: Values of expressions that are no values of a matrix. Others are empty. The baseline is what the run itself writes.
EXPRESSIONS = {
    "runner.temp": "$RUNNER_TEMP",
    "github.ref_name": "v0.2.0",
    "github.server_url": "https://github.com",
    "github.repository": "OWNER/bodycheck",
    "github.run_id": "1",
    "steps.python.outputs.python-path": "python",
    "inputs.cases": "cases/free-brick.case.toml",
    "inputs.engines": "mujoco",
    "inputs.baseline": "$RUNNER_TEMP/bodycheck/now.parquet",
}

#: Lines of the output of a failed step that are printed.
LAST_LINES = 40


@dataclass(frozen=True)
class Step:
    """A step of a job: its place as `workflow.job 3`, its script, its variables, and why it cannot be run here, if so."""

    place: str
    script: str
    variables: Mapping[str, str]
    left_out: str | None


def jobs(root: Path) -> dict[str, list[Step]]:
    """Return the steps of all jobs by `workflow.job`, and those of action.yml by `action`."""
    documents = {
        path.stem: yaml.safe_load(path.read_text("utf-8")) for path in sorted((root / ".github/workflows").glob("*.yml"))
    }
    written = {f"{name}.{job}": content for name, document in documents.items() for job, content in document["jobs"].items()}
    written["action"] = yaml.safe_load((root / "action.yml").read_text("utf-8"))["runs"]
    return {name: list(_steps(name, job)) for name, job in written.items()}


def _steps(name: str, job: Mapping[str, Any]) -> Iterator[Step]:
    matrix = job.get("strategy", {}).get("matrix", {})
    values = EXPRESSIONS | {f"matrix.{key}": str(listed[0]) for key, listed in matrix.items()}
    for number, step in enumerate(job["steps"], 1):
        script = step.get("run", "")
        reasons = [reason for words, reason in NEEDS.items() if re.search(words, script)]
        reasons += [f"there is no {one} here" for one in re.findall(r"\bpython3\.\d+\b", script) if shutil.which(one) is None]
        if "uses" in step:
            reasons = [f"it is the action {step['uses'].partition('@')[0]}"]
        variables = {key: _evaluated(str(value), values) for key, value in step.get("env", {}).items()}
        yield Step(f"{name} {number}", _evaluated(script, values), variables, "; ".join(reasons) or None)


def _evaluated(text: str, values: Mapping[str, str]) -> str:
    """Return a text with the values of its expressions `${{ … }}`."""
    return re.sub(r"\$\{\{ *(.*?) *\}\}", lambda match: values.get(match[1], ""), text)


def run(steps: Sequence[Step], folder: Path) -> bool:
    """Run the steps of a job in an empty folder until one fails, print a line for each, and return whether all passed."""
    clone, commands, kept = folder / "clone", folder / "bin", folder / "runner"
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
    for path in (commands, kept):
        path.mkdir()
    for name in ("python", "python3"):  # not that of this environment, which has packages that the one of a runner lacks
        (commands / name).symlink_to(Path(sys.executable).resolve())
    left = {
        name: value for name, value in os.environ.items() if not name.startswith(("GITHUB_", "VIRTUAL_ENV", "MAKE", "MFLAGS"))
    }
    left |= {"PATH": f"{commands}{os.pathsep}{os.environ['PATH']}", "GITHUB_ACTION_PATH": str(clone), "RUNNER_TEMP": str(kept)}
    left |= {name: str(kept / name) for name in ("GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY")}
    for step in steps:
        if step.left_out is not None:
            print(f"{step.place}: not run: {step.left_out}", flush=True)
            continue
        variables = {name: value.replace("$RUNNER_TEMP", str(kept)) for name, value in step.variables.items()}
        before, output = os.times(), folder / "output"
        with output.open("wb") as stream:
            shell = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step.script]
            done = subprocess.run(
                shell, cwd=clone, env=left | variables, stdin=subprocess.DEVNULL, stdout=stream, stderr=stream
            )
        after = os.times()
        cost = after.children_user - before.children_user + after.children_system - before.children_system
        lines = output.read_text("utf-8", "replace").splitlines()
        print(
            f"{step.place}: exit code {done.returncode}, {cost:.0f} s of processor time: {lines[-1] if lines else ''}",
            flush=True,
        )
        if done.returncode:
            print("\n".join(lines[-LAST_LINES:]))
            return False
    return True


def main() -> None:
    known, asked = jobs(ROOT), sys.argv[1:]
    named = {one: [name for name in known if name == one or name.startswith(f"{one}.")] for one in asked}
    if missing := [one for one, names in named.items() if not names]:
        sys.exit(f"read {' '.join(missing)}; allowed: {', '.join(known)}")
    chosen = [name for name in known if any(name in names for names in named.values())]
    if not asked:
        for step in (step for steps in known.values() for step in steps):
            print(f"{step.place}: {step.left_out or step.script.strip().splitlines()[0]}")
    passed = []
    for name in chosen:
        with tempfile.TemporaryDirectory() as folder:
            passed.append(run(known[name], Path(folder)))
    sys.exit(0 if all(passed) else 1)


if __name__ == "__main__":
    main()
