"""Bodies between fingers in SAPIEN."""

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import ContactTerms, Method, SceneUnsupported
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import Ellipsoid
from tests.support import touching_engines as measured
from tests.support.grips import GRAVITY, grip, pressed, with_contacts

SAPIEN = registry.load("sapien")
SOLVERS = ("PGS", "TGS")


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("force", "friction"), [(12.0, 0.0), (8.0, 0.4), (12.0, 0.5)])
def test_a_body_falls_with_gravity_less_twice_the_friction_or_is_held(solver: str, force: float, friction: float) -> None:
    scene = pressed(grip(force, friction), force)
    before, after = measured.states(SAPIEN, scene, solver, 1e-3, [50, 50])[:, 0, 9]
    # Single precision rounds a speed of 0.5 m/s by some 1e-7 in each of 50 steps.
    assert (before - after) / 0.05 == pytest.approx(max(0.0, GRAVITY - 2 * friction * force), abs=2e-3)


def test_only_pairs_of_the_scene_collide() -> None:
    from bodycheck.adapters.sapien.touching import groups  # SAPIEN warns where it is imported without its adapter

    ((first, second, _, _), (of_other, with_other, _, _), alone) = groups([(0, 1)], 3)
    assert first & with_other
    assert of_other & second
    assert not alone[1]


def test_the_patch_of_a_finger_has_the_torsional_friction_of_its_pair() -> None:
    scene = load("gripped-block-turns").scene
    assert isinstance(SAPIEN, ContactTerms)
    assert SAPIEN.contact_terms(scene, Method.parse("TGS", 1e-3)) == "torsional friction of patches of 0.005 m"
    with pytest.raises(SceneUnsupported, match="PGS ignores"):
        SAPIEN.prepare([scene], Method.parse("PGS", 1e-3))


def test_what_physx_lacks_is_refused() -> None:
    method = Method.parse("TGS", 1e-3)
    with pytest.raises(SceneUnsupported, match="the coefficients of body and "):
        SAPIEN.prepare([with_contacts(grip(12.0, 0.5), {}, {"friction": 0.0})], method)
    with pytest.raises(SceneUnsupported, match="ellipsoid"):
        SAPIEN.prepare([grip(12.0, 0.5, body=Ellipsoid((0.03, 0.03, 0.03)))], method)


def test_free_spheres_without_a_plane_touch_as_their_pair_says() -> None:
    scene = load("spheres-oblique-sticking").scene
    first, last = measured.states(SAPIEN, scene, "TGS:bounce_threshold=0.1", 1e-3, [1, 1499])[:, :, 7:10]
    # Without gravity, momentum does not change.
    assert isinstance(scene, Mechanism)
    masses = np.array([nearest_inertia(body).mass for body in scene.bodies])
    assert masses @ last == pytest.approx(masses @ first, abs=1e-4)
    assert np.abs(last - first).max() > 0.1
