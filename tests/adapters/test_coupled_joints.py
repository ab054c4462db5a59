"""Several joints of one body, bodies without mass, and joints that follow others, in MuJoCo and Pinocchio."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.kinematics import joints
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, Loop, Mechanism, Mimic
from bodycheck.reference.trajectory import Array
from tests.support.coupled_joints import MOMENTS, begun, gripper, hip, massless, pair, spinning
from tests.support.coupled_runs import errors, orders
from tests.support.jointed import body, trajectory

STEP, STEPS = 0.001, 200

#: A stiff constraint of MuJoCo: its time constant is a tenth of the step of `STIFF_STEP`.
STIFF, STIFF_STEP = "RK4:solref=-1e7 -6e3,solimp=0.9999 0.9999 0.001", 1e-4

#: Fingers with something of everything in the joint that follows.
FINGERS = gripper(armature=0.02, damping=0.1, stiffness=2.0, rest=0.1, effort=0.3)

METHODS = [("mujoco", "RK4"), ("mujoco", "Euler"), ("pinocchio", "rk4"), ("pinocchio", "semi-implicit-euler")]


def end(name: str, mechanism: Mechanism, spelling: str, step: float = STEP, duration: float = STEP * STEPS) -> Array:
    """The states (bodies, 13) at the end of a run."""
    simulation = registry.load(name).prepare([mechanism], Method.parse(spelling, step))
    return simulation.advance(np.array([round(duration / step)]))[0, 0]


def apart(first: Array, second: Array) -> float:
    """The largest difference between states (bodies, 13), with attitudes by their angle."""
    angles = geodesic_angle(first[:, 3:7], second[:, 3:7])
    return float(max(angles.max(), np.abs(np.delete(first - second, slice(3, 7), 1)).max()))


@pytest.mark.parametrize(("name", "spelling"), METHODS)
def test_two_hinges_of_one_body_are_a_universal_joint(name: str, spelling: str) -> None:
    place, arm = ((0.1, 0.2, 0.3), (0.8, 0.2, -0.4, 0.4)), body("arm", 0.6, MOMENTS, (0.1, 0.2, -0.4))
    cross = Joint("cross", "universal", WORLD, 0, *place, start=(0.4, 0.9), start_velocity=(2.0, -1.0))
    one = Joint("x", "revolute", WORLD, 0, *place, axis=(1.0, 0.0, 0.0), start=(0.4,), start_velocity=(2.0,))
    two = Joint("y", "revolute", 0, 1, axis=(0.0, 1.0, 0.0), start=(0.9,), start_velocity=(-1.0,))
    alone = end(name, Mechanism((arm,), (cross,), gravity=9.81), spelling)
    chain = end(name, Mechanism((massless("arm:x"), arm), (one, two), gravity=9.81), spelling)
    assert apart(alone[:1], chain[1:]) < 1e-12  # rounding of 200 steps; rates are some rad/s


def test_engines_that_share_a_scheme_agree_on_several_joints_of_a_body() -> None:
    """Bodies without mass included; rounding of 200 steps, with rates of some rad/s."""
    assert apart(end("mujoco", hip(), "RK4"), end("pinocchio", hip(), "rk4")) < 1e-11


@pytest.mark.parametrize(
    ("name", "spelling", "order"),
    [("mujoco", "RK4", 4), ("pinocchio", "rk4", 4), ("mujoco", "Euler", 1), ("pinocchio", "semi-implicit-euler", 1)],
)
def test_several_joints_of_a_body_converge_to_the_truth_with_the_order_of_the_scheme(
    name: str, spelling: str, order: int
) -> None:
    sizes = errors(registry.load(name), hip(), spelling)
    assert orders(sizes) == pytest.approx([order] * 2, abs=0.1)  # terms of the next order are a tenth at these steps
    assert sizes[-1] < (1e-11 if order == 4 else 1e-3)


@pytest.mark.parametrize("multiplier", [-2.0, 0.5])
@pytest.mark.parametrize(("name", "spelling", "step"), [("pinocchio", "rk4", STEP), ("mujoco", STIFF, STIFF_STEP)])
def test_a_pair_of_wheels_has_the_inertia_and_the_forces_of_both(
    name: str, spelling: str, step: float, multiplier: float
) -> None:
    states = end(name, pair(multiplier), spelling, step)
    # The stiff constraint of MuJoCo yields by (1 - d) = 1e-4 of an acceleration over its stiffness, 1e7 1/s^2.
    limit = 1e-12 if name == "pinocchio" else 1e-7
    assert states[:, 12] == pytest.approx(np.array([1.0, multiplier]) * spinning(multiplier, STEP * STEPS), abs=limit)


@pytest.mark.parametrize(("name", "limit"), [("pinocchio", 1e-12), ("mujoco", 1e-3)])
def test_a_joint_that_follows_with_the_multiplier_zero_is_fixed(name: str, limit: float) -> None:
    """To rounding in Pinocchio. MuJoCo's constraint is soft: it yields by 1e-4 m here, and a spring is not rigid."""
    spelling = {"mujoco": "RK4", "pinocchio": "rk4"}[name]
    held = gripper(multiplier=0.0, offset=0.25)
    *others, finger = held.joints
    at = (finger.position[0], finger.position[1], finger.position[2] + 0.25)  # along its axis, z
    welded = Joint("second", "fixed", finger.parent, finger.child, at)
    assert apart(end(name, held, spelling), end(name, replace(held, joints=(*others, welded)), spelling)) < limit


