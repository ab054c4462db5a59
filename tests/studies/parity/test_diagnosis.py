"""Faults of readers are named rightly, alone and two at once, by what an engine tells and by what it computes alone."""

from collections.abc import Iterable
from dataclasses import replace
from itertools import combinations
from random import Random

import numpy as np
import pytest

from bodycheck.reference.robots.dynamics import velocity_labels
from bodycheck.reference.robots.model import Mimic, RobotModel, with_joint
from bodycheck.reference.robots.states import seeded_states
from bodycheck.studies.parity.comparing import asked, compare
from bodycheck.studies.parity.conventions import CANDIDATES, PROBES, Frame, Point, Written, written
from bodycheck.studies.parity.diagnosis.explaining import diagnosed
from bodycheck.studies.parity.rows import Compared
from tests.support.engine_readings import GRAVITY, reading
from tests.support.robot_faults import FAULTS, PlantedFault, clean_model, planted
from tests.support.robot_trees import random_rotation, random_tree

#: Differences that are no rounding: the reference computes both sides, in which rounding leaves some 1e-16.
TOLERANCE = 1e-10


def rows(file: RobotModel, engine: RobotModel, count: int = 12, **options: object) -> tuple[Compared, ...]:
    states = seeded_states(file, count + PROBES, 0)
    given = asked(file, states, GRAVITY, False)
    return diagnosed(compare(given, reading(engine, states, **options), TOLERANCE)).rows  # type: ignore[arg-type]


def named(found: tuple[Compared, ...]) -> set[tuple[str, str]]:
    """The causes with the bodies and joints that rows name."""
    return {(row.cause, row.subject) for row in found if row.cause}


def causes(found: tuple[Compared, ...]) -> set[str]:
    return {row.cause for row in found if row.cause}


def expected(*faults: PlantedFault) -> set[tuple[str, str]]:
    return {(fault.cause, fault.subject) for fault in faults}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_is_named_with_its_subject_and_no_other_cause(fault: PlantedFault) -> None:
    found = rows(*planted(fault))
    assert expected(fault) <= named(found)
    assert causes(found) == {fault.cause}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_is_named_by_what_an_engine_computes_that_tells_no_numbers(fault: PlantedFault) -> None:
    if fault.cause == "base-welded":
        pytest.skip("the mass of a welded base is in nothing that an engine computes")
    found = rows(*planted(fault), tells=False)
    assert expected(fault) <= named(found)
    assert causes(found) == {fault.cause}


def test_a_joint_whose_damping_and_friction_are_not_used_has_a_row_for_each() -> None:
    """An engine tells both rightly, and has neither in its accelerations."""
    clean = clean_model()
    file = with_joint(clean, "rail", damping=0.5, friction=0.25)
    states = seeded_states(file, 12 + PROBES, 0)
    terms = tuple(replace(own, passive_force=None) for own in reading(clean, states).terms)
    told = replace(reading(file, states), terms=terms)
    found = diagnosed(compare(asked(file, states, GRAVITY, False), told, TOLERANCE)).rows
    rail = [(row.quantity, row.cause) for row in found if row.subject == "rail" and row.cause]
    assert sorted(rail) == [("forward_dynamics", "damping-ignored"), ("forward_dynamics", "friction-ignored")]


def test_a_friction_of_another_size_is_no_constraint() -> None:
    """A constraint has up to the size of the file, in either direction; half of it at every state is another friction."""
    friction = next(fault for fault in FAULTS if fault.cause == "friction-ignored")
    file = friction.in_file(clean_model())
    half = with_joint(file, friction.subject, friction=0.5 * next(joint.friction for joint in file.joints if joint.friction))
    found = rows(file, half, tells=False)
    assert {row.status for row in found if row.quantity == "passive_force"} == {"differs"}


