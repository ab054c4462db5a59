"""The workflows of this repository name what exists, and give each job no more rights than it needs."""

import re
import shutil
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml

from bodycheck.adapters import registry
from bodycheck.site.submissions import archive, packing
from distribution import steps
from tests.site import submissions as made
from tests.support import ROOT

FOLDER = ROOT / ".github" / "workflows"

#: The rights that any job may have, by workflow and job.
RIGHTS = {
    ("sites", "publish"): {"pages": "write", "id-token": "write"},
    ("weekly", "propose"): {"contents": "write", "pull-requests": "write"},
    ("release", "publish"): {"id-token": "write"},
    ("release", "attest"): {"id-token": "write", "attestations": "write"},
    ("release", "announce"): {"contents": "write"},
}

#: All files that name actions, those for users included.
PINNED = (ROOT / "action.yml", *sorted(FOLDER.glob("*.yml")), *sorted((ROOT / "docs" / "ci").glob("*.yml")))

WORKFLOWS: dict[str, Any] = {path.stem: yaml.safe_load(path.read_text()) for path in sorted(FOLDER.glob("*.yml"))}
JOBS = [(name, job) for name, workflow in WORKFLOWS.items() for job in workflow["jobs"]]


def scripts(name: str, job: str) -> str:
    return "\n".join(step.get("run", "") for step in WORKFLOWS[name]["jobs"][job]["steps"])


@pytest.mark.parametrize(("name", "job"), JOBS)
def test_a_job_has_no_more_rights_than_it_needs(name: str, job: str) -> None:
    assert WORKFLOWS[name]["permissions"] == {"contents": "read"}
    assert WORKFLOWS[name]["jobs"][job].get("permissions", {}) == RIGHTS.get((name, job), {})
    assert "timeout-minutes" in WORKFLOWS[name]["jobs"][job]


@pytest.mark.parametrize("name", WORKFLOWS)
def test_a_change_of_a_stranger_gets_no_secret(name: str) -> None:
    """Such as the event pull_request_target would give it."""
    text = (FOLDER / f"{name}.yml").read_text()
    assert "pull_request_target" not in text
    assert "secrets." not in text
    assert "${{ github.event." not in re.sub(r"if: .*", "", text), "what a stranger writes is in no script"


@pytest.mark.parametrize(("name", "job"), JOBS)
def test_actions_are_of_github_or_publish_on_the_index(name: str, job: str) -> None:
    for step in WORKFLOWS[name]["jobs"][job]["steps"]:
        if "uses" in step:
            assert re.fullmatch(r"(actions/[a-z-]+|pypa/gh-action-pypi-publish)@[0-9a-f]{40}", step["uses"])


@pytest.mark.parametrize("path", PINNED, ids=lambda path: path.name)
def test_an_action_is_pinned_to_one_commit_and_its_version_is_named(path: Path) -> None:
    """The commit is what runs; Dependabot and readers know it by the version. All files pin the same."""
    lines = [line for line in path.read_text("utf-8").splitlines() if re.search(r"^\s*(- )?uses:", line)]
    assert lines
    for line in lines:
        assert re.search(r"uses: [\w/-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+$", line), line
    pins = {line.partition("uses: ")[2] for each in PINNED for line in each.read_text("utf-8").splitlines() if "uses: " in line}
    assert len(pins) == len({pin.partition("@")[0] for pin in pins})


@pytest.mark.parametrize(("name", "job"), JOBS)
def test_what_a_job_runs_exists(name: str, job: str) -> None:
    targets = set(re.findall(r"^([^\s:=#]+):", (ROOT / "Makefile").read_text().replace("$(VENV)", ".venv"), re.MULTILINE))
    assert set(re.findall(r"^make (\S+)", scripts(name, job), re.MULTILINE)) <= targets
    for path in re.findall(r"\bpython (\S+\.py)", scripts(name, job)):
        assert (ROOT / path).is_file()


