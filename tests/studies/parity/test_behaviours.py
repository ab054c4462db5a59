"""What joints do stands in the rows, and what an engine tells beside it."""

from collections.abc import Mapping
from dataclasses import replace

from bodycheck.adapters.contract import Engine
from bodycheck.adapters.robot_reading import Behaviour
from bodycheck.reference.robots.model import Mimic, RobotModel
from bodycheck.reference.robots.states import seeded_states
from bodycheck.studies.parity.comparing import asked
from bodycheck.studies.parity.conventions import PROBES
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.study import Asking, of_answer
from tests.support.engine_readings import GRAVITY, reading
from tests.support.robot_motions import NAMES, RULE, file_model

ENGINE = Engine("miniature", "miniature", "1.0", (), frozenset())


def rows(model: RobotModel, behaviours: Mapping[str, Behaviour]) -> dict[tuple[str | None, str], Compared]:
    """The rows of an engine that tells what the file says, by quantity and subject."""
    states = seeded_states(model, 3 + PROBES, 0)
    answer = replace(reading(model, states), behaviours=behaviours)
    compared, _ = of_answer(answer, asked(model, states, GRAVITY, False), ENGINE, Asking())
    return {(row.quantity, row.subject): row for row in compared}


def test_what_is_read_from_records_is_marked_as_told_and_what_is_computed_is_not() -> None:
    by_place = rows(file_model(lower={"first": -1.0}, upper={"first": 1.0}), {})
    assert {row.status for row in by_place.values()} == {"agrees"}
    assert by_place["joint_type", "first"].source == "told"
    assert by_place["inertia", "first"].source == "told"
    assert by_place["mass_matrix", "model"].source == "behaviour"


def test_a_limit_that_is_told_and_not_enforced_differs() -> None:
    model = file_model(lower={"first": -1.0}, upper={"first": 1.0})
    row = rows(model, {"first": Behaviour(frozenset({"limits"}))})["joint_type", "first"]
    assert (row.status, row.cause, row.source) == ("differs", "limits-ignored", "behaviour")
    assert row.engine_value == "revolute; not enforced, but told: from -1.0 to 1.0"


def test_a_limit_that_is_told_and_not_enforced_agrees_with_a_file_without_limits() -> None:
    model = file_model()
    states = seeded_states(model, 3 + PROBES, 0)
    answer = reading(file_model(lower={"first": -1.0}, upper={"first": 1.0}), states)
    answer = replace(answer, behaviours={"first": Behaviour(frozenset({"limits"}))})
    compared, _ = of_answer(answer, asked(model, states, GRAVITY, False), ENGINE, Asking())
    (row,) = (row for row in compared if (row.quantity, row.subject) == ("joint_type", "first"))
    assert (row.status, row.source) == ("agrees", "behaviour")
    assert "not enforced, but told: from -1.0 to 1.0" in row.engine_value


def test_a_mimic_with_exchanged_joints_is_named_though_the_records_are_right() -> None:
    behaviour = Behaviour(frozenset({"mimic"}), mimic=Mimic("first", 0.5, -0.05))
    row = rows(file_model(mimic={"second": RULE}), {"second": behaviour})["joint_type", "second"]
    assert (row.status, row.cause, row.source) == ("differs", "mimic-inverted", "behaviour")


def test_damping_and_friction_that_are_told_and_do_not_brake_are_ignored() -> None:
    model = file_model(damping=dict.fromkeys(NAMES, 0.5), friction=dict.fromkeys(NAMES, 0.3))
    behaviour = Behaviour(frozenset({"damping", "friction"}), damping=0.5, friction=0.0)
    by_place = rows(model, {"first": behaviour})
    assert by_place["damping", "first"].source == "behaviour"
    assert by_place["damping", "second"].source == "told"
    row = by_place["friction", "first"]
    assert (row.status, row.cause, row.engine_value) == ("differs", "friction-ignored", "0.0; not enforced, but told: 0.3")
