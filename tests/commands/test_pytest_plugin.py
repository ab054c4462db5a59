"""The pytest plug-in, seen from the repository of someone who has only installed bodycheck."""

import importlib
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from bodycheck.figures import columns
from tests.support.planted_engines import UNINSTALLED, plant

SPIN = """\
format = 1
name = "spin"
title = "A spin about one axis"
tags = ["steady", "free-flight", "skip", "and", "__class__", "not here"]
[body]
shape = "brick"
semi_axes = [0.1, 0.2, 0.3]
mass = 1.0
[initial]
velocity = [1.0, 0.0, 0.0]
angular_velocity = [0.0, 0.0, 5.0]
[run]
duration = 0.5
samples = 6
"""

TUMBLE = SPIN.replace("[0.0, 0.0, 5.0]", "[1.0, 2.0, 5.0]")


def expect(*limits: str, engine: str = "exact", integrator: str = "closed-form", timestep: float = 0.1) -> str:
    method = (f'engine = "{engine}"', f'integrator = "{integrator}"', f"timestep = {timestep}")
    return "\n".join(("[[expect]]", *method, *limits)) + "\n"


@pytest.fixture
def repository(pytester: pytest.Pytester, miniatures: Path, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    """A folder of someone's own, with the miniature engines installed; a terminal that cuts nothing off."""
    for module in ("running.campaign", "judging.judgement"):  # pytester forgets what is imported first within one of its runs
        importlib.import_module(f"bodycheck.{module}")
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setenv("PYTHONPATH", str(miniatures), prepend=os.pathsep)
    return pytester


def write(repository: pytest.Pytester, text: str, name: str = "spin") -> Path:
    path = repository.path / f"{name}.case.toml"
    path.write_text(text)
    return path


def test_a_wrong_expectation_explains_itself(calls_here: None, repository: pytest.Pytester) -> None:
    """Expected, measured, the worst moment, the truth's own bound, the place in the file, and what to do next."""
    write(repository, SPIN + expect("position_error = 1e-9", "energy_drift = 1e-9", engine="wrong"))
    result = repository.runpytest()
    result.assert_outcomes(failed=1)
    lines = result.outlines
    start = next(number for number, line in enumerate(lines) if "spin: wrong closed-form, time step 0.1 s" in line)
    told = lines[start + 1 : start + 10]
    assert told == [
        "position_error is 1 m, expected at most 1e-09 m",
        "",
        "spin, simulated by wrong 1.0 (integrator closed-form, time step 0.1 s) and compared with mechanics:",
        "",
        "spin.case.toml:15: position_error, largest distance of the centre of mass from its exact position",
        "    expected  at most 1e-09 m",
        "    measured  1 m",
        *told[7:],
    ]
    assert told[7].startswith("              worst at t = 0")
    assert told[8].startswith("              the truth's own error is at most ")
    assert told[8].endswith("e-16 m")
    command = next(line for line in lines if line.startswith("All figures and curves: "))  # CI has it once more, in the summary
    assert command.endswith("bodycheck run spin.case.toml --engine wrong --integrator closed-form --timestep 0.1 --out results")
    result.stdout.no_fnmatch_line("*Traceback*")
    result.stdout.fnmatch_lines(["FAILED spin.case.toml::wrong-closed-form-0.1 - position_error is 1 m, expected at most*"])


def test_an_item_a_method_and_every_expectation_of_it_counts(calls_here: None, repository: pytest.Pytester) -> None:
    text = SPIN + expect("position_error = 1e-9") + expect("attitude_error = 1e-9") + expect('status = "diverged"')
    write(repository, text + expect("position_error = 1e-9", timestep=0.05))
    result = repository.runpytest("-v")
    result.assert_outcomes(failed=1, passed=1)
    result.stdout.fnmatch_lines(
        [
            "spin.case.toml::exact-closed-form-0.1 FAILED*",
            "spin.case.toml::exact-closed-form-0.05 PASSED*",
            "status is ok, expected diverged",
            "spin.case.toml:25: status, how the run ended",
        ]
    )


def test_whatever_may_be_expected_has_a_meaning() -> None:
    assert {"status", *columns.LIMITED} <= columns.EXPECTED.keys()


def test_an_order_is_seen_from_finer_runs(calls_here: None, repository: pytest.Pytester) -> None:
    method = {"engine": "mujoco", "integrator": "Euler", "timestep": 0.01}
    write(repository, TUMBLE + expect("order = 1", **method))
    repository.runpytest().assert_outcomes(passed=1)
    write(repository, TUMBLE + expect("order = 4", **method))
    result = repository.runpytest()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["order is *, expected at least 3.75 and at most 4.25"])


