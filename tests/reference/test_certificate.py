"""The cross-check: every way to the truth against every other."""

import json
import re
import sys

import numpy as np
import pytest

from bodycheck import Case, load
from bodycheck.commands.command_line import app
from bodycheck.reference.certificate import certify
from bodycheck.reference.certified import Certificate
from bodycheck.reference.flight import torque_free
from bodycheck.reference.flight.closed_form import STORED_ERROR_RAD


def ways(found: Certificate) -> set[str]:
    return {way for pair in found.differences for way in pair}


def test_every_shipped_truth_is_certified(case_of_one_body: Case) -> None:
    found = certify(case_of_one_body.scene, case_of_one_body.instants)
    assert found.faults == ()
    assert found.certified
    assert len(found.differences) == len(ways(found)) * (len(ways(found)) - 1) // 2


def test_what_is_certified_is_a_measured_distance_and_the_error_of_the_other_way(flying_case: Case) -> None:
    pytest.importorskip("heyoka")
    found = certify(flying_case.scene, flying_case.instants)
    assert (found.bound <= found.truth.bounds.error).all()
    assert (np.diff(found.bound) >= 0).all()
    assert found.digits >= 18
    # Nothing grows in a closed form: what is left is the rounding of a quaternion to double.
    assert 0 < found.bound[-1] <= STORED_ERROR_RAD


def test_a_clock_that_is_a_billionth_wrong_is_not_certified(
    calls_here: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    right = torque_free.tumbling
    monkeypatch.setattr(torque_free, "tumbling", lambda motion, t: right(motion, t * (1 + 1e-9)))
    flip = load("intermediate-axis-flip")
    found = certify(flip.scene, flip.instants)
    assert not found.certified
    # Ten seconds at ten radians a second are wrong by 1e-9 of themselves, a part of which the flips undo.
    assert found.bound[-1] > 1e-8
    assert found.truth.bounds.error[-1] > 1e-8
    assert all(fault.startswith("truth and ") for fault in found.faults)
    assert app(["truth", flip.name, "--certify"], result_action="return_value") == 1
    (line, *_) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("contradicted: ")]
    assert re.fullmatch(r"contradicted: truth and .* are [-\d.e]+ rad apart, their bounds allow [-\d.e]+", line)
    assert app(["truth", flip.name, "--certify", "--json"], result_action="return_value") == 1
    printed = json.loads(capsys.readouterr().out)
    assert printed["certified"] is False
    assert printed["certified_error"][-1] > 1e-8


def test_without_heyoka_scipy_takes_over(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in [name for name in sys.modules if name.startswith("bodycheck.reference")]:
        if "heyoka" in vars(sys.modules[module]) or "hy" in vars(sys.modules[module]):
            monkeypatch.delitem(sys.modules, module)
            package, _, name = module.rpartition(".")
            monkeypatch.delattr(sys.modules[package], name)
    monkeypatch.setitem(sys.modules, "heyoka", None)
    case = load("free-brick")
    found = certify(case.scene, case.instants)
    assert {name.partition(", ")[2] for name in found.truth.witnesses} <= {"scipy-dop853", "numpy"}
    assert found.certified
    assert (found.bound <= found.truth.bounds.error).all()


def test_the_command_prints_it(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["truth", "gimbal-start", "--certify", "--at", "0", "0.5", "1"]
    assert app(arguments, result_action="return_value") == 0
    printed = capsys.readouterr().out
    assert "truth | euler-lagrange" in printed
    assert "bound by the most accurate other way" in printed
    assert app([*arguments, "--json"], result_action="return_value") == 0
    found = json.loads(capsys.readouterr().out)
    assert len(found["certified_error"]) == len(found["differences"][0]["attitude"]) == 3
    assert np.all(np.array(found["certified_error"]) <= found["truth_error"])
    assert found["certified"] is True
    assert found["digits"] >= 16
