"""Mechanisms in Brax, whose slides are given along the axes of the world."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.mechanisms.joint_types import JointType
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.scene import EulerAngles
from bodycheck.reference.trajectory import Array
from tests.support.coupled_joints import massless
from tests.support.jointed import body

BRAX = registry.load("brax")
STEPS, DURATION = (4e-3, 2e-3, 1e-3), 0.8
CAR = body("car", 1.0, (0.1, 0.11, 0.12), (0.1, 0.0, 0.05))
ARM = body("arm", 0.8, (0.05, 0.06, 0.03), (0.1, 0.2, -0.4))
TURNED = EulerAngles(0.3, 0.9, -0.4)
OBLIQUE = (1.0, 0.4, 2.0)


def rail(child: int, parent: int = WORLD) -> Joint:
    """A sprung slide along an oblique axis of a turned frame."""
    given = ("rail", "prismatic", parent, child, (0.2, 0.1, 0.3), TURNED, OBLIQUE)
    return Joint(*given, stiffness=20.0, rest=0.2, start=(0.1,), start_velocity=(0.5,))  # type: ignore[arg-type]


def hinge(parent: int, child: int, type: JointType = "revolute") -> Joint:
    """A hinge about an oblique axis of a turned frame, or a universal joint."""
    start = ((0.5,), (1.5,)) if type == "revolute" else ((0.5, -0.3), (1.5, 1.0))
    given = (f"pin-{child}", type, parent, child, (0.0, 0.1, -0.2), (0.8, 0.2, -0.4, 0.4), OBLIQUE)
    return Joint(*given, start=start[0], start_velocity=start[1])  # type: ignore[arg-type]


def planar() -> Joint:
    start, velocity = (0.1, 0.2, 0.5), (0.5, 0.3, 2.0)
    return Joint("plane", "planar", WORLD, 0, (0.2, 0.1, 0.3), TURNED, start=start, start_velocity=velocity)


def rail_on_rail() -> Joint:
    given = ("second", "prismatic", 0, 1, (0.1, 0.0, 0.2), (0.7, 0.7, 0.1, 0.0), (1.0, 2.0, 2.0))
    return Joint(*given, start=(-0.1,), start_velocity=(1.0,))  # type: ignore[arg-type]


MOVED = {
    "a slide": Mechanism((CAR,), (rail(0),), gravity=9.81),
    "a slide on a slide": Mechanism((CAR, ARM), (rail(0), rail_on_rail()), gravity=9.81),
    "a hinge on a slide": Mechanism((CAR, ARM), (rail(0), hinge(0, 1)), gravity=9.81),
    "a universal joint on a slide": Mechanism((CAR, ARM), (rail(0), hinge(0, 1, "universal")), gravity=9.81),
    "a planar joint": Mechanism((CAR,), (planar(),), gravity=9.81),
    "a hinge on a planar joint": Mechanism((CAR, ARM), (planar(), hinge(0, 1)), gravity=9.81),
    "a hinge on a hinge": Mechanism((CAR, ARM), (hinge(WORLD, 0), hinge(0, 1)), gravity=9.81),
}


def last(mechanism: Mechanism, timestep: float) -> Array:
    """The states (bodies, 13) at the end."""
    simulation = BRAX.prepare([mechanism], Method.parse("generalized", timestep))
    return np.array(simulation.advance(np.array([round(DURATION / timestep)]))[0, 0])


@pytest.mark.parametrize("name", MOVED)
def test_joints_in_turned_frames_converge_to_the_truth_with_order_one(name: str) -> None:
    mechanism = MOVED[name]
    exact = mechanism_truth(mechanism, np.array([0.0, DURATION])).trajectory
    rows = [last(mechanism, timestep) for timestep in STEPS]
    errors = [np.linalg.norm(row[:, :3] - exact.position[:, -1], axis=1).max() for row in rows]
    # The next power of the step is some tenth of the first one at 4 ms, and less at 1 ms.
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 1, atol=0.1)
    assert errors[-1] < 0.02
    assert geodesic_angle(rows[-1][:, 3:7], exact.quaternion[:, -1]).max() < 0.02


@pytest.mark.parametrize("type", ["revolute", "planar"])
def test_a_slide_on_a_body_that_turns_is_refused(type: str) -> None:
    base = hinge(WORLD, 0) if type == "revolute" else planar()
    with pytest.raises(SceneUnsupported, match="rail slides on a body that turns"):
        last(Mechanism((CAR, ARM), (base, rail(1, parent=0))), 1e-3)


def test_joints_of_one_body_must_have_one_anchor_and_slide_before_they_turn() -> None:
    """A hinge before another one, both at the origin of the body, make a universal joint."""
    cross = Joint(*("cross", "universal", WORLD, 0), start=(0.4, 0.9), start_velocity=(2.0, -1.0))
    about_x = Joint(*("x", "revolute", WORLD, 0), axis=(1.0, 0.0, 0.0), start=(0.4,), start_velocity=(2.0,))
    about_y = Joint(*("y", "revolute", 0, 1), axis=(0.0, 1.0, 0.0), start=(0.9,), start_velocity=(-1.0,))
    chain = Mechanism((massless("arm:x"), ARM), (about_x, about_y), gravity=9.81)
    whole = Mechanism((ARM,), (cross,), gravity=9.81)
    one, two = (
        BRAX.prepare([mechanism], Method.parse("generalized", 1e-3)).advance(np.array([100]))[0, 0, -1]
        for mechanism in (whole, chain)
    )
    np.testing.assert_allclose(one, two, rtol=0, atol=1e-12)
    apart = replace(chain, joints=(about_x, replace(about_y, position=(0.1, 0.0, 0.0))))
    sliding = replace(chain, joints=(about_x, replace(about_y, type="prismatic")))
    for mechanism, reason in ((apart, "only one joint position allowed"), (sliding, "Brax does not turn the axes of slides")):
        with pytest.raises(SceneUnsupported, match=reason):
            BRAX.prepare([mechanism], Method.parse("generalized", 1e-3))