def test_engines_that_die_are_failed_tests_and_the_others_go_on(repository: pytest.Pytester) -> None:
    engines = ("exact", "segfaulting", "dying", "raising", "exact")
    for number, engine in enumerate(engines):
        write(repository, SPIN + expect("position_error = 1e-9", engine=engine), f"{number}")
    result = repository.runpytest()
    result.assert_outcomes(passed=2, failed=3)
    result.stdout.fnmatch_lines(
        [
            "status is crashed, expected ok",
            "*its process died of signal SIGSEGV",
            "*its process exited with code 3",
            "*RuntimeError: the miniature engine gives up",
        ]
    )


def test_an_engine_that_nobody_knows_is_a_fault_of_the_file(repository: pytest.Pytester) -> None:
    write(repository, SPIN + expect("position_error = 1e-9", engine="exactly"))
    result = repository.runpytest()
    result.assert_outcomes(errors=1)
    fault = "spin.case.toml:16:1: expect[[]1[]].engine: read 'exactly'; there is no such engine; allowed: *"
    result.stdout.fnmatch_lines([fault + "did you mean 'exact'?"])


def test_an_engine_that_is_not_installed_fails_unless_that_is_allowed(calls_here: None, repository: pytest.Pytester) -> None:
    plant(repository.path / "planted", {"uninstalled": UNINSTALLED})
    repository.syspathinsert(repository.path / "planted")
    limit = "position_error = 1e-9"
    write(repository, SPIN + expect(limit) + expect(limit, engine="uninstalled", integrator="step"))
    result = repository.runpytest()
    result.assert_outcomes(passed=1, failed=1)
    reason = "uninstalled is not installed: there is no Python package 'no_such_engine'"
    result.stdout.fnmatch_lines([f"not checked: {reason}; install it, or accept this with --bodycheck-allow-missing"])
    allowed = repository.runpytest("--bodycheck-allow-missing")
    allowed.assert_outcomes(passed=1, skipped=1)
    allowed.stdout.fnmatch_lines(
        ["*expectations that were not checked*", f"spin.case.toml::uninstalled-*: {reason} (--bodycheck-allow-missing)"]
    )


@pytest.mark.parametrize("processes", [0, 1])
def test_a_case_without_expectations_is_told(repository: pytest.Pytester, processes: int) -> None:
    write(repository, SPIN)
    result = repository.runpytest_subprocess("-q", "-n", "1") if processes else repository.runpytest("-q")
    assert result.ret == pytest.ExitCode.NO_TESTS_COLLECTED
    result.stdout.fnmatch_lines(["*case files collected without expectations*", "spin.case.toml"])


def test_a_known_discrepancy_passes_until_its_day_and_is_told(calls_here: None, repository: pytest.Pytester) -> None:
    for name, day, limit in (("now", "2999-01-01", "1e-9"), ("over", "2020-01-01", "1e-9"), ("mended", "2020-01-01", "2.0")):
        known = expect(f"position_error = {limit}", 'known = "https://example.org/7"', f'until = "{day}"', engine="wrong")
        write(repository, SPIN + known, name)
    result = repository.runpytest()
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(
        [
            "    known     https://example.org/7, tolerated until 2020-01-01",
            "*known discrepancies according to the case files*",
            "mended.case.toml::wrong-closed-form-0.1: what is known to fail (https://example.org/7) holds now",
            "now.case.toml::wrong-closed-form-0.1: known until 2999-01-01 (https://example.org/7): position_error is 1 m, *",
        ]
    )


