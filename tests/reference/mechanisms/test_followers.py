"""Joints that follow others, against closed forms, conservation laws, equivalent mechanisms, and planted faults."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck.reference.errors import NotModelled
from bodycheck.reference.mechanisms import followed, mimicry, observables
from bodycheck.reference.mechanisms.articulation import coupling
from bodycheck.reference.mechanisms.forms.momentum import floating
from bodycheck.reference.mechanisms.lagrangian import mass_matrix
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism, Mimic
from bodycheck.reference.mechanisms.start import coordinates
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.truths import Truth
from tests.support.jointed import body, four_bar, free_chain

TIMES = np.linspace(0.0, 1.0, 6)


def started(mechanism: Mechanism) -> Mechanism:
    """The mechanism, of which the joints that follow others begin where their rules say."""
    joints = list(mechanism.joints)
    for index, joint in enumerate(joints):
        if joint.mimic is not None:
            position, velocity = mimicry.start(joints, index)
            joints[index] = replace(joint, start=(float(position),), start_velocity=(float(velocity),))
    return replace(mechanism, joints=tuple(joints))


def following(mechanism: Mechanism, rules: dict[int, Mimic]) -> Mechanism:
    """A mechanism of which joints follow others by rules, by the indices of the joints."""
    joints = (replace(joint, mimic=rules.get(index)) for index, joint in enumerate(mechanism.joints))
    return started(replace(mechanism, joints=tuple(joints)))


def arm(parents: tuple[int, ...] = (WORLD, 0, 1, 2), **acting: float) -> Mechanism:
    """Four bodies on hinges about different axes and a slider, each on the body that `parents` names."""
    moments, axes = (0.02, 0.03, 0.025), ((0.0, 1.0, 0.0), (0.3, 1.0, 0.0), (1.0, 0.0, 0.2), (0.0, 0.6, 0.8))
    joints = (
        Joint(
            *(f"joint-{n}", "prismatic" if n == 2 else "revolute", parent, n, (0.3, 0.1 * n, 0.0)),
            axis=axes[n],
            start=(0.1 * n + 0.2,),
            start_velocity=(0.7 - 0.3 * n,),
            **acting,
        )
        for n, parent in enumerate(parents)
    )
    return Mechanism(tuple(body(f"body-{n}", 1.0, moments, (0.2, 0.1, 0.0)) for n in range(4)), tuple(joints), gravity=9.81)


#: Rules by which a joint follows an ancestor, a descendant, a chain of two, a sibling, and a joint of another tree.
FOLLOWING = {
    "ancestor": following(arm(), {2: Mimic(0, 0.5, 0.1)}),
    "descendant": following(arm(damping=0.1), {0: Mimic(3, -2.0, 0.3)}),
    "chain": following(arm(armature=0.1, stiffness=2.0, rest=0.3, effort=0.5), {1: Mimic(0, 0.7), 3: Mimic(1, -1.0, 0.2)}),
    "sibling": following(arm((WORLD, 0, 0, 2)), {1: Mimic(2, 1.5), 3: Mimic(2, 0.5)}),
    "other tree": following(arm((WORLD, 0, WORLD, 2)), {3: Mimic(0, -1.0, 0.5)}),
}


def two_chains() -> Mechanism:
    """The chain that floats, twice; the joints of the second one have the indices 2 and 3."""
    chain = free_chain()
    bodies = tuple(replace(each, name=f"{each.name}-2") for each in chain.bodies)
    joints = (replace(each, name=f"{each.name}-2", parent=each.parent + 3, child=each.child + 3) for each in chain.joints)
    return Mechanism((*chain.bodies, *bodies), (*chain.joints, *joints), gravity=9.81)


def truth_of(mechanism: Mechanism) -> Truth:
    return mechanism_truth(mechanism, TIMES)


@pytest.mark.parametrize("name", ["chain", "sibling", "other tree"])
def test_recursion_and_lagrangian_agree(name: str) -> None:
    truth = truth_of(FOLLOWING[name])
    assert truth.witnesses
    assert truth.joints is not None
    assert truth.bounds.error.max() < 1e-14  # 1e-15 if nothing is added for a disagreement
    for index, joint in enumerate(FOLLOWING[name].joints):
        if joint.mimic is not None:
            leader = truth.joints.position[:, joint.mimic.joint]
            expected = joint.mimic.multiplier * leader + joint.mimic.offset
            np.testing.assert_allclose(
                truth.joints.position[:, index], expected, rtol=0, atol=4 * np.spacing(np.abs(expected)).max()
            )


@pytest.mark.parametrize("name", ["chain", "other tree"])
def test_energy_is_conserved(name: str) -> None:
    mechanism = FOLLOWING[name]
    truth = truth_of(mechanism)
    assert mechanism.conserves
    seen = observables.observe(mechanism, truth.trajectory)
    assert np.ptp(seen.total_energy) < 1e-14 * np.abs(seen.kinetic_energy).max()


def test_two_wheels_turn_as_their_inertias_and_torques_say() -> None:
    """The first has the acceleration (e1 + m e2) / (I1 + m^2 I2), with armatures in I, and the second m times it."""
    bodies = tuple(body(name, 1.0, (1.0, 1.0, moment)) for name, moment in (("one", 0.5), ("two", 0.25)))
    joints = (
        Joint("first", "revolute", WORLD, 0, armature=0.5, effort=1.0, start=(0.25,), start_velocity=(1.0,)),
        Joint("second", "revolute", WORLD, 1, (1.0, 0.0, 0.0), effort=-0.25, armature=0.25, mimic=Mimic(0, -2.0, 0.5)),
    )
    truth = truth_of(started(Mechanism(bodies, joints)))
    assert truth.joints is not None
    expected = 0.25 + TIMES + 1.5 / 3.0 * TIMES**2 / 2
    np.testing.assert_allclose(truth.joints.position, np.stack([expected, 0.5 - 2 * expected], axis=1), rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize("type", ["revolute", "prismatic"])
def test_a_joint_that_follows_with_a_multiplier_of_zero_is_fixed_at_its_offset(type: Any) -> None:
    rule = Mimic(0, 0.0, 0.0 if type == "revolute" else 0.25)
    follower = replace(arm().joints[1], type=type, axis=(0.0, 0.0, 1.0), mimic=rule)
    joints = (arm().joints[0], follower, *arm().joints[2:])
    held = truth_of(started(replace(arm(), joints=joints)))
    shifted = Joint("joint-1", "fixed", 0, 1, (0.3, 0.1, rule.offset))
    fixed = truth_of(replace(arm(), joints=(joints[0], shifted, *joints[2:])))
    assert (
        np.abs(held.trajectory.position - fixed.trajectory.position).max(axis=(0, 2)) <= 2 * held.bounds.position_error
    ).all()
    assert (
        np.abs(held.trajectory.velocity - fixed.trajectory.velocity).max(axis=(0, 2)) <= 2 * held.bounds.velocity_error
    ).all()


def test_momenta_of_trees_that_float_are_conserved_though_a_joint_follows_one_of_another_tree() -> None:
    """The forces of the coupling act on both bodies of each joint."""
    mechanism = following(two_chains(), {3: Mimic(0, -1.5, 0.2)})
    truth = truth_of(mechanism)
    assert truth.bounds.error.max() < 1e-14
    masses = observables.masses(mechanism)
    for tree in floating(mechanism, TIMES):
        bodies = list(tree.bodies)
        centre = (masses[bodies, None, None] * truth.trajectory.position[bodies]).sum(axis=0) / masses[bodies].sum()
        np.testing.assert_allclose(centre, tree.centre.astype(float), rtol=0, atol=float(truth.bounds.position_error.max()))
    assert len(floating(mechanism, TIMES)) == 2


def test_a_follower_whose_body_has_no_mass_needs_none() -> None:
    """The mass matrix of the independent coordinates is positive definite, and that of all coordinates is not."""
    frame = JointedBody("frame", body("frame", 0.0, (0.0, 0.0, 0.0)).inertia)
    mechanism = following(replace(arm(), bodies=(*arm().bodies[:3], frame)), {3: Mimic(0, 1.0)})
    assert all(each.loose > 1e-3 for each in coordinates(mechanism))
    assert len(coordinates(mechanism)) == 3
    assert truth_of(mechanism).bounds.error.max() < 1e-14


def test_the_inertia_at_the_start_is_that_of_the_energy() -> None:
    """Twice the kinetic energy for a unit velocity of a coordinate is its diagonal element of the mass matrix."""
    for name in ("sibling", "chain"):
        mechanism = FOLLOWING[name]
        for each in coordinates(mechanism):
            alone = (replace(joint, start_velocity=(float(n == each.joint),)) for n, joint in enumerate(mechanism.joints))
            moving = started(replace(mechanism, joints=tuple(alone)))
            start = mechanism_truth(moving, np.zeros(1), vouched=False)
            energy = observables.observe(moving, start.trajectory).kinetic_energy[0]
            assert abs(2 * energy - float(each.locked)) < 1e-14 * float(each.locked)
            assert 0 < each.loose <= each.locked


@pytest.mark.parametrize("way", ["recursion", "lagrangian"])
def test_a_share_that_is_missing_once_in_an_inertia_is_found(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if way == "recursion":
        hold = coupling.Shared.hold

        def once(shared: coupling.Shared, leader: int, share: Any, weight: Any, need: Any, responses: Any) -> None:
            hold(shared, leader, share, weight / share, need, responses)

        monkeypatch.setattr(coupling.Shared, "hold", once)
    else:
        reduced = mass_matrix.reduced
        monkeypatch.setattr(
            "bodycheck.reference.mechanisms.lagrangian.equations.reduced",
            lambda tape, matrix, shares: reduced(tape, matrix, [(index, tape.one) for index, _ in shares]),
        )
    mechanism = following(arm((WORLD, 0, 0, 1)), {1: Mimic(0, 1.25), 2: Mimic(0, 0.5)})
    assert truth_of(mechanism).bounds.error.max() > 1e-3


def test_what_is_not_modelled_beside_followers_is_named() -> None:
    dry = (replace(arm().joints[0], friction=0.1), *arm().joints[1:])
    with pytest.raises(NotModelled, match="dry friction on joints that follow others or are followed: joint-0"):
        truth_of(following(replace(arm(), joints=dry), {1: Mimic(0)}))
    with pytest.raises(NotModelled, match="joints that follow others in a mechanism with loops"):
        truth_of(following(four_bar(), {1: Mimic(0)}))


def test_a_joint_with_dry_friction_beside_followers_has_a_truth() -> None:
    rubbing = replace(arm().joints[3], friction=0.2)
    mechanism = following(replace(arm(), joints=(*arm().joints[:3], rubbing)), {1: Mimic(0, 0.5)})
    truth = truth_of(mechanism)
    assert truth.witnesses
    assert truth.bounds.error.max() < 1e-13
    assert followed.followed(mechanism, TIMES).growth is not None
