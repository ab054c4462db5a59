"""Energies and momenta of mechanisms against formulas written by hand."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import BodyStart, Mechanism
from bodycheck.reference.mechanisms.observables import floats, observe
from bodycheck.reference.requirements import of_mechanism
from bodycheck.reference.trajectory import Trajectory
from tests.support import jointed


def test_energies_of_the_cart_and_pole_are_those_of_its_lagrangian() -> None:
    plain = jointed.cart_pole()
    rail = replace(plain.joints[0], armature=0.7, stiffness=5.0, rest=0.2)
    pin = replace(plain.joints[1], armature=0.03, effort=0.6)
    mechanism = replace(plain, joints=(rail, pin))
    x, a, dx, da = 0.4, 1.2, -0.8, 2.5
    seen = observe(mechanism, kinematics.bodies(mechanism, jointed.coordinates(x, a, dx, da), t=np.zeros(1)))
    arm, mass, moment = 0.35, 0.4, 0.017
    kinetic = (2.3 + 0.7 + mass) * dx**2 + 2 * mass * arm * np.cos(a) * dx * da + (moment + mass * arm**2 + 0.03) * da**2
    height = arm * (np.cos(a) - np.cos(0.3))
    potential = mass * 9.81 * height + 5.0 * (x - 0.2) ** 2 / 2 - 0.6 * (a - 0.3)
    assert seen.kinetic_energy == pytest.approx(kinetic / 2, rel=1e-14)
    assert seen.potential_energy == pytest.approx(potential, rel=1e-14)
    assert seen.momentum[0] == pytest.approx([2.7 * dx + mass * arm * np.cos(a) * da, 0, -mass * arm * np.sin(a) * da])


def test_momenta_do_not_depend_on_the_origin_and_its_velocity() -> None:
    mechanism = jointed.tree()
    start = kinematics.initial(mechanism)
    seen = observe(mechanism, start)
    shift, speed = np.array([10.0, -20.0, 5.0]), np.array([3.0, 2.0, -1.0])
    moved = observe(mechanism, replace(start, position=start.position + shift, velocity=start.velocity + speed))
    mass = 0.3 + 0.7 + 0.4 + 0.5 + 0.6 + 0.7 + 0.8 + 0.9
    assert moved.momentum - seen.momentum == pytest.approx(mass * speed[None])
    # Rounding of positions of 20 m, whose moments cancel.
    assert moved.angular_momentum == pytest.approx(seen.angular_momentum, rel=1e-13)


def test_the_angular_momentum_of_a_rigid_pair_is_that_of_one_body() -> None:
    """Two point-like bodies 2 m apart that turn about their common centre."""
    pair = Mechanism(tuple(replace(jointed.body(name, 1.5, (0.2, 0.3, 0.4)), start=BodyStart()) for name in ("one", "two")))
    position, velocity = (np.array([[side], [np.negative(side)]]) for side in ([1.0, 0.0, 0.0], [0.0, 2.0, 0.0]))
    turn = np.tile([1.0, 0.0, 0.0, 0.0], (2, 1, 1))
    seen = observe(pair, Trajectory(np.zeros(1), position, turn, velocity, np.tile([0.0, 0.0, 2.0], (2, 1, 1))))
    assert seen.angular_momentum == pytest.approx(np.array([[0.0, 0.0, 2 * (0.4 + 1.5) * 2.0]]))


def test_a_mechanism_that_nothing_holds_floats() -> None:
    assert not floats(jointed.cart_pole())
    assert not floats(jointed.tree())
    tree = jointed.tree()
    assert floats(replace(tree, bodies=tree.bodies[:5], joints=tree.joints[:4]))


def test_requirements_name_what_a_mechanism_uses() -> None:
    plain = jointed.cart_pole()
    assert of_mechanism(plain).names() == ("mechanisms", "gravity", "revolute joints", "prismatic joints")
    assert of_mechanism(plain).degrees_of_freedom == 2
    damped = replace(plain.joints[0], damping=0.1, friction=0.2)
    point = replace(plain.bodies[1], inertia=jointed.Tensor(0.4, ((0.1, 0.1, 0.0), (0.1, 0.1, 0.0), (0.0, 0.0, 1.0))))
    found = of_mechanism(replace(plain, joints=(damped, plain.joints[1]), bodies=(plain.bodies[0], point), gravity=0.0))
    assert found.names() == (
        *("mechanisms", "revolute joints", "prismatic joints"),
        *("joint damping", "joint friction", "point masses"),
    )
    whole = of_mechanism(jointed.tree())
    assert set(whole.names()) >= {"ball joints", "free joints", "fixed joints", "planar joints", "universal joints", "armature"}
    assert whole.degrees_of_freedom == 6 + 1 + 1 + 3 + 2 + 3 + 6


def test_joint_motion_can_be_cut() -> None:
    motion = JointMotion(np.arange(6.0).reshape(3, 2), np.ones((3, 2)))
    assert motion.part(slice(1, 2)).position.tolist() == [[2.0, 3.0]]
