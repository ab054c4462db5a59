"""The probes find every planted default with its value, alone and in pairs, and nothing in an engine without any."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from math import pi
from typing import Any

import pytest

from bodycheck.studies.audit.flights import Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes import PROBES, SCENES
from tests.support.planted_defaults import SCHEMES, Defaults, Planted

#: s. A large one, for which truncation errors are large and flights are short.
TIMESTEP = 0.01

#: As the audit asks: a value is within 1 % of what is planted.
CLOSE = 0.01


@dataclass(frozen=True)
class Case:
    """A planted default: the fields of `Defaults`, the property, and its value and unit; None where it has no value."""

    planted: Mapping[str, Any]
    property: str
    value: float | None = None
    unit: str = ""


#: The losses of a light or far body add up over the 64 steps of the flight.
LOSS = 1 - (1 - 1e-4) ** 64

CASES = {
    "single precision": Case({"single": True}, "single-precision", 24, "binary digits"),
    "linear damping": Case({"linear": 0.1}, "linear-damping", 0.1, "1/s"),
    "angular damping": Case({"angular": 0.1}, "angular-damping", 0.1, "1/s"),
    "quadratic damping": Case({"quadratic": 0.04}, "quadratic-damping", 0.04, "1/m"),
    "quadratic angular damping": Case({"quadratic_angular": 0.04}, "quadratic-damping", 0.04, "1/rad"),
    "speed limit": Case({"speed": 100.0}, "speed-limit", 100.0, "m/s"),
    "spin limit": Case({"spin": 47.0}, "spin-limit", 47.0, "rad/s"),
    "turn limit": Case({"turn": pi / 4}, "turn-limit", pi / 4, "rad per step"),
    "missing torque": Case({"missing": 0.5}, "no-gyroscopic-torque", 0.5),
    "substeps": Case({"substeps": 4}, "substeps", 4),
    "gravity after position": Case({"gravity_after": True}, "gravity-after-position"),
    "sleeping": Case({"sleep": 0.03}, "sleeping", 0.03, "m/s"),
    "frame": Case({"world_spin": True}, "frame"),
    "order": Case({"scalar_last": True}, "order"),
    "norm": Case({"norm": 1e-3}, "quaternion-norm", 1e-3),
    "time base": Case({"clock": 0.005}, "time-base", 0.005),
    "reset": Case({"reset": 1e6}, "silent-reset", 1e6, "m"),
    "energy": Case({"energy": 0.02}, "energy-per-turn", 0.02),
    "scale": Case({"light": 1e-4}, "scale-dependence", LOSS),
    "origin": Case({"far": 1e-4}, "origin-dependence", LOSS),
}

#: Other forms and sizes of the same defaults.
OTHERS = {
    "weak damping": Case({"linear": 1e-6}, "linear-damping", 1e-6, "1/s"),
    "strong damping": Case({"linear": 5.0}, "linear-damping", 5.0, "1/s"),
    "strong angular damping": Case({"angular": 5.0}, "angular-damping", 5.0, "1/s"),
    "strong quadratic damping": Case({"quadratic": 0.5}, "quadratic-damping", 0.5, "1/m"),
    "high speed limit": Case({"speed": 8000.0}, "speed-limit", 8000.0, "m/s"),
    "low speed limit": Case({"speed": 3.0}, "speed-limit", 3.0, "m/s"),
    "low spin limit": Case({"spin": 10.0}, "spin-limit", 10.0, "rad/s"),
    "turn limit of attitude": Case({"turn_of_attitude": pi / 4}, "turn-limit", pi / 4, "rad per step"),
    "turn limit beyond pi": Case({"turn": 4.0}, "turn-limit", 4.0, "rad per step"),
    "no torque": Case({"missing": 1.0}, "no-gyroscopic-torque", 1.0),
    "two substeps": Case({"substeps": 2}, "substeps", 2),
    "many substeps": Case({"substeps": 20}, "substeps", 20),
    "fast sleeper": Case({"sleep": 0.4}, "sleeping", 0.4, "m/s"),
    "velocity in body": Case({"body_velocity": True}, "frame"),
    "inverse quaternion": Case({"inverse": True}, "frame"),
    "spin first": Case({"spin_first": True}, "order"),
    "short steps": Case({"clock": -0.02}, "time-base", -0.02),
    "near reset": Case({"reset": 5e3}, "silent-reset", 5e3, "m"),
    "loss of energy": Case({"energy": -0.3}, "energy-per-turn", -0.3),
}

#: Pairs that flights cannot tell apart: the one that hides the other, and why.
INSEPARABLE = {
    ("speed limit", "reset"): "no body gets as far as the place from which it would be put back",
    ("quadratic damping", "reset"): "no body gets as far as the place from which it would be put back",
}


def findings(own: Defaults, scheme: str = "steady", timestep: float = TIMESTEP) -> list[Finding]:
    """What all probes of free flight say of a miniature engine; its bodies are not made of links."""
    pilot = Pilot(Planted(own, scheme), scheme, timestep)
    flights = [probe for name, probe in PROBES.items() if name != "representation" and name not in SCENES]
    return [finding for probe in flights for finding in probe(pilot)]


def found(own: Defaults, scheme: str = "steady", timestep: float = TIMESTEP) -> list[Finding]:
    return [finding for finding in findings(own, scheme, timestep) if finding.verdict == "found"]


def told(seen: list[Finding], *cases: Case) -> None:
    """Assert that what was seen is what the cases plant, and nothing else."""
    assert sorted((one.property, one.unit) for one in seen) == sorted((case.property, case.unit) for case in cases)
    for case in cases:
        (own,) = [one for one in seen if (one.property, one.unit) == (case.property, case.unit)]
        assert own.value == (None if case.value is None else pytest.approx(case.value, rel=CLOSE))


@pytest.mark.parametrize("case", [*CASES.values(), *OTHERS.values()], ids=[*CASES, *OTHERS])
def test_a_planted_default_is_found_alone_with_its_value(case: Case) -> None:
    told(found(Defaults(**case.planted)), case)


@pytest.mark.parametrize("pair", [pair for pair in combinations(CASES, 2) if pair not in INSEPARABLE], ids=" and ".join)
def test_both_of_a_pair_are_found_with_their_values(pair: tuple[str, str]) -> None:
    one, other = CASES[pair[0]], CASES[pair[1]]
    told(found(Defaults(**one.planted, **other.planted)), one, other)


@pytest.mark.parametrize("pair", INSEPARABLE, ids=" and ".join)
def test_of_a_pair_that_cannot_be_separated_only_the_first_is_found(pair: tuple[str, str]) -> None:
    one, other = CASES[pair[0]], CASES[pair[1]]
    told(found(Defaults(**one.planted, **other.planted)), one)


@pytest.mark.parametrize("single", [False, True], ids=["double", "single"])
@pytest.mark.parametrize("timestep", [0.01, 0.002])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_nothing_is_found_in_a_clean_engine_but_what_its_scheme_does(scheme: str, timestep: float, single: bool) -> None:
    true = {"single-precision"} if single else set()
    # The energy of an implicit midpoint rule is constant, and RK4 loses less than single precision does.
    true |= set() if scheme in ("midpoint", "steady") or (scheme == "rk4" and single) else {"energy-per-turn"}
    true |= {"gravity-after-position"} if scheme == "explicit" else set()
    # Far from the origin a difference of positions has few digits.
    true |= {"origin-dependence"} if scheme == "positional" else set()
    seen = findings(Defaults(single=single), scheme, timestep)
    properties = {one.property for one in seen if one.verdict == "found"}
    # The loss of RK4, of fifth order in the step, is below rounding with small steps.
    assert properties == true or (scheme == "rk4" and properties == true - {"energy-per-turn"})
    # Of substeps of a scheme of second order no flight tells.
    unknown = {"substeps"} if scheme in ("rk4", "midpoint") else set()
    assert {one.property for one in seen if one.verdict == "not-probed"} == unknown


def test_a_scheme_that_is_not_the_only_cause_of_a_loss_does_not_hide_damping() -> None:
    seen = {one.property: one.value for one in found(Defaults(angular=0.1), "explicit")}
    assert seen["angular-damping"] == pytest.approx(0.1, rel=CLOSE)


@pytest.mark.parametrize("after", [0.1, 0.402, 0.498, 1.7])
def test_the_time_after_which_a_body_sleeps_is_right_to_one_percent(after: float) -> None:
    (seen,) = found(Defaults(sleep=0.03, sleep_after=after), timestep=0.002)
    said = re.fullmatch(r"sleeping: after ([0-9.]+) s", seen.probe)
    assert said is not None, seen.probe
    assert float(said[1]) == pytest.approx(after, rel=CLOSE)
    assert seen.value == pytest.approx(0.03, rel=CLOSE)


def test_every_property_is_named_by_exactly_the_probes_that_look_for_it() -> None:
    properties = [finding.property for finding in findings(Defaults())]
    # Of the velocity and of the angular velocity.
    assert properties.count("quadratic-damping") == 2
    assert len(properties) == len(set(properties)) + 1
    assert set(properties) >= {case.property for case in CASES.values()}