def test_the_steps_that_can_be_run_here_need_nothing_of_the_service() -> None:
    """`python -m distribution.steps JOB` runs them; it leaves out what calls an action or writes to the repository."""
    listed = steps.jobs(ROOT)
    assert set(listed) == {*(f"{name}.{job}" for name, job in JOBS), "action"}
    for step in (step for job in listed.values() for step in job if step.left_out is None):
        assert step.script
        assert "${{" not in f"{step.script} {step.variables}"
        assert not re.search(r"\bgh |git push", step.script)


def test_what_may_write_runs_no_engine_and_what_publishes_runs_nothing() -> None:
    assert not scripts("sites", "publish").strip()
    assert not scripts("release", "publish").strip()
    assert scripts("release", "announce").strip().startswith("gh release create")
    assert "--newest" not in scripts("weekly", "propose")
    assert "--newest" in scripts("weekly", "newest")


def test_a_change_builds_both_sites_and_fails_if_a_submission_is_left_out() -> None:
    assert True in WORKFLOWS["sites"], "YAML takes the word on for a truth value"
    assert set(WORKFLOWS["sites"][True]) == {"push", "pull_request"}
    steps = scripts("sites", "build").splitlines()
    assert steps.index("make sites") < steps.index(".venv/bin/python submissions/check.py")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of submissions/ with one submission."""
    copy = tmp_path / "submissions"
    copy.mkdir()
    for name in ("renew.py", "check.py", "README.md"):
        shutil.copy(ROOT / "submissions" / name, copy)
    packed = packing.contents(made.write_folder(tmp_path / "run", {"results.csv": [made.run()]}))
    (copy / "honest.zip").write_bytes(archive.zipped(packed))
    return copy


def script(folder: Path, name: str) -> ModuleType:
    """A script of a folder of submissions. It runs in this process: an interpreter for each call would cost a second."""
    spec = spec_from_file_location(f"submissions_{name}", folder / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_check_tells_what_the_site_would_leave_out(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    check = script(folder, "check")
    assert check.main() == 0
    assert capsys.readouterr().out == "submissions: all 1 are shown, 0.0 MB\n"
    (folder / "hostile.zip").write_bytes(b"<script>")
    (folder / "page.html").write_text("<script>")
    assert check.main() == 1
    assert capsys.readouterr().out.splitlines() == [
        "submissions/hostile.zip: is no zip file that can be read: File is not a zip file",
        "submissions/page.html: is no submission",
    ]


def test_the_table_of_submissions_says_what_is_there(folder: Path) -> None:
    renew = script(folder, "renew")
    assert renew.main(["--table"]) == 0
    before, text = (path.read_text() for path in (ROOT / "submissions" / "README.md", folder / "README.md"))
    assert (
        "| honest.zip | `bodycheck run` | 2026-01-01 | Some(R) Processor, family 6 model 1 stepping 1, x86_64, 4 cores" in text
    )
    assert text.partition("<!-- table")[0] == before.partition("<!-- table")[0]
    assert renew.main(["--table"]) == 0
    assert (folder / "README.md").read_text() == text


def test_the_table_of_this_repository_is_that_of_its_submissions() -> None:
    """All of them can be read; the workflow of the sites also runs `submissions/check.py`."""
    text = (ROOT / "submissions" / "README.md").read_text()
    renew = script(ROOT / "submissions", "renew")
    assert text.partition(renew.BEGIN)[2].partition(renew.END)[0].splitlines()[1:] == list(renew.table())


def test_what_is_renewed_is_of_engines_that_there_are(folder: Path) -> None:
    with pytest.raises(SystemExit, match=r"allowed: --newest, --table, mujoco-3\.2\.0, ") as refused:
        script(folder, "renew").main(["unknown"])
    named = set(re.findall(r"([a-z_]+)-[0-9.]+", str(refused.value).partition("allowed:")[2]))
    assert named <= set(registry.names())
