"""Bodies between fingers in PyBullet."""

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import ContactTerms, Method, SceneUnsupported
from bodycheck.adapters.pybullet import gripping
from bodycheck.running.simulation import simulate
from tests.support import touching_engines as measured
from tests.support.grips import GRAVITY, grip, pressed, with_contacts

PYBULLET = registry.load("pybullet")


def test_a_pressed_body_is_held_and_a_body_without_friction_falls() -> None:
    fallen = measured.states(PYBULLET, pressed(grip(12.0, 0.0), 12.0), "multibody", 1e-3, [100])[-1, 0]
    # Semi-implicit Euler falls g h t/2 too far.
    assert fallen[2] == pytest.approx(-GRAVITY * 0.1 * 0.101 / 2, rel=1e-9)
    held = measured.states(PYBULLET, pressed(grip(12.0, 0.5), 12.0), "multibody", 1e-3, [100])[-1, 0]
    # Bullet's slop is 1e-5 m.
    assert abs(held[2]) < 2e-5


def test_a_body_on_point_fingers_falls_with_gravity_less_twice_the_friction() -> None:
    before, after = measured.states(PYBULLET, pressed(grip(8.0, 0.4), 8.0), "multibody", 1e-3, [50, 50])[:, 0, 9]
    assert (before - after) / 0.05 == pytest.approx(GRAVITY - 2 * 0.4 * 8.0, rel=1e-3)


def test_a_body_between_faces_turns_unless_contacts_share_the_load() -> None:
    scene = pressed(load("gripped-block-falls").scene, 8.0)
    turned, upright = (
        measured.states(PYBULLET, scene, method, 1e-3, [300])[-1, 0] for method in ("multibody", "multibody:globalCFM=0.001")
    )
    # Its vector part is the sine of half the angle; a fall by Euler's method is g h t/2 too far.
    assert np.linalg.norm(turned[4:7]) > 0.1
    assert np.linalg.norm(upright[4:7]) < 0.01
    assert upright[2] == pytest.approx(-(GRAVITY - 8) * 0.3 * 0.301 / 2, abs=1e-4)


def test_torsional_friction_holds_a_block_beside_its_centre() -> None:
    run = simulate(load("gripped-block-turns"), "pybullet", "multibody", 1e-3)
    assert run.outcome.status == "ok"
    shared = load("gripped-block-eccentric-holds").scene
    assert isinstance(PYBULLET, ContactTerms)
    given = PYBULLET.contact_terms(shared, Method.parse("multibody", 1e-3))
    assert given == "a bound of its own for friction and for torsional friction"


def test_coefficients_of_pairs_arrive_as_they_are() -> None:
    scene = with_contacts(grip(12.0, 0.5), {"friction": 0.3, "torsional_friction": 0.01}, {"friction": 0.7})
    friction, restitution, torsional = gripping.coefficients(scene)
    for pair in scene.contacts:
        one, other = pair.bodies
        assert friction[one] * friction[other] == pytest.approx(pair.friction, rel=1e-12)
        assert restitution[one] * restitution[other] == 0
        spinning = torsional[one] * friction[other] + torsional[other] * friction[one]
        assert spinning == pytest.approx(pair.torsional_friction, rel=1e-12)


def test_free_spheres_without_a_plane_touch_as_their_pair_says() -> None:
    scene = load("spheres-head-on").scene
    speeds = measured.states(PYBULLET, scene, "multibody", 1e-3, [1500])[-1, :, 7:10]
    before = measured.states(PYBULLET, scene, "multibody", 1e-3, [1])[-1, :, 7:10]
    closing = np.linalg.norm(before[0] - before[1])
    # The restitution is 0.5; contacts act from a distance on, which costs some thousandths.
    assert np.linalg.norm(speeds[0] - speeds[1]) == pytest.approx(0.5 * closing, rel=0.02)


def test_what_bullet_lacks_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match="maximal coordinates"):
        PYBULLET.prepare([pressed(grip(12.0, 0.5), 12.0)], Method.parse("maximal", 1e-3))