@pytest.mark.parametrize("turns", ["weld", "place"])
def test_a_weld_that_is_put_elsewhere_by_a_turn_is_fused_wrongly(turns: str) -> None:
    """The weld's place is turned about the origin of the body, or that of the link's centre of mass is."""
    file = planted()[0]
    weld = next(joint for joint in file.joints if joint.name == "weld")
    turn = random_rotation(Random(5))
    position = turn @ weld.position
    if turns == "place":
        centre = weld.rotation @ next(link for link in file.links if link.name == "tool").center_of_mass
        position = turn @ (weld.position + centre) - centre
    found = rows(file, with_joint(file, "weld", position=position))
    assert named(found) >= {("inertia-fused", "arm_1")}
    assert causes(found) == {"inertia-fused"}


def missed(pairs: Iterable[tuple[PlantedFault, PlantedFault]]) -> list[tuple[str, str, list[tuple[str, str]]]]:
    """The pairs of faults of different subjects that are not named both, or with a cause that neither has."""
    wrong = []
    for one, other in pairs:
        if one.subject == other.subject:
            continue  # two faults of one body may be one of another kind, or cancel
        file, engine = planted(one, other)
        found = rows(file, engine, 6)
        if not (expected(one, other) <= named(found) and causes(found) == {one.cause, other.cause}):
            wrong.append((one.name, other.name, sorted(named(found))))
    return wrong


def test_two_faults_at_once_are_named_both_and_nothing_else() -> None:
    assert not missed(list(combinations(FAULTS, 2))[::4])  # every fault is in some pair


@pytest.mark.slow
def test_any_two_faults_at_once_are_named_both_and_nothing_else() -> None:
    assert not missed(combinations(FAULTS, 2))


@pytest.mark.parametrize("how", CANDIDATES["floating"][::5], ids=str)  # every axis, point and order among them
def test_a_clean_model_has_no_cause_however_a_floating_base_is_written(how: Written) -> None:
    random = Random(str(how))
    model = random_tree(random, 6, floating=True)
    floating = next(joint.name for joint in model.joints if joint.type == "floating")
    found = rows(model, model, how={floating: how}, order=_shuffled(random, model))
    assert not named(found)
    assert {row.status for row in found} <= {"agrees"}


@pytest.mark.parametrize("point", ["origin", "center of mass"])
def test_the_mass_matrix_tells_the_point_of_a_single_body(point: Point) -> None:
    model = random_tree(Random(513), 1, floating=True)
    how = Written("child", "child", point, True)
    states = seeded_states(model, 6 + PROBES, 0)
    told = reading(model, states, how={"joint_0": how})
    # The Jacobian of the body is of the same point and along the same axes as its velocity.
    own = tuple(replace(terms, jacobians={"link_0": np.roll(np.eye(6), 3, axis=1)}) for terms in told.terms)
    given = asked(model, states, GRAVITY, False)
    found = compare(given, replace(told, terms=own), TOLERANCE)
    assert "mass_matrix" not in {row.quantity for row in found.rows if row.status != "agrees"}


@pytest.mark.parametrize(("wrong", "statuses"), [(12 + PROBES, {"agrees"}), (12, {"differs"})], ids=["everywhere", "compared"])
def test_a_convention_is_that_of_the_probes(wrong: int, statuses: set[str]) -> None:
    """An engine may take the efforts of the state for its own velocities.

    If it does so only where it is compared, and converts them at the probes, its accelerations are wrong by such a conversion.
    """
    model, form = random_tree(Random(7), 1, floating=True), Written("child", "parent", "origin", True)
    states = seeded_states(model, 12 + PROBES, 0)
    converted = reading(model, states, how={"joint_0": form})
    matrices, _ = written(model, "joint_0", states, form)
    terms = list(converted.terms)
    for index, (state, matrix) in enumerate(zip(states[:wrong], matrices, strict=False)):
        effort, mass = np.array(state.efforts["joint_0"]), np.asarray(terms[index].mass_matrix)
        missing = np.linalg.inv(matrix).T @ effort - effort
        acceleration = np.asarray(terms[index].forward_dynamics) - np.linalg.solve(mass, missing)
        terms[index] = replace(terms[index], forward_dynamics=acceleration)
    compared = compare(asked(model, states, GRAVITY, False), replace(converted, terms=tuple(terms)), TOLERANCE)
    assert {row.status for row in compared.rows if row.quantity == "forward_dynamics"} == statuses
    assert compared.convention.efforts == ("as in the state" if statuses == {"agrees"} else "converted")
    (row,) = (row for row in compared.rows if row.quantity == "forward_dynamics")
    assert "it writes the velocity of joint_0 as" in row.convention
    assert f"the efforts of its forward dynamics are {compared.convention.efforts}" in row.convention


