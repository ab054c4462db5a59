"""What several tests share."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from bodycheck import Case, load
from bodycheck.casefile.case import shipped
from bodycheck.processes import pool
from tests.support import MINIATURES, processes
from tests.support import browser as browsing
from tests.support.asked import ADAPTER_OPTION, RENEW_OPTION
from tests.support.cases import OF_ONE_BODY

# No deadline: the first example pays for imports, and machines that run tests are slow at times.
settings.register_profile("bodycheck", deadline=None)
settings.load_profile("bodycheck")

pytest_plugins = ["pytester"]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(ADAPTER_OPTION, metavar="ENGINE", help="Test the adapter of this engine alone.")
    parser.addoption(RENEW_OPTION, action="store_true", help="Write the golden pages instead of comparing reports with them.")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """One process more than there are processors: in many tests a process waits for another one, or for a clock."""
    return (os.cpu_count() or 1) + 1


@pytest.fixture(scope="session", autouse=True)
def no_engines_apart(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Hides the engines that this user has installed apart, except from the tests that install some, which keep them."""
    with pytest.MonkeyPatch.context() as patch:
        if not set(request.config.getoption("-m").split()) <= {"slow", "engines", "claims", "or"}:
            patch.setenv("BODYCHECK_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session", autouse=True)
def workers_end_by_themselves() -> Iterator[None]:
    """Lets worker processes end by themselves where lines are counted: a killed process does not write what it reached."""
    with pytest.MonkeyPatch.context() as patch:
        if "COVERAGE_PROCESS_CONFIG" in os.environ:
            patch.setattr(pool._Worker, "stop", processes.ended_by_itself)
        yield


@pytest.fixture
def miniatures(monkeypatch: pytest.MonkeyPatch) -> Path:
    """Puts the miniature engines on the path, where the registry finds them by their entry points."""
    monkeypatch.syspath_prepend(MINIATURES)
    return MINIATURES


@pytest.fixture
def calls_here() -> Iterator[None]:
    """Runs in the process of the test: for tests that are not about worker processes, of engines that neither die nor hang."""
    with processes.calls_here():
        yield


@pytest.fixture(params=shipped())
def shipped_case(request: pytest.FixtureRequest) -> Case:
    """Each of the shipped cases in turn."""
    return load(request.param)


@pytest.fixture(params=OF_ONE_BODY)
def case_of_one_body(request: pytest.FixtureRequest) -> Case:
    """Each of the shipped cases of one body in turn."""
    return load(request.param)


@pytest.fixture(params=[name for name in OF_ONE_BODY if load(name).scene.conserves])
def conservative_case(request: pytest.FixtureRequest) -> Case:
    """Each of the shipped cases of one body without friction and drag."""
    return load(request.param)


@pytest.fixture(params=[name for name in OF_ONE_BODY if load(name).scene.plane is None])
def flying_case(request: pytest.FixtureRequest) -> Case:
    """Each of the shipped cases of one body that does not touch a plane."""
    return load(request.param)


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A real browser; where there is none, the test is skipped."""
    with browsing.launched() as launched:
        yield launched
