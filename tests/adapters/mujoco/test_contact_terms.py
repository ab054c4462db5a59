"""MuJoCo's adapter says what MuJoCo's contacts get in the place of friction and restitution."""

import pytest

from bodycheck import load
from bodycheck.adapters.contract import Method
from bodycheck.adapters.mujoco import engine as adapter
from bodycheck.adapters.mujoco.touching import bounce
from bodycheck.reference.scene import Plane
from tests.support.touching import OF_BALL, on

PYRAMID = "soft friction in a pyramid of four sides"


@pytest.mark.parametrize(
    ("plane", "spelling", "terms"),
    [
        (Plane(0.5), "Euler", PYRAMID),
        (Plane(0.5), "Euler:cone=elliptic", "soft friction"),
        (Plane(0.5), "Euler:condim=1", "no friction"),
        (Plane(0.0), "Euler", ""),
        (Plane(0.0, restitution=0.8), "Euler", "restitution 0.8 as a spring and a damper with solref=0.02 1"),
        (Plane(0.0, restitution=0.8), "Euler:solref=0.01 0.5", "restitution 0.8 as a spring and a damper with solref=0.01 0.5"),
    ],
)
def test_terms_name_the_cone_and_what_restitution_becomes(plane: Plane, spelling: str, terms: str) -> None:
    assert adapter.contact_terms(on(plane, OF_BALL), Method.parse(spelling, 0.002)) == terms


def test_terms_have_the_stiffness_that_is_written_for_a_coefficient() -> None:
    terms = adapter.contact_terms(on(Plane(0.5, restitution=0.8), OF_BALL), Method.parse("Euler:restitution=solref", 0.002))
    stiffness, damping = bounce(0.8, 0.002)
    assert terms == f"{PYRAMID}; restitution 0.8 as a spring of {stiffness:.4g}/s^2 and a damper of {damping:.4g}/s"


def test_a_scene_without_contacts_of_mujoco_has_no_terms() -> None:
    assert adapter.contact_terms(load("free-brick").scene, Method.parse("Euler", 0.002)) == ""
    sliding = load("sliding-brick").scene
    assert adapter.contact_terms(sliding, Method.parse("Euler:model=planar", 0.002)) == ""
    assert adapter.contact_terms(sliding, Method.parse("Euler", 0.002)) == PYRAMID