@pytest.mark.parametrize(("wrong", "statuses"), [(12 + PROBES, {"agrees"}), (12, {"differs"})], ids=["everywhere", "compared"])
def test_whether_followers_have_efforts_is_decided_at_the_probes(wrong: int, statuses: set[str]) -> None:
    """An engine may hold a joint that follows another one by a constraint, and give it no effort.

    If it leaves the effort out only where it is compared, its accelerations are wrong there.
    """
    plain = random_tree(Random(11), 3, types=("revolute",))
    leader, follower, *_ = plain.joints
    followed = replace(follower, mimic=Mimic(leader.name, 1.0, 0.0))
    model = replace(plain, joints=(leader, followed, *plain.joints[2:]))
    states = seeded_states(model, 12 + PROBES, 0)
    engine = reading(model, states)
    index = [name for name, _ in velocity_labels(model)].index(follower.name)
    terms = list(engine.terms)
    for place, state in enumerate(states[:wrong]):
        effort = np.zeros(len(velocity_labels(model)))
        effort[index] = state.efforts[follower.name][0]
        missing = np.linalg.solve(np.asarray(terms[place].mass_matrix), effort)
        terms[place] = replace(terms[place], forward_dynamics=np.asarray(terms[place].forward_dynamics) - missing)
    joints = tuple(replace(joint, mimic=followed.mimic) if joint.name == follower.name else joint for joint in engine.joints)
    compared = compare(asked(model, states, GRAVITY, False), replace(engine, terms=tuple(terms), joints=joints), TOLERANCE)
    (row,) = (row for row in compared.rows if row.quantity == "forward_dynamics")
    assert {row.status} == statuses
    assert row.convention == ("its joints that follow others have no efforts" if statuses == {"agrees"} else "")


def test_joints_of_one_type_have_one_form() -> None:
    """An engine that writes the velocity of one ball joint along other axes than those of all others is wrong there."""
    model = random_tree(Random(3), 8, types=("spherical",))
    parents = {joint.parent for joint in model.joints}
    wrong = next(joint.name for joint in model.joints if joint.type == "spherical" and joint.child not in parents)
    states = seeded_states(model, 12 + PROBES, 0)
    compared = compare(
        asked(model, states, GRAVITY, False), reading(model, states, how={wrong: Written(angular="joint")}), TOLERANCE
    )
    assert set(compared.convention.joints.values()) == {Written()}
    assert "differs" in {row.status for row in compared.rows if row.quantity == "mass_matrix"}


@pytest.mark.parametrize("seed", range(5))
def test_a_clean_tree_has_no_cause_in_any_order_of_its_joints(seed: int) -> None:
    random = Random(seed)
    model = random_tree(random, 12, types=("revolute", "prismatic", "fixed", "spherical"))
    angular: Frame = "parent" if seed % 2 else "joint"
    spherical = {joint.name: Written(angular=angular) for joint in model.joints if joint.type == "spherical"}
    found = rows(model, model, how=spherical, order=_shuffled(random, model))
    assert not named(found)
    assert {row.status for row in found} <= {"agrees"}


def _shuffled(random: Random, model: RobotModel) -> list[str]:
    names = list(dict.fromkeys(name for name, _ in velocity_labels(model)))
    random.shuffle(names)
    return names
