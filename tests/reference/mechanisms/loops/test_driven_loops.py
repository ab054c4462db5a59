"""Mechanisms with loops and controllers: joint coordinates with multipliers against the Lagrangian with laws of its own."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.mechanisms.certificate import certify_mechanism
from bodycheck.reference.mechanisms.control import Controller, Samples, Sine, Stops
from bodycheck.reference.mechanisms.followed import followed
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.mechanisms.ways import apart
from bodycheck.reference.mechanisms.witnesses import lagrangian
from tests.support.linkages import four_bar, slider_crank

TIMES = np.linspace(0.0, 0.12, 5)
TABLE = Samples((0.0, 0.03, 0.1), (0.5, -0.5, 1.0), "linear")

CONTROLLERS = {
    "sampled": (Controller(0, kp=30.0, kd=2.0, ki=5.0, target=Sine(1.0, 9.0), rate=100.0, delay=1, effort_limit=20.0),),
    "continuous": (Controller(0, kp=30.0, kd=2.0, ki=50.0, target=Sine(1.0, 9.0, 0.3, 0.1), target_velocity=TABLE),),
    "both": (Controller(0, kp=30.0, target=0.2), Controller(2, "effort", effort=TABLE, rate=70.0)),
}


@pytest.mark.parametrize("name", CONTROLLERS)
def test_two_ways_agree(name: str) -> None:
    mechanism = replace(slider_crank(), controllers=CONTROLLERS[name])
    course, witness = followed(mechanism, TIMES), lagrangian(mechanism, TIMES)
    assert witness is not None
    off = apart(mechanism, course.way.motion, witness.motion)
    # The numbers of the file close the loops to some 1e-16, which the two ways take in different ways.
    assert max(values.max() for values in off.values()) < 1e-14
    undriven = followed(replace(mechanism, controllers=()), TIMES).way.motion
    assert max(values.max() for values in apart(mechanism, course.way.motion, undriven).values()) > 1e-3


def test_its_cross_check_holds_and_finds_a_late_controller(monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = replace(four_bar(), controllers=(Controller(0, kp=100.0, kd=5.0, target=1.0, rate=50.0),))
    checked = certify_mechanism(mechanism, TIMES)
    assert checked.certified
    assert checked.truth.bounds.error.max() < 1e-12
    from bodycheck.reference.mechanisms.loops import driven

    honest = driven.computed
    monkeypatch.setattr(driven, "computed", lambda controller, *given: honest(replace(controller, delay=1), *given))
    assert not certify_mechanism(mechanism, TIMES).certified


def test_what_is_not_modelled() -> None:
    limited = replace(slider_crank(), controllers=(Controller(0, kp=1.0, effort_limit=1.0),))
    with pytest.raises(NotModelled, match="limits of the effort of continuous controllers"):
        mechanism_truth(limited, TIMES)
    crank, *others = slider_crank().joints
    with pytest.raises(NotModelled, match="stops in a mechanism with loops"):
        mechanism_truth(replace(slider_crank(), joints=(replace(crank, stops=Stops(-9.0, 9.0)), *others)), TIMES)
