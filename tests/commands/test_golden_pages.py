"""The wording of each report, which other tests leave open: they look at its names, numbers and statuses."""

from pathlib import Path

import pytest

from tests.support import golden, saved_results
from tests.support.asked import RENEW_OPTION
from tests.support.wording import facts


@pytest.fixture(scope="session")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with results of runs."""
    return saved_results.made(tmp_path_factory, "run")


@pytest.mark.parametrize("name", golden.NAMES)
def test_a_report_is_worded_as_its_golden_page(name: str, saved: Path, tmp_path: Path, pytestconfig: pytest.Config) -> None:
    page = golden.pages(saved, tmp_path)[name]()
    path = golden.GOLDEN / f"{name}.md"
    if pytestconfig.getoption(RENEW_OPTION):
        path.write_text(page, "utf-8")
    kept = path.read_text("utf-8") if path.exists() else ""
    assert page == kept, f"{path}: the report reads otherwise; if it should, renew its golden page: {golden.RENEW}"


def test_every_golden_page_is_one_of_a_report() -> None:
    assert {path.stem for path in golden.GOLDEN.iterdir()} == set(golden.NAMES)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("*bodycheck 0.1.0, mujoco 4.0.0; cores 2*\n", "*VERSIONS, MACHINE, DATE AND COMMAND*\n"),
        ("mujoco 3.10.0 Euler at 2 ms", "mujoco VERSION Euler at 2 ms"),
        ("≤ 3.6e-15 and 4e-12 rad", "≤ ROUNDING and ROUNDING rad"),
        ("1e-9, 1.24e+07, 0.04905 and 3.14e-1", "1e-9, 1.24e+07, 0.04905 and 3.14e-1"),
        ("a case in /a/folder/spin.case.toml", "a case in FOLDER/spin.case.toml"),
    ],
)
def test_only_what_varies_is_masked(text: str, expected: str) -> None:
    assert golden.masked(text, Path("/a/folder")) == expected


def test_facts_are_all_numbers_and_the_given_names_in_their_order() -> None:
    told = "With mujoco RK4 at 10 ms (3.10.0) it went from -2e-5 to 3.3e-9 rad, 25% of it, in spin-2 and spin."
    assert facts(told, "mujoco RK4", "spin", "rad", "gone") == [
        *("mujoco RK4", "10", "3.10.0", "-2e-5", "3.3e-9", "rad", "25", "spin", "spin"),
    ]
    assert facts("RK4 of v2 and x10") == []