def test_faults_are_all_told_and_nothing_else(repository: pytest.Pytester) -> None:
    write(repository, SPIN.replace("mass = 1.0", "mass = -1.0").replace("samples = 6", "samples = 0"))
    result = repository.runpytest()
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["spin.case.toml:8:1: body.mass: read -1.0; *", "spin.case.toml:14:1: run.samples: read 0; *"])
    result.stdout.no_fnmatch_line("*Traceback*")
    result.stdout.no_fnmatch_line("*pytest_plugin.py*")


@pytest.mark.parametrize(
    ("arguments", "chosen"),
    [
        (("-k", "0.05"), ["exact-closed-form-0.05"]),
        (("-k", "wrong"), ["wrong-closed-form-0.1"]),
        (("-k", "free-flight and not wrong"), ["exact-closed-form-0.1", "exact-closed-form-0.05"]),
        (
            ("-m", "bodycheck and steady and not skip"),
            ["exact-closed-form-0.1", "wrong-closed-form-0.1", "exact-closed-form-0.05"],
        ),
        (("--bodycheck-engine", "wrong"), ["wrong-closed-form-0.1"]),
        (
            ("--bodycheck-engine", "wrong", "--bodycheck-engine", "exact", "-k", "0.1"),
            ["exact-closed-form-0.1", "wrong-closed-form-0.1"],
        ),
        (("spin.case.toml::exact-closed-form-0.05",), ["exact-closed-form-0.05"]),
    ],
)
def test_tests_are_chosen(repository: pytest.Pytester, arguments: tuple[str, ...], chosen: list[str]) -> None:
    limit = "position_error = 1e-9"
    write(repository, SPIN + expect(limit) + expect(limit, engine="wrong") + expect(limit, timestep=0.05))
    repository.makepyfile("def test_other(): pass")
    result = repository.runpytest("--collect-only", "-q", "--strict-markers", *arguments)
    assert [line.split("::")[1] for line in result.outlines if line.startswith("spin.case.toml::")] == chosen


def test_tags_of_strangers_do_nothing_but_name(calls_here: None, repository: pytest.Pytester) -> None:
    """skip would skip, and what is no name would be no marker. A marker that is the user's own may be a tag."""
    write(repository, SPIN + expect("position_error = 1e-9"))
    result = repository.runpytest("--strict-markers", "-v", "-m", "steady")
    result.assert_outcomes(passed=1)
    repository.makeini("[pytest]\nmarkers =\n    skip: mine\n    slow: mine\n")
    write(repository, SPIN.replace('"and"', '"slow"') + expect("position_error = 1e-9"))
    repository.runpytest("--strict-markers", "-m", "slow").assert_outcomes(skipped=1)


def test_what_engines_say_commands_no_terminal_and_breaks_no_file(calls_here: None, repository: pytest.Pytester) -> None:
    repository.makepyfile(
        crying_out="""
        from miniature import Miniature
        def crying_out(t, row):
            raise RuntimeError("\\x1b[2J\\x00 \\n::error::x")
        ENGINE = Miniature("crying-out", crying_out)
        """
    )
    repository.mkdir("crying_out-1.0.dist-info").joinpath("entry_points.txt").write_text(
        "[bodycheck.engines]\ncrying-out = crying_out:ENGINE\n"
    )
    repository.syspathinsert()
    write(repository, SPIN + expect("position_error = 1e-30", engine="crying-out"))
    result = repository.runpytest("--junit-xml", "junit.xml")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*RuntimeError: \\x1b[[]2J\\x00 *"])
    assert "\x1b[2J" not in result.stdout.str()
    assert len(ElementTree.parse(repository.path / "junit.xml").findall(".//failure")) == 1


def test_an_engine_that_is_asked_for_must_be_there(repository: pytest.Pytester) -> None:
    result = repository.runpytest("--bodycheck-engine", "nobody")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["ERROR: --bodycheck-engine: there is no engine 'nobody'; there are: *"])


NAMED = ("--bodycheck-engine", "exact", "--bodycheck-engine", "wrong")
MISSED = "there is no result of the engine wrong, which is named: nothing was run"


