"""The probes of impacts, friction, restarts, orders and very many steps find planted faults, and nothing in a sound engine."""

from math import sqrt

import pytest

from bodycheck.adapters.method import Kind
from bodycheck.studies.audit.flights import Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes import PROBES, SCENES, long_run
from bodycheck.studies.audit.probes.impact import MASS, MOMENTS
from tests.support.planted_contacts import Faults, PlantedContacts
from tests.support.planted_defaults import Defaults, Planted

TIMESTEP = 0.002

#: The share of the energy that the coefficient of restitution decides: the effective mass at the patch over that of a box.
SHARE = 1 / (2 + 2 * MASS * ((0.07 / 2) ** 2 / MOMENTS[1] + (0.11 / 2) ** 2 / MOMENTS[2]))


def findings(own: Faults) -> list[Finding]:
    """What the probes of contact and of mechanisms say of a miniature engine."""
    pilot = Pilot(PlantedContacts(own), "step", TIMESTEP)
    return [finding for name in SCENES for finding in PROBES[name](pilot)]


def found(own: Faults) -> dict[str, list[Finding]]:
    """The findings by property."""
    seen: dict[str, list[Finding]] = {}
    for finding in findings(own):
        if finding.verdict == "found":
            seen.setdefault(finding.property, []).append(finding)
    return seen


def test_nothing_is_found_in_a_sound_engine() -> None:
    seen = findings(Faults())
    assert {one.verdict for one in seen} == {"none"}, seen
    assert {one.property for one in seen} == {
        *("friction-anisotropy", "sideways-friction", "hidden-state", "order-of-bodies"),
        *("impact_energy_error", "impact_momentum_error", "impact_angular_momentum_error"),
    }


@pytest.mark.parametrize("gain", [0.01, 0.1, -0.05])
def test_energy_that_an_impact_gains_or_loses_is_found_with_its_value(gain: float) -> None:
    (seen,) = found(Faults(restitution=sqrt(1 + gain / SHARE)))["impact_energy_error"]
    assert seen.value == pytest.approx(gain, rel=1e-6)


def test_an_engine_without_restitution_is_not_said_to_lose_energy() -> None:
    seen = {one.property: one for one in findings(Faults(restitution=0.2))}
    assert seen["impact_energy_error"].verdict == "not-probed"
    assert "gives back 0.2 of the speed of approach" in seen["impact_energy_error"].probe
    assert seen["impact_momentum_error"].verdict == seen["impact_angular_momentum_error"].verdict == "none"


def test_momentum_and_angular_momentum_that_an_impact_makes_are_found() -> None:
    assert "impact_momentum_error" in found(Faults(leak=0.02))
    turning = found(Faults(untwisted=0.2))
    assert "impact_angular_momentum_error" in turning
    assert "impact_momentum_error" not in turning


def test_friction_along_an_axis_of_the_world_is_found_whether_the_box_is_turned_or_not() -> None:
    seen = found(Faults(pyramid=True))
    assert set(seen) == {"friction-anisotropy", "sideways-friction"}
    assert len(seen["friction-anisotropy"]) == len(seen["sideways-friction"]) == 2
    # Against the velocity the force is the cosine of the angle to the axis: at 30 degrees 0.866. At 45 degrees both axes pull.
    assert all("1.000, 0.966, 0.866" in one.probe for one in seen["friction-anisotropy"])
    assert all(one.value == pytest.approx(0.5, rel=0.01) for one in seen["sideways-friction"])


def test_friction_that_depends_on_the_axes_of_the_box_is_found_where_the_box_is_not_turned_with_the_motion() -> None:
    seen = found(Faults(stronger_along=0.25))
    assert set(seen) == {"friction-anisotropy", "sideways-friction"}
    (uneven,), (aside,) = seen["friction-anisotropy"], seen["sideways-friction"]
    assert "edges along the axes of the world" in uneven.probe
    assert uneven.value == pytest.approx(1 - 1.125 / 1.25, rel=0.02)
    # Until the end, friction turns the path by some 0.02 rad, and half of it is taken from the mean force sideways.
    assert abs(aside.value or 0) == pytest.approx(0.125, abs=0.015)


def test_what_an_engine_keeps_besides_positions_and_velocities_is_found() -> None:
    seen = found(Faults(ageing=1e-6))
    assert set(seen) == {"hidden-state"}
    assert [one.probe.split(",")[0] for one in seen["hidden-state"]] == [
        "restart: a box that slides and spins",
        "restart: three boxes on one another",
    ]


def test_children_that_are_stepped_before_their_parents_are_found() -> None:
    seen = found(Faults(stale=True))
    assert set(seen) == {"order-of-bodies"}
    words = {one.probe for one in seen["order-of-bodies"]}
    assert "permutation: bodies listed child before parent" in words
    # The engine takes its joints in the order of the bodies.
    assert "permutation: joints listed child before parent" not in words


@pytest.fixture
def few_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(long_run, "STEPS", 10_000)


def told(own: Defaults) -> dict[str, Finding]:
    return {one.property: one for one in long_run.long_run(Pilot(Planted(own), "steady", TIMESTEP))}


def test_in_very_many_steps_rounding_and_norms_are_found(few_steps: None) -> None:
    sound, single, long = told(Defaults()), told(Defaults(single=True)), told(Defaults(norm=1e-9))
    assert {one.verdict for one in sound.values()} == {"none"}
    assert all(one.probe == "long-run: 10000 steps" for one in sound.values())
    assert single["long-time-base"].verdict == "found"
    assert long["long-quaternion-norm"].verdict == "found"
    assert long["long-quaternion-norm"].value == pytest.approx(1e-9, rel=1e-6)
    assert told(Defaults(clock=1e-6))["long-time-base"].value == pytest.approx(1e-6, rel=1e-3)


def test_a_body_that_slows_down_has_no_long_time_base(few_steps: None) -> None:
    assert told(Defaults(linear=0.1))["long-time-base"].verdict == "not-probed"


def test_the_number_of_steps_taken_within_the_limit_of_time_stands_in_the_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(long_run, "LIMIT_S", 0.0)
    assert {one.probe for one in told(Defaults()).values()} == {"long-run: 1000 steps"}


def test_probes_of_contact_are_made_of_methods_on_a_plane_and_the_others_of_flights() -> None:
    kinds: set[Kind] = {"plane", "mechanism"}
    assert set(SCENES.values()) == kinds
    assert set(SCENES) < set(PROBES)