def test_either_of_two_joints_may_follow_the_other() -> None:
    """Also a joint that comes before the one that it follows, and one that follows a follower."""
    leading = gripper(multiplier=0.5, offset=0.25, damping=0.1, armature=0.02, stiffness=3.0)
    arm, first, link, second = leading.joints
    moving = replace(second, mimic=None)
    reverse = replace(leading, joints=(arm, replace(first, mimic=Mimic(3, 2.0, -0.5)), link, moving))
    assert apart(end("pinocchio", leading, "rk4"), end("pinocchio", reverse, "rk4")) < 1e-12
    assert apart(end("mujoco", leading, STIFF, STIFF_STEP), end("pinocchio", reverse, "rk4")) < 1e-7
    third = begun((*leading.joints, Joint("third", "revolute", 0, 4, axis=(0.0, 1.0, 1.0), mimic=Mimic(3, -2.0, 0.1))))
    longer = replace(leading, bodies=(*leading.bodies, body("third", 0.2, MOMENTS)), joints=third)
    assert apart(end("mujoco", longer, STIFF, STIFF_STEP), end("pinocchio", longer, "rk4")) < 1e-6


@pytest.mark.parametrize(("spelling", "order"), [("rk4", 4), ("semi-implicit-euler", 1)])
def test_joints_that_follow_converge_to_the_truth_with_the_order_of_the_scheme_in_pinocchio(spelling: str, order: int) -> None:
    sizes = errors(registry.load("pinocchio"), FINGERS, spelling)
    assert orders(sizes) == pytest.approx([order] * 2, abs=0.1)
    assert sizes[-1] < (1e-11 if order == 4 else 1e-3)


def test_the_softness_of_a_mimic_joint_in_mujoco_does_not_vanish_with_the_step() -> None:
    sizes = errors(registry.load("mujoco"), FINGERS, "RK4")
    assert sizes == pytest.approx(sizes[0], rel=1e-4)
    assert sizes[-1] > 1e-6
    assert errors(registry.load("mujoco"), FINGERS, STIFF, (STIFF_STEP,)) < 1e-3 * sizes[-1]


def test_a_mimic_joint_yields_in_mujoco_as_its_softness_says() -> None:
    """A slide that should stay at 0 carries a weight: k r d = 2 (1 - d) g.

    MuJoCo's regularisation is (1 - d) / d times the sum of the inverse inertias of both joints, whatever the multiplier.
    """
    impedance, timeconst = 0.9, 0.02
    joints = (
        Joint("leader", "prismatic", WORLD, 0, axis=(1.0, 0.0, 0.0), start=(0.0,), start_velocity=(0.0,)),
        Joint("follower", "prismatic", WORLD, 1, axis=(0.0, 0.0, 1.0), mimic=Mimic(0, 0.0)),
    )
    hung = Mechanism((body("one", 1.0, MOMENTS), body("two", 1.0, MOMENTS)), begun(joints), gravity=9.81)
    spelling = f"Euler:solref={timeconst} 1,solimp={impedance} {impedance} 0.001"
    sag = -end("mujoco", hung, spelling, duration=2.0)[1, 2]
    stiffness = impedance / (impedance * timeconst) ** 2
    assert sag == pytest.approx(2 * (1 - impedance) * 9.81 / (impedance * stiffness), rel=1e-6)


def test_a_joint_that_follows_may_carry_two_branches() -> None:
    """The mass matrix of Pinocchio's crba is wrong for it, and that of rnea is right."""
    arm, first, link, second = FINGERS.joints
    third = Joint("third", "revolute", 3, 4, (0.1, 0.0, 0.1), axis=(0.0, 1.0, 0.3), start=(0.2,), start_velocity=(-1.0,))
    fourth = Joint("fourth", "revolute", 3, 5, (0.0, 0.2, 0.1), axis=(1.0, 0.0, 0.3), start=(0.4,), start_velocity=(1.0,))
    tips = (body("third", 0.4, MOMENTS, (0.1, 0.0, 0.2)), body("fourth", 0.5, MOMENTS, (0.0, 0.1, 0.3)))
    branched = replace(FINGERS, bodies=(*FINGERS.bodies, *tips), joints=(arm, first, link, second, third, fourth))
    sizes = errors(registry.load("pinocchio"), branched, "rk4")
    assert orders(sizes) == pytest.approx([4, 4], abs=0.2)
    assert sizes[-1] < 1e-10