def test_an_engine_that_is_named_has_a_result_or_the_session_fails(calls_here: None, repository: pytest.Pytester) -> None:
    """The case expects something of exact only; a session without any test of an engine has nothing to miss."""
    write(repository, SPIN + expect("position_error = 1e-9"))
    other = repository.makepyfile("def test_other(): pass")
    result = repository.runpytest(*NAMED)
    result.assert_outcomes(passed=2)
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines(["*engines without a result (--bodycheck-engine)*", MISSED])
    assert repository.runpytest(*NAMED[:2]).ret == pytest.ExitCode.OK
    assert repository.runpytest(*NAMED, other).ret == pytest.ExitCode.OK


@pytest.mark.slow
def test_processes_know_the_engines_without_a_result(repository: pytest.Pytester) -> None:
    write(repository, SPIN + expect("position_error = 1e-9"))
    result = repository.runpytest_subprocess("-n", "1", *NAMED)
    result.stdout.fnmatch_lines([MISSED])
    assert result.ret == pytest.ExitCode.TESTS_FAILED


def test_a_step_longer_than_the_run_is_a_fault_of_the_file(repository: pytest.Pytester) -> None:
    write(repository, SPIN + expect("position_error = 1e-9", timestep=2.0))
    result = repository.runpytest()
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(
        ["spin.case.toml:18:1: expect[[]1[]].timestep: read 2.0; is longer than the run; allowed: at most its duration, 0.5 s"]
    )


def test_processes_share_the_tests_and_figures_reach_junit(repository: pytest.Pytester) -> None:
    limit = "position_error = 1e-9"
    for name in ("one", "two"):
        write(repository, SPIN + expect(limit, engine="drifting"), name)
    result = repository.runpytest_subprocess("-n", "2", "--junit-xml", "junit.xml")
    result.assert_outcomes(passed=2)
    tests = ElementTree.parse(repository.path / "junit.xml").findall(".//testcase")
    properties = [{p.get("name"): p.get("value") for p in test.findall(".//property")} for test in tests]
    assert {(test["engine"], test["version"], test["status"]) for test in properties} == {("drifting", "1.0", "ok")}
    # (1 + 0.5e-3)^2 - 1, for 0.5 s of one per mille a second.
    drifts = [float(test["rotational_energy_drift"] or "nan") for test in properties]
    assert drifts == [pytest.approx(1.00025e-3, rel=1e-9)] * 2


def test_who_has_no_case_files_imports_nothing(pytester: pytest.Pytester) -> None:
    heavy = ("numpy", "scipy", "pandas", "pydantic", "mujoco", "pinocchio", "heyoka", "rich", "bodycheck.casefile.case")
    pytester.makepyfile(f"import sys\ndef test_light(): assert [m for m in {heavy} if m in sys.modules] == []")
    plugins = ("hypothesispytest", "xdist")
    pytester.runpytest_subprocess(*(f"-pno:{name}" for name in plugins)).assert_outcomes(passed=1)


def test_the_process_ends_with_the_session(repository: pytest.Pytester) -> None:
    write(repository, SPIN + expect("position_error = 1e-9"))
    before = children()
    repository.runpytest().assert_outcomes(passed=1)
    assert children() == before


def children() -> set[str]:
    """Processes of this one."""
    listed = subprocess.run(["ps", "-o", "pid=,args=", "--ppid", str(os.getpid())], capture_output=True, text=True)
    return {line for line in listed.stdout.splitlines() if "spawn_main" in line}


if sys.platform != "linux":
    pytest.skip("signals and processes are asked for as on Linux", allow_module_level=True)


def test_a_module_that_is_skipped_as_a_whole_leaves_the_summary_alone(repository: pytest.Pytester) -> None:
    repository.makepyfile('import pytest\npytest.importorskip("no_such_module_anywhere")')
    result = repository.runpytest()
    result.assert_outcomes(skipped=1)
    result.stdout.no_fnmatch_line("*INTERNALERROR*")
    assert result.ret == pytest.ExitCode.NO_TESTS_COLLECTED
