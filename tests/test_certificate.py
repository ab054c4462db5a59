"""The certificate: every way to the truth against every other."""

import json
import sys

import numpy as np
import pytest

from bodycheck import Case, load
from bodycheck.command_line import app
from bodycheck.reference import truth
from bodycheck.reference.certificate import CLOSED_FORM, THE_TRUTH, certify


def test_the_printed_bound_holds_in_128_bits(flying_case: Case) -> None:
    taylor = pytest.importorskip("bodycheck.reference.taylor")
    found = certify(flying_case.scene, flying_case.instants)
    exact = found.differences[THE_TRUTH, f"euler-lagrange, {taylor.NAMES['quadruple']}"]
    assert (exact <= found.truth.error).all()
    assert (found.bound <= found.truth.error).all()
    assert found.growth is not None
    # What 80 bits and their growth leave, and the rounding of a quaternion to double.
    assert (exact <= 2e-15 * (1 + np.maximum.accumulate(found.growth))).all()


def test_all_ways_are_there() -> None:
    found = certify(load("gimbal-start").scene, np.linspace(0, 1, 5))
    ways = {way for pair in found.differences for way in pair}
    assert {THE_TRUTH, CLOSED_FORM, "euler-lagrange, scipy-dop853", "quasi-coordinates, scipy-dop853"} <= ways
    assert len(found.differences) == len(ways) * (len(ways) - 1) // 2
    assert max(apart[-1] for apart in found.differences.values()) < 1e-12


def test_without_heyoka_scipy_takes_over(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("bodycheck.reference.taylor", "bodycheck.reference.sensitivity"):
        monkeypatch.delitem(sys.modules, module, raising=False)
    monkeypatch.delattr("bodycheck.reference.taylor", raising=False)
    monkeypatch.delattr("bodycheck.reference.sensitivity", raising=False)
    monkeypatch.setitem(sys.modules, "heyoka", None)
    case = load("free-brick")
    assert truth.backend().name == "scipy-dop853"
    assert truth.truth(case.scene, case.instants).backend == "scipy-dop853"
    found = certify(case.scene, case.instants)
    assert found.growth is None
    assert (found.bound <= found.truth.error).all()


def test_a_slide_has_no_further_witness(capsys: pytest.CaptureFixture[str]) -> None:
    assert app(["truth", "curling-brick", "--certify"], result_action="return_value") == 1
    assert "more ways than the two" in capsys.readouterr().err


def test_the_command_prints_it(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["truth", "gimbal-start", "--certify", "--at", "0", "0.5", "1"]
    assert app(arguments, result_action="return_value") == 0
    printed = capsys.readouterr().out
    assert "truth | closed form" in printed
    assert "certified bound" in printed
    assert app([*arguments, "--json"], result_action="return_value") == 0
    found = json.loads(capsys.readouterr().out)
    assert len(found["certified_error"]) == len(found["differences"][0]["attitude"]) == 3
    assert np.all(np.array(found["certified_error"]) <= found["truth_error"])
