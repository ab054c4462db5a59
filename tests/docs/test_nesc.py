"""NASA's check-case 2: the case has the report's numbers, and docs/nesc.md says what the published tools are off by."""

import csv
import math
import runpy
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import load
from tests.support import ROOT

FOOT = Decimal("0.3048")
POUND_FORCE = Decimal("0.45359237") * Decimal("9.80665")

CASE = load("nesc-tumbling-brick")


@pytest.fixture(scope="module")
def script() -> dict[str, Any]:
    return runpy.run_path(str(ROOT / "docs" / "nesc.py"))


def test_the_case_has_the_numbers_of_the_report() -> None:
    """They are converted with decimals, which the exact values of the units are, and rounded once."""
    body, start = CASE.scene.body, CASE.scene.initial
    moments = ("0.001894220", "0.006211019", "0.007194665")
    assert body.moments == tuple(float(Decimal(each) * POUND_FORCE * FOOT) for each in moments)
    assert body.mass == float(Decimal("0.155404754") * POUND_FORCE / FOOT)
    assert start.position[2] == float(30_000 * FOOT)
    assert start.angular_velocity == tuple(map(math.radians, (10, 20, 30)))
    assert start.velocity[1] == -float(Decimal("7.292115e-5") * (Decimal(6_378_137) + 30_000 * FOOT))


def test_the_page_has_what_the_tools_are_off_by(script: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    traces = script["published"]()
    script["print_exact"](CASE.scene)
    script["print_tools"](CASE.scene, traces)
    script["print_explanations"](CASE.scene, traces)
    rows = [line for line in capsys.readouterr().out.splitlines() if line.startswith("|")]
    assert len(rows) == 3 + 7 + 5
    page = (ROOT / "docs" / "nesc.md").read_text("utf-8").splitlines()
    assert [row for row in rows if row not in page] == [], "renew them with: python docs/nesc.py"


def test_the_traces_start_as_the_case_does(script: dict[str, Any]) -> None:
    for trace in script["published"]().values():
        rates, angle = (error[0] for error in script["off_by"](CASE.scene, trace))
        # The tools convert degrees with nine digits or more.
        assert np.abs(rates).max() < 3e-8
        assert angle < 1e-12


def test_the_traces_have_inertial_rates(script: dict[str, Any]) -> None:
    """A roll rate that is wrong by the turning of the Earth changes the rates by more than any tool is off by."""
    roll = CASE.scene.initial.angular_velocity[0]
    confused = min(math.hypot(*script["misread"](CASE.scene, roll + sign * script["EARTH_RAD_S"])[0]) for sign in (-1, 1))
    errors = [math.hypot(*script["off_by"](CASE.scene, trace)[0][-1]) for trace in script["published"]().values()]
    assert len(errors) == 5
    assert max(errors) < confused / 3


def test_whole_traces_are_read(script: dict[str, Any], tmp_path: Path) -> None:
    quoted = script["published"]()["SIM 5"]
    with script["PUBLISHED"].open(encoding="utf-8") as lines:
        rows = [row for row in csv.DictReader(line for line in lines if line[0] != "#") if row["tool"] == "SIM 5"]
    columns = script["COLUMNS"]
    (tmp_path / "data").mkdir()
    with (tmp_path / "data" / "Atmos_02_sim_05.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(["mach", *columns.values()])
        table.writerows([["0.9", *(row[name] for name in columns)] for row in rows])
    ((tool, trace),) = script["fetched"](tmp_path).items()
    assert tool == "SIM 5"
    assert np.array_equal(trace.rates, quoted.rates)
    assert np.array_equal(trace.quaternion, quoted.quaternion)


def test_a_folder_without_traces_is_refused(script: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="there is no Atmos_02_sim_"):
        script["fetched"](tmp_path)
