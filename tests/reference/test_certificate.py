"""The certificate: every way to the truth against every other."""

import json
import sys

import numpy as np
import pytest

from bodycheck import Case, load
from bodycheck.commands.command_line import app
from bodycheck.reference import truth
from bodycheck.reference.certificate import ELLIPTIC_WAY, TRUTH_WAY, certify
from bodycheck.reference.flight.closed_form import STORED_ERROR_RAD


def test_the_printed_bound_holds_in_128_bits(flying_case: Case) -> None:
    taylor = pytest.importorskip("bodycheck.reference.integration.taylor")
    found = certify(flying_case.scene, flying_case.instants)
    exact = found.differences[TRUTH_WAY, f"euler-lagrange, {taylor.BACKEND_NAMES['quadruple']}"]
    assert (exact <= found.truth.bounds.error).all()
    assert (found.bound <= found.truth.bounds.error).all()
    assert found.growth is not None
    # Nothing grows in a closed form: what is left is the rounding of a quaternion to double.
    assert exact.max() <= STORED_ERROR_RAD


def test_all_ways_are_there() -> None:
    found = certify(load("gimbal-start").scene, np.linspace(0, 1, 5))
    ways = {way for pair in found.differences for way in pair}
    assert {TRUTH_WAY, "euler-lagrange, scipy-dop853", "quasi-coordinates, scipy-dop853"} <= ways
    assert len(found.differences) == len(ways) * (len(ways) - 1) // 2
    # DOP853 at its tightest loses some 1e-14 a radian of turn, and this body turns by 5 rad.
    assert max(apart[-1] for apart in found.differences.values()) < 1e-12


def test_a_symmetric_body_has_the_elliptic_functions_for_a_witness_too() -> None:
    found = certify(load("football-wobble").scene, np.linspace(0, 2, 5))
    # Two closed forms, each with some ten roundings of its own.
    assert found.differences[TRUTH_WAY, ELLIPTIC_WAY].max() <= 2 * STORED_ERROR_RAD
    assert not any(ELLIPTIC_WAY in pair for pair in certify(load("free-brick").scene, np.linspace(0, 1, 3)).differences)


def test_without_heyoka_scipy_takes_over(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("bodycheck.reference.integration.taylor", "bodycheck.reference.integration.sensitivity"):
        monkeypatch.delitem(sys.modules, module, raising=False)
    monkeypatch.delattr("bodycheck.reference.integration.taylor", raising=False)
    monkeypatch.delattr("bodycheck.reference.integration.sensitivity", raising=False)
    monkeypatch.setitem(sys.modules, "heyoka", None)
    case = load("free-brick")
    assert truth.backend().name == "scipy-dop853"
    assert {name.partition(", ")[2] for name in truth.truth(case.scene, case.instants).witnesses} == {"scipy-dop853"}
    found = certify(case.scene, case.instants)
    assert found.growth is None
    assert (found.bound <= found.truth.bounds.error).all()


def test_a_slide_has_no_further_witness(capsys: pytest.CaptureFixture[str]) -> None:
    assert app(["truth", "curling-brick", "--certify"], result_action="return_value") == 1
    assert "more ways than the two" in capsys.readouterr().err


def test_the_command_prints_it(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["truth", "gimbal-start", "--certify", "--at", "0", "0.5", "1"]
    assert app(arguments, result_action="return_value") == 0
    printed = capsys.readouterr().out
    assert "truth | euler-lagrange" in printed
    assert "certified bound" in printed
    assert app([*arguments, "--json"], result_action="return_value") == 0
    found = json.loads(capsys.readouterr().out)
    assert len(found["certified_error"]) == len(found["differences"][0]["attitude"]) == 3
    assert np.all(np.array(found["certified_error"]) <= found["truth_error"])