def test_followers_that_a_mechanism_lists_first_keep_their_coordinates() -> None:
    mechanism = gripper()
    states = end("pinocchio", mechanism, "rk4")
    motion = joints(mechanism, trajectory(np.array([STEP * STEPS]), states[None, None]))
    (_, lead, _, follow) = (motion.position[0, held][0] for held, _ in places(mechanism))
    assert follow == pytest.approx(-1.7 * lead + 0.3, abs=1e-13)


MASS_REASON = "mass and inertia of moving bodies must be larger than mjMINVAL"


def refused(mechanism: Mechanism) -> str:
    """The reason why MuJoCo cannot model a mechanism."""
    with pytest.raises(SceneUnsupported) as refusal:
        end("mujoco", mechanism, "RK4")
    return str(refusal.value)


def test_what_mujoco_cannot_have_without_mass_is_refused_with_its_reason_and_the_name_of_the_body() -> None:
    out, turn, link = massless("thigh:out"), massless("thigh:turn"), body("thigh", 0.8, MOMENTS)
    hinges = tuple(
        Joint(name, "revolute", index - 1, index, start=(0.1,), start_velocity=(0.0,)) for index, name in enumerate("abc")
    )
    chain = Mechanism((out, turn, link), hinges, gravity=9.81)
    reason = f"MuJoCo refuses the model: {MASS_REASON}: the body thigh:out has no mass, and "
    fork = replace(chain, joints=(hinges[0], replace(hinges[1], child=2), replace(hinges[2], parent=0, child=1)))
    assert refused(fork) == reason + "it carries the joints b, c"
    free = replace(chain, bodies=(replace(out, start=BodyStart()), turn, link), joints=hinges[1:])
    assert refused(free) == reason + "it is free"
    ball = replace(hinges[0], type="spherical", start=(1.0, 0.0, 0.0, 0.0), start_velocity=(0.0, 0.0, 0.0))
    assert "ball followed by rotation in body 'thigh'" in refused(replace(chain, joints=(ball, *hinges[1:])))
    rail = replace(hinges[1], type="prismatic", attitude=(0.8, 0.6, 0.0, 0.0))
    turned = replace(chain, bodies=(out, link), joints=(ball, rail))
    of_ball = "the ball of a is turned in the frame of thigh, the next body with a mass"
    assert refused(turned) == f"MuJoCo refuses the model: {MASS_REASON}, and {of_ball}"
    loop = Loop((0, WORLD), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    assert refused(replace(chain, loops=(loop,))) == reason + "a loop holds it"
    end_of_chain = Mechanism((link, out), (replace(hinges[0], child=0), replace(hinges[1], parent=0, child=1)))
    assert refused(end_of_chain) == reason + "it carries no joint"


def test_a_ball_and_a_slide_of_one_body_are_a_pendulum_of_variable_length() -> None:
    ball = Joint(*("ball", "spherical", WORLD, 0), start=(0.9, 0.3, -0.1, 0.2), start_velocity=(1.0, -2.0, 1.5))
    rail = Joint(*("rail", "prismatic", 0, 1), stiffness=50.0, rest=0.4, start=(0.5,), start_velocity=(0.0,))
    pendulum = Mechanism((massless("bob:ball"), body("bob", 0.7, MOMENTS)), (ball, rail), gravity=9.81)
    assert apart(end("mujoco", pendulum, "RK4"), end("pinocchio", pendulum, "rk4")) < 1e-11


@pytest.mark.parametrize("mass", [1e-16, 1e-300])
def test_a_body_with_too_little_mass_is_refused_by_its_name(mass: float) -> None:
    speck = body("speck", mass, (mass, mass, mass))
    hinge = Joint("pin", "revolute", WORLD, 0, start=(0.1,), start_velocity=(0.0,))
    assert refused(Mechanism((speck,), (hinge,))) == f"MuJoCo refuses the model: Error: {MASS_REASON}: 'speck'"


def test_a_frame_that_is_fixed_to_a_body_needs_no_mass() -> None:
    plate, link = massless("plate"), body("link", 0.8, MOMENTS, (0.0, 0.0, 0.3))
    hinge = Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.1,), start_velocity=(0.5,))
    both = Mechanism((plate, link), (hinge, Joint("weld", "fixed", 0, 1)), gravity=9.81)
    alone = Mechanism((link,), (hinge,), gravity=9.81)
    for name, spelling in METHODS:
        assert apart(end(name, both, spelling)[1:], end(name, alone, spelling)) < 1e-13


def test_loops_and_mimic_joints_together_are_refused_in_pinocchio() -> None:
    looped = replace(gripper(), loops=(Loop((1, WORLD), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))),))
    with pytest.raises(SceneUnsupported, match="constraintDynamics does not support"):
        end("pinocchio", looped, "rk4")


@pytest.mark.parametrize("name", ["mujoco", "pinocchio"])
def test_such_mechanisms_are_not_made_of_free_bodies(name: str) -> None:
    for mechanism, reason in ((hip(), "a body has no mass|prismatic"), (pair(1.0), "a joint follows another")):
        with pytest.raises(SceneUnsupported, match=reason):
            end(name, mechanism, "RK4:model=free-bodies" if name == "mujoco" else "rk4:model=free-bodies")
