"""Files of robots that pytest's configuration names are tests."""

from importlib import import_module
from pathlib import Path

import pytest

from bodycheck.robots.urdf_text import urdf
from tests.support.planted_engines import plant
from tests.support.reading_engines import ENGINES
from tests.support.robot_faults import clean_model


@pytest.fixture
def repository(pytester: pytest.Pytester, calls_here: None, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    """A folder with two files of a robot, of which the configuration names one, and an engine that takes it otherwise."""
    import_module(
        "bodycheck.running.robot_readings"
    )  # pytester forgets what its own runs import, whose classes then are others
    plant(pytester.path / "planted", {name: ENGINES[name] for name in ("faithful", "heavy")})
    monkeypatch.syspath_prepend(pytester.path / "planted")
    monkeypatch.setenv("COLUMNS", "200")
    folder = pytester.path / "robots"
    folder.mkdir()
    for name in ("arm", "other"):
        (folder / f"{name}.urdf").write_text(urdf(clean_model()), "utf-8")
    pytester.makeini("[pytest]\nbodycheck_models = robots/a*.urdf")
    return pytester


def test_a_file_that_is_named_passes_where_engines_agree(repository: pytest.Pytester) -> None:
    result = repository.runpytest("--bodycheck-engine", "faithful", "-v")
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(["*arm.urdf::parity PASSED*"])


def test_a_difference_fails_and_explains_itself(repository: pytest.Pytester) -> None:
    result = repository.runpytest("--bodycheck-engine", "faithful", "--bodycheck-engine", "heavy")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*heavy 1.0:*", "*armature differs: elbow*", "All rows: bodycheck parity *arm.urdf --table"])
    result.stdout.no_fnmatch_line("*Traceback*")


def test_a_file_that_is_no_model_says_so(repository: pytest.Pytester) -> None:
    (repository.path / "robots" / "arm.urdf").write_text("no model", "utf-8")
    result = repository.runpytest("--bodycheck-engine", "faithful")
    result.assert_outcomes(failed=1)
    result.stdout.no_fnmatch_line("*Traceback*")


def test_nothing_is_collected_that_is_not_named(repository: pytest.Pytester) -> None:
    repository.makeini("[pytest]\nbodycheck_models = *.xml")
    result = repository.runpytest(Path("robots"))
    result.assert_outcomes()
